//! Where a run keeps who commands it. Knows a file in the run's folder; must never know the rules.

use super::control::Holding;
use std::fs::{self, OpenOptions};
use std::io::{self, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;

/// The file's name.
const CONTROL_FILE: &str = "control.json";

/// What the run in `folder` keeps; nobody holds it if it keeps nothing that can be read.
pub(super) fn read(folder: &Path) -> Holding {
    let bytes = fs::read(folder.join(CONTROL_FILE)).unwrap_or_default();
    serde_json::from_slice(&bytes).unwrap_or_default()
}

/// Keeps it: there is the old file or the new one, whatever happens.
pub(super) fn write(folder: &Path, holding: &Holding) -> io::Result<()> {
    replace(&folder.join(CONTROL_FILE), &serde_json::to_vec(holding)?, false)
}

/// Writes a file for its owner only, as a whole; with `synced` it outlives a power cut.
pub(super) fn replace(path: &Path, bytes: &[u8], synced: bool) -> io::Result<()> {
    let fresh = path.with_extension("new");
    let mut options = OpenOptions::new();
    let mut file = options.write(true).create(true).truncate(true).mode(0o600).open(&fresh)?;
    file.write_all(bytes)?;
    if synced {
        file.sync_all()?;
    }
    fs::rename(&fresh, path)?;
    let folder = path.parent().filter(|_| synced);
    folder.map_or(Ok(()), |folder| fs::File::open(folder)?.sync_all())
}

#[cfg(test)]
mod tests {
    use super::{CONTROL_FILE, read, write};
    use crate::runs::control::Holding;
    use std::os::unix::fs::PermissionsExt as _;
    use std::time::Duration;

    #[test]
    fn who_holds_a_run_is_kept_for_its_owner_only_and_has_time_again() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(read(folder.path()), Holding::default());
        let mut holding = Holding::default();
        holding.command("ana", 5, Duration::ZERO).unwrap();
        write(folder.path(), &holding).unwrap();
        let told = read(folder.path()).go_on(70).told(Duration::ZERO);
        assert_eq!((told.holder.as_deref(), told.since_ms, told.heard_ms), (Some("ana"), 5, 70));
        let file = folder.path().join(CONTROL_FILE);
        assert_eq!(file.metadata().unwrap().permissions().mode() & 0o777, 0o600);
        std::fs::write(file, "nonsense").unwrap();
        assert_eq!(read(folder.path()), Holding::default());
    }
}
