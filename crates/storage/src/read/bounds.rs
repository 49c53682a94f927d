//! Restricts reading to some folders, for programs that load machines on behalf of others. Checks links and kinds of files, not
//! their content.
//!
//! The system itself reports whether a path contains a link. The real location is determined only for such paths. A concurrent
//! change of the path cannot lead elsewhere.

use rustix::fd::{AsFd, AsRawFd as _, OwnedFd};
use rustix::fs::{CWD, FileType, Mode, OFlags, ResolveFlags, fstat, openat, openat2, readlink};
use rustix::io::Errno;
use std::ffi::OsString;
use std::os::unix::ffi::OsStringExt as _;
use std::path::{Path, PathBuf};

/// The maximum size of a file that is read under a restriction.
pub(super) const BYTES_MAX: u64 = 64 << 20;

/// Reason why a file was not read. Paths are the requested ones.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Unread {
    /// The system reported an error.
    System(Errno),
    /// The path is outside the allowed folders.
    Outside(PathBuf),
    /// The file is not regular or is too large.
    Unfit(PathBuf),
}

impl From<Errno> for Unread {
    fn from(error: Errno) -> Self {
        Self::System(error)
    }
}

/// The folders from which files may be read, without links in their paths; `None` means anywhere.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds<'h>(pub(crate) Option<&'h [PathBuf]>);

impl Bounds<'_> {
    /// Opens `path` in the open folder `dir` for reading.
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
            // A link, or a system that cannot detect links.
            Err(_) => self.open_by_link(dir, path, flags),
        }
    }

    /// Opens nothing outside of the folders, not even to examine it: opening a device may have an effect.
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

    /// Returns true if an open file or folder is inside the allowed folders.
    pub(crate) fn holds(self, open: &OwnedFd) -> bool {
        let Some(homes) = self.0 else { return true };
        let Ok(place) = readlink(by_number(open), Vec::new()) else { return false };
        let place = PathBuf::from(OsString::from_vec(place.into_bytes()));
        homes.iter().any(|home| place.starts_with(home))
    }

    /// Refuses a file that must not be read as a whole. The caller refuses a folder.
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

/// The path under `/proc` of an open file.
fn by_number(open: &OwnedFd) -> PathBuf {
    PathBuf::from(format!("/proc/self/fd/{}", open.as_raw_fd()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;

    #[test]
    fn a_file_that_is_too_large_is_refused_only_under_a_restriction() {
        let dir = tempfile::tempdir().unwrap();
        let homes = [dir.path().canonicalize().unwrap()];
        let folder = File::open(dir.path()).unwrap();
        let path = Path::new("file");
        for (bytes, within) in [
            (BYTES_MAX, Ok(())),
            (BYTES_MAX + 1, Err(Unread::Unfit(path.to_owned()))),
            (u64::from(u32::MAX), Err(Unread::Unfit(path.to_owned()))),
            (0, Ok(())),
        ] {
            File::create(dir.path().join(path)).unwrap().set_len(bytes).unwrap();
            for (bounds, admitted) in [(Bounds(Some(&homes)), within), (Bounds(None), Ok(()))] {
                let file = bounds.open(&folder, path, OFlags::empty()).unwrap();
                assert_eq!(bounds.admit(&file, path), admitted, "{bytes} bytes");
            }
        }
    }
}
