//! Where files and folders may be read: anywhere, or for those who load for others in some folders only. Knows links and
//! kinds of files, not what is in them.
//!
//! The system itself says that there was no link on the way to what it opens; only where there was one is looked up where
//! that really lies. Nothing that is put there in between can lead elsewhere.

use rustix::fd::{AsFd, AsRawFd as _, OwnedFd};
use rustix::fs::{CWD, FileType, Mode, OFlags, ResolveFlags, fstat, openat, openat2, readlink};
use rustix::io::Errno;
use std::ffi::OsString;
use std::os::unix::ffi::OsStringExt as _;
use std::path::{Path, PathBuf};

/// Larger files are not read for others.
pub(super) const BYTES_MAX: u64 = 64 << 20;

/// Why something was not read; paths are those that were asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Unread {
    /// The system refuses.
    System(Errno),
    /// It lies in none of the folders.
    Outside(PathBuf),
    /// It is no regular file, or too large.
    Unfit(PathBuf),
}

impl From<Errno> for Unread {
    fn from(error: Errno) -> Self {
        Self::System(error)
    }
}

/// The folders in which everything has to lie, without links in their paths; nothing: anywhere.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds<'h>(pub(crate) Option<&'h [PathBuf]>);

impl Bounds<'_> {
    /// Opens what is at `path` in the open folder `dir`, to be read.
    pub(crate) fn open(
        self,
        dir: impl AsFd,
        path: &Path,
        flags: OFlags,
    ) -> Result<OwnedFd, Unread> {
        let flags = OFlags::RDONLY | OFlags::CLOEXEC | flags;
        if self.0.is_none() {
            return Ok(openat(dir, path, flags, Mode::empty())?);
        }
        let straight = ResolveFlags::BENEATH | ResolveFlags::NO_SYMLINKS;
        match openat2(&dir, path, flags, Mode::empty(), straight) {
            Ok(opened) => Ok(opened),
            Err(Errno::NXIO) => Err(Unread::Unfit(path.to_owned())),
            Err(
                error @ (Errno::NOENT
                | Errno::NOTDIR
                | Errno::ISDIR
                | Errno::ACCESS
                | Errno::MFILE
                | Errno::NFILE),
            ) => Err(error.into()),
            // A link, or a system that does not look for links.
            Err(_) => self.open_by_link(dir, path, flags),
        }
    }

    /// Nothing that lies elsewhere is opened, not even to look at it: to open a device may do something.
    fn open_by_link(self, dir: impl AsFd, path: &Path, flags: OFlags) -> Result<OwnedFd, Unread> {
        let kind = OFlags::PATH | OFlags::CLOEXEC | (flags & OFlags::DIRECTORY);
        let found = openat(dir, path, kind, Mode::empty())?;
        if !self.holds(&found) {
            return Err(Unread::Outside(path.to_owned()));
        }
        match openat(CWD, by_number(&found), flags, Mode::empty()) {
            Err(Errno::NXIO) => Err(Unread::Unfit(path.to_owned())),
            opened => Ok(opened?),
        }
    }

    /// Whether something open lies where it may be read.
    pub(crate) fn holds(self, open: &OwnedFd) -> bool {
        let Some(homes) = self.0 else { return true };
        let Ok(place) = readlink(by_number(open), Vec::new()) else { return false };
        let place = PathBuf::from(OsString::from_vec(place.into_bytes()));
        homes.iter().any(|home| place.starts_with(home))
    }

    /// Refuses a file that is not to be read as a whole. A folder is refused by who reads it.
    pub(crate) fn admit(self, file: &OwnedFd, path: &Path) -> Result<(), Unread> {
        if self.0.is_none() {
            return Ok(());
        }
        let about = fstat(file)?;
        let is_small = u64::try_from(about.st_size).is_ok_and(|size| size <= BYTES_MAX);
        match FileType::from_raw_mode(about.st_mode) {
            FileType::RegularFile if is_small => Ok(()),
            FileType::Directory => Err(Errno::ISDIR.into()),
            _ => Err(Unread::Unfit(path.to_owned())),
        }
    }
}

/// Where the system shows what is open under a number.
fn by_number(open: &OwnedFd) -> PathBuf {
    PathBuf::from(format!("/proc/self/fd/{}", open.as_raw_fd()))
}
