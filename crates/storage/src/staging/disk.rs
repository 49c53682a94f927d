//! Operations of a save on a disk, behind a trait, so that tests can stop a save at any of them. Handles paths and bytes, not
//! machines.

use rustix::fs::syncfs;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// For more files than this, syncing their whole file system is cheaper.
const MANY: usize = 64;

/// The operations of a save on a disk.
pub(crate) trait Disk: Sync {
    /// Creates the folder and its parents; it may exist.
    fn create_dir(&self, path: &Path) -> io::Result<()>;
    /// Creates the file, with the permissions of `like` if that exists.
    fn write(&self, path: &Path, bytes: &[u8], like: Option<&Path>) -> io::Result<()>;
    /// Returns when these files and folders are safe from a power cut.
    fn sync(&self, paths: &[PathBuf]) -> io::Result<()>;
    /// Moves a file (over another) or a folder.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Removes the file if it exists.
    fn remove_file(&self, path: &Path) -> io::Result<()>;
    /// Removes the folder if it exists and is empty.
    fn remove_dir(&self, path: &Path) -> io::Result<()>;
    /// Removes the folder with its content, if it exists.
    fn remove_tree(&self, path: &Path) -> io::Result<()>;
    /// Returns true if the path exists.
    fn exists(&self, path: &Path) -> bool {
        fs::symlink_metadata(path).is_ok()
    }
    /// Returns the bytes of the file, if it exists.
    fn read(&self, path: &Path) -> io::Result<Option<Vec<u8>>> {
        found(fs::read(path))
    }
    /// Returns the names in the folder. Empty if the folder does not exist.
    fn list(&self, path: &Path) -> io::Result<Vec<OsString>> {
        let Some(entries) = found(fs::read_dir(path))? else { return Ok(Vec::new()) };
        entries.map(|entry| Ok(entry?.file_name())).collect()
    }
}

/// The disk of this computer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RealDisk;

impl Disk for RealDisk {
    fn create_dir(&self, path: &Path) -> io::Result<()> {
        fs::create_dir_all(path)
    }

    fn write(&self, path: &Path, bytes: &[u8], like: Option<&Path>) -> io::Result<()> {
        let mut file = File::create(path)?;
        file.write_all(bytes)?;
        if let Some(metadata) = like.and_then(|like| fs::metadata(like).ok()) {
            file.set_permissions(metadata.permissions())?;
        }
        Ok(())
    }

    fn sync(&self, paths: &[PathBuf]) -> io::Result<()> {
        let all = if paths.len() > MANY { &paths[..1] } else { paths };
        for path in all {
            let file = File::open(path)?;
            if paths.len() > MANY { syncfs(&file)? } else { file.sync_all()? }
        }
        Ok(())
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    fn remove_file(&self, path: &Path) -> io::Result<()> {
        found(fs::remove_file(path)).map(|_| ())
    }

    fn remove_dir(&self, path: &Path) -> io::Result<()> {
        match fs::remove_dir(path) {
            Err(error) if error.kind() == ErrorKind::DirectoryNotEmpty => Ok(()),
            other => found(other).map(|_| ()),
        }
    }

    fn remove_tree(&self, path: &Path) -> io::Result<()> {
        found(fs::remove_dir_all(path)).map(|_| ())
    }
}

/// `None` instead of an error if the file or folder does not exist.
fn found<T>(result: io::Result<T>) -> io::Result<Option<T>> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            Ok(None)
        }
        Err(error) => Err(error),
    }
}
