//! Cache of the package's compiled modules between starts, like CPython's `.pyc` files: compiling them takes more than half
//! of the time from the start of a runner to its first state.
//!
//! `$XDG_CACHE_HOME/rafcon/code` (else `~/.cache/rafcon/code`) has a folder for each version of the package and of the
//! interpreter. The cache is optional: an unusable folder or a damaged file costs only time.

use std::fs::{self, DirBuilder, File, OpenOptions};
use std::io::{self, Read as _, Write as _};
use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _, OpenOptionsExt as _};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Maximum number of cached versions.
const VERSIONS_MAX: usize = 8;
/// Bits of the mode of a folder that others could write to.
const WRITABLE_BY_OTHERS: u32 = 0o022;
/// Bytes of the hash that precedes the code in a file.
const HASH_BYTES: usize = blake3::OUT_LEN;

/// The folder of one version.
#[derive(Debug)]
pub(crate) struct CodeCache {
    folder: PathBuf,
}

impl CodeCache {
    /// The folder for `version`, which must be a valid file name; created if necessary. `None` without a cache folder, or
    /// if other users can write to it.
    pub(crate) fn open(version: &str) -> Option<Self> {
        let versions = cache_home()?.join("rafcon").join("code");
        let mut builder = DirBuilder::new();
        builder.recursive(true).mode(0o700).create(&versions).ok()?;
        if !is_private(&versions) {
            return None;
        }
        let folder = versions.join(version);
        match DirBuilder::new().mode(0o700).create(&folder) {
            Ok(()) => remove_oldest(&versions).ok()?,
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(_) => return None,
        }
        is_private(&folder).then_some(Self { folder })
    }

    /// Reads the code of a module. A missing or damaged file has none.
    pub(crate) fn read(&self, name: &str) -> Option<Vec<u8>> {
        let mut bytes = Vec::new();
        File::open(self.folder.join(name)).ok()?.read_to_end(&mut bytes).ok()?;
        let (hash, code) = bytes.split_at_checked(HASH_BYTES)?;
        let is_whole = blake3::hash(code).as_bytes() == hash;
        is_whole.then(|| code.to_vec())
    }

    /// Stores `code` under this name. Readers see the whole file or none.
    pub(crate) fn write(&self, name: &str, code: &[u8]) -> io::Result<()> {
        let part = self.folder.join(format!("{name}.{}", std::process::id()));
        let mut file = OpenOptions::new().write(true).create_new(true).mode(0o600).open(&part)?;
        let written = file
            .write_all(blake3::hash(code).as_bytes())
            .and_then(|()| file.write_all(code))
            .and_then(|()| fs::rename(&part, self.folder.join(name)));
        if written.is_err() {
            fs::remove_file(&part)?;
        }
        written
    }
}

/// The folder for caches of this user.
fn cache_home() -> Option<PathBuf> {
    let absolute = |path: PathBuf| path.is_absolute().then_some(path);
    let named = std::env::var_os("XDG_CACHE_HOME").map(PathBuf::from).and_then(absolute);
    named.or_else(|| {
        let home = std::env::var_os("HOME").map(PathBuf::from).and_then(absolute)?;
        Some(home.join(".cache"))
    })
}

/// True if a folder belongs to this user and no other user can write to it. Code from it is executed.
fn is_private(folder: &Path) -> bool {
    fs::symlink_metadata(folder).is_ok_and(|about| {
        about.is_dir()
            && about.uid() == rustix::process::geteuid().as_raw()
            && about.mode() & WRITABLE_BY_OTHERS == 0
    })
}

/// Removes the oldest versions beyond the limit.
fn remove_oldest(versions: &Path) -> io::Result<()> {
    let mut found = Vec::new();
    for entry in fs::read_dir(versions)? {
        let entry = entry?;
        let changed = entry.metadata().and_then(|about| about.modified());
        found.push((changed.unwrap_or(SystemTime::UNIX_EPOCH), entry.path()));
    }
    found.sort();
    for (_, folder) in found.iter().rev().skip(VERSIONS_MAX) {
        // Another process may remove it, too.
        fs::remove_dir_all(folder).unwrap_or_default();
    }
    Ok(())
}
