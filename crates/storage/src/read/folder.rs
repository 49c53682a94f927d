//! Reads folders and files with few system calls: paths relative to an open folder, kinds of entries from the listing, no `stat`.
//! Returns bytes without interpreting them.

use super::bounds::{Bounds, Unread};
use rustix::fd::{AsFd, OwnedFd};
use rustix::fs::{Access, AtFlags, CWD, FileType, Mode, OFlags, RawDir, accessat, fstat, openat};
use rustix::io::{Errno, read};
use std::ffi::{OsStr, OsString};
use std::mem::MaybeUninit;
use std::os::unix::ffi::{OsStrExt as _, OsStringExt as _};
use std::path::Path;

/// An entry of a listing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct FolderEntry {
    pub(crate) name: OsString,
    /// A link, or a file system that does not report kinds: only opening shows the kind.
    pub(crate) unclear: bool,
}

/// Opens the folder at `path` of the file system.
pub(crate) fn open(path: &Path) -> Result<OwnedFd, Errno> {
    let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::CLOEXEC;
    openat(CWD, path, flags, Mode::empty())
}

/// The number that identifies a folder in its file system.
pub(crate) fn inode(dir: impl AsFd) -> Result<u64, Errno> {
    fstat(dir).map(|stat| stat.st_ino)
}

/// The folders in `dir`, and entries that may be folders.
pub(crate) fn folders(dir: impl AsFd) -> Result<Vec<FolderEntry>, Errno> {
    let mut buffer = [MaybeUninit::uninit(); 16 * 1024];
    let mut listing = RawDir::new(dir, &mut buffer);
    let mut found = Vec::new();
    while let Some(entry) = listing.next() {
        let entry = entry?;
        let name = entry.file_name().to_bytes();
        let unclear = match entry.file_type() {
            FileType::Directory => false,
            FileType::Symlink | FileType::Unknown => true,
            _ => continue,
        };
        if name != b"." && name != b".." {
            let name = OsString::from_vec(name.to_vec());
            found.push(FolderEntry { name, unclear });
        }
    }
    Ok(found)
}

/// Reads files into a reused buffer.
#[derive(Debug)]
pub(crate) struct FileReader<'h> {
    bounds: Bounds<'h>,
    path: Vec<u8>,
    bytes: Vec<u8>,
}

impl<'h> FileReader<'h> {
    pub(crate) fn new(bounds: Bounds<'h>) -> Self {
        Self { bounds, path: Vec::with_capacity(256), bytes: vec![0; 64 * 1024] }
    }

    /// The folders from which it may read.
    pub(crate) fn bounds(&self) -> Bounds<'h> {
        self.bounds
    }

    /// The bytes of `folder/file` in `dir` (`folder` may be empty); `None` if there is no such file.
    pub(crate) fn read(
        &mut self,
        dir: impl AsFd,
        folder: &OsStr,
        file: &str,
    ) -> Result<Option<&[u8]>, Unread> {
        self.set_path(folder, file);
        match self.fetch(dir) {
            Ok(length) => Ok(Some(&self.bytes[..length])),
            Err(Unread::System(Errno::NOENT | Errno::NOTDIR | Errno::ISDIR | Errno::LOOP)) => {
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    /// Reads the file at the path, and returns its length.
    fn fetch(&mut self, dir: impl AsFd) -> Result<usize, Unread> {
        let path = Path::new(OsStr::from_bytes(&self.path));
        // Does not wait for the writer of a pipe.
        let file = self.bounds.open(dir, path, OFlags::NONBLOCK)?;
        self.bounds.admit(&file, path)?;
        fill(&mut self.bytes, &file).map_err(|error| match error {
            // The system reports this for a device without an end, not for a file.
            Errno::NXIO => Unread::Unfit(path.to_owned()),
            error => error.into(),
        })
    }

    /// Returns true if `folder/file` exists in `dir`.
    pub(crate) fn exists(&mut self, dir: impl AsFd, folder: &OsStr, file: &str) -> bool {
        self.set_path(folder, file);
        accessat(dir, self.path.as_slice(), Access::EXISTS, AtFlags::empty()).is_ok()
    }

    fn set_path(&mut self, folder: &OsStr, file: &str) {
        self.path.clear();
        if !folder.is_empty() {
            self.path.extend_from_slice(folder.as_bytes());
            self.path.push(b'/');
        }
        self.path.extend_from_slice(file.as_bytes());
    }
}

/// Reads a file into the buffer, and returns its length. One read is enough for a file that is smaller than the buffer: a
/// regular file returns all its bytes. A larger file that is not regular may have no end, and is refused by `NXIO`.
fn fill(bytes: &mut Vec<u8>, file: &OwnedFd) -> Result<usize, Errno> {
    let mut length = 0;
    loop {
        let free = bytes.len() - length;
        let count = match read(file, &mut bytes[length..]) {
            Err(Errno::INTR) => continue,
            other => other?,
        };
        length += count;
        if count < free {
            return Ok(length);
        }
        if FileType::from_raw_mode(fstat(file)?.st_mode) != FileType::RegularFile {
            return Err(Errno::NXIO);
        }
        bytes.resize(bytes.len() * 2, 0);
    }
}
