//! Files for the server's owner only: written atomically, unreadable for others. Does not know their content.

use std::fs::{self, DirBuilder, File, OpenOptions};
use std::io::{self, Write as _};
use std::os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};

/// One of the server's own files cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("cannot {what} {}: {source}", path.display())]
pub struct PrivateError {
    what: &'static str,
    path: PathBuf,
    source: io::Error,
}

impl PrivateError {
    pub(crate) fn new(what: &'static str, path: &Path, source: io::Error) -> Self {
        Self { what, path: path.to_owned(), source }
    }

    /// The cause, if known, and a remedy.
    pub(crate) fn remedy(&self) -> &'static str {
        rafcon_storage::remedy(&self.source)
    }
}

impl From<PrivateError> for io::Error {
    fn from(error: PrivateError) -> Self {
        Self::new(error.source.kind(), error)
    }
}

/// Makes a folder that only its owner can read.
pub(crate) fn folder(path: &Path) -> Result<(), PrivateError> {
    let made = DirBuilder::new().recursive(true).mode(0o700).create(path);
    let made = made.and_then(|()| fs::set_permissions(path, fs::Permissions::from_mode(0o700)));
    made.map_err(|source| PrivateError::new("make the folder", path, source))
}

/// Replaces a file. The new content survives a power cut.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), PrivateError> {
    let replaced = replace(path, bytes, File::sync_all).and_then(|()| sync_folder(path));
    replaced.map_err(|source| PrivateError::new("write", path, source))
}

/// Replaces a file. If the disk has no room for a second file, it overwrites the old one.
pub(crate) fn write_without_room(path: &Path, bytes: &[u8]) -> Result<(), PrivateError> {
    let written = write(path, bytes);
    written.or_else(|error| overwrite(path, bytes).map_err(|_also| error))
}

/// Overwrites an existing file, which needs no room on most disks. The file is small: one write replaces it.
fn overwrite(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).open(path)?;
    file.write_all(bytes)?;
    file.set_len(bytes.len() as u64)?;
    file.sync_all()
}

/// Replaces a file without waiting for the disk: a power cut may lose it.
pub(crate) fn write_soon(path: &Path, bytes: &[u8]) -> Result<(), PrivateError> {
    let replaced = replace(path, bytes, |_file| Ok(()));
    replaced.map_err(|source| PrivateError::new("write", path, source))
}

fn replace(
    path: &Path,
    bytes: &[u8],
    sync: impl FnOnce(&File) -> io::Result<()>,
) -> io::Result<()> {
    let staged = path.with_extension(format!("new-{}", std::process::id()));
    let written = stage(&staged, bytes, sync).and_then(|()| fs::rename(&staged, path));
    if written.is_err() {
        // Removes the partial file, so that it takes no room on a full disk.
        fs::remove_file(&staged).unwrap_or_default();
    }
    written
}

fn stage(
    staged: &Path,
    bytes: &[u8],
    sync: impl FnOnce(&File) -> io::Result<()>,
) -> io::Result<()> {
    let mut options = OpenOptions::new();
    let mut file = options.write(true).create(true).truncate(true).mode(0o600).open(staged)?;
    file.set_permissions(fs::Permissions::from_mode(0o600))?;
    file.write_all(bytes)?;
    sync(&file)
}

fn sync_folder(path: &Path) -> io::Result<()> {
    path.parent().map_or(Ok(()), |folder| File::open(folder)?.sync_all())
}

/// A file's text; `None` if there is no such file.
pub(crate) fn read(path: &Path) -> Result<Option<String>, PrivateError> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(PrivateError::new("read", path, source)),
    }
}

/// Opens a file to lock it or to append to it.
pub(crate) fn open(path: &Path) -> Result<File, PrivateError> {
    let mut options = OpenOptions::new();
    let file = options.read(true).append(true).create(true).mode(0o600).open(path);
    file.map_err(|source| PrivateError::new("open", path, source))
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    #[test]
    fn without_room_for_another_file_the_old_one_is_overwritten() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("token");
        super::write(&file, b"first one").unwrap();
        let staged = file.with_extension(format!("new-{}", std::process::id()));
        std::fs::create_dir(staged).unwrap();
        assert!(super::write(&file, b"second").is_err());
        super::write_without_room(&file, b"second").unwrap();
        assert_eq!(super::read(&file).unwrap().as_deref(), Some("second"));
        assert!(super::write_without_room(&place.path().join("token.x"), b"").is_err());
    }

    #[test]
    fn nobody_else_may_read() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("state");
        super::folder(&folder).unwrap();
        super::write(&folder.join("token"), b"secret").unwrap();
        drop(super::open(&folder.join("lock")).unwrap());
        let mode = |name: &str| folder.join(name).metadata().unwrap().permissions().mode() & 0o777;
        assert_eq!((mode(""), mode("token"), mode("lock")), (0o700, 0o600, 0o600));
        assert_eq!(super::read(&folder.join("token")).unwrap().as_deref(), Some("secret"));
        assert_eq!(super::read(&folder.join("nothing")).unwrap(), None);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 2);
    }
}
