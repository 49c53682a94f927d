//! Files of the server in a run's folder, for the next server: the state of control, and the request to start or resume the run.
//! The request has its author, its id and the current boot of the computer. Knows no rules.

use super::control::Holding;
use rafcon_protocol::api::{MachineFile, StartRun};
use serde::{Deserialize, Serialize};
use std::fs::{self, OpenOptions};
use std::io::{self, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;
use std::time::Duration;

/// Name of the file with the request.
const REQUEST_FILE: &str = "request.json";
/// Name of the file with the state of control.
const CONTROL_FILE: &str = "control.json";
/// Time for which a run that has not begun waits for a repeated request.
const REMEMBERED: Duration = Duration::from_hours(24);
/// File in which Linux identifies the current boot.
const BOOT_FILE: &str = "/proc/sys/kernel/random/boot_id";

/// Requests about one run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct RunRequest {
    /// Author of the first request.
    pub(super) author: String,
    /// Boot of the computer at the last request.
    pub(super) boot: String,
    /// The request to start. `None` if the run was only resumed here.
    #[serde(default)]
    pub(super) start: Option<StartRun>,
    /// Keys of the requests that resumed it.
    #[serde(default)]
    pub(super) resumed: Vec<String>,
    /// Key of a pending request to resume it. It is unknown whether its runner was started.
    #[serde(default)]
    pub(super) resuming: Option<String>,
    /// True if the run is no longer resumed automatically: a user has to decide.
    #[serde(default)]
    pub(super) is_left_alone: bool,
}

impl RunRequest {
    /// The record of a new request to start.
    pub(super) fn to_start(author: &str, start: StartRun) -> Self {
        Self { author: author.to_owned(), boot: boot(), start: Some(start), ..Self::default() }
    }

    /// The record in `folder`. `None` if it does not exist or is invalid.
    pub(super) fn read(folder: &Path) -> Option<Self> {
        serde_json::from_slice(&fs::read(folder.join(REQUEST_FILE)).ok()?).ok()
    }

    /// True if the request for the run in `folder`, which has not begun, is too old to be repeated.
    pub(super) fn is_forgotten(folder: &Path) -> bool {
        let written = fs::metadata(folder.join(REQUEST_FILE)).and_then(|about| about.modified());
        let age = written.ok().and_then(|written| written.elapsed().ok());
        age.is_some_and(|age| age > REMEMBERED)
    }

    /// Writes the record. It survives a power cut.
    pub(super) fn write(&self, folder: &Path) -> io::Result<()> {
        replace(&folder.join(REQUEST_FILE), &serde_json::to_vec(self)?, true)
    }

    /// Removes the record from the folder.
    pub(super) fn remove(folder: &Path) -> io::Result<()> {
        fs::remove_file(folder.join(REQUEST_FILE))
    }

    /// The record with a pending request to resume.
    pub(super) fn resuming(mut self, author: &str, id: &str) -> Self {
        if self.start.is_none() && self.resumed.is_empty() {
            author.clone_into(&mut self.author);
        }
        (self.boot, self.is_left_alone) = (boot(), false);
        self.resuming = Some(key(author, id));
        self
    }

    /// The record after the runner was started.
    pub(super) fn resumed(mut self) -> Self {
        self.resumed.extend(self.resuming.take());
        self
    }

    /// `Some(true)` if this request of the author resumed the run, `Some(false)` if not. `None` if the server may have crashed before or
    /// after the start of the program.
    pub(super) fn was_resumed(&self, author: &str, id: &str, is_live: bool) -> Option<bool> {
        let key = key(author, id);
        if self.resumed.contains(&key) {
            return Some(true);
        }
        if self.resuming.as_ref() == Some(&key) {
            return is_live.then_some(true);
        }
        Some(false)
    }

    /// Unique key of a request to start a run.
    pub(super) fn start_key(author: &str, id: &str) -> String {
        format!("start/{}", key(author, id))
    }

    /// The key of the request that started this run.
    pub(super) fn key(&self) -> Option<String> {
        self.start.as_ref().map(|start| Self::start_key(&self.author, &start.id))
    }

    /// The machine that the request names.
    pub(super) fn machine(&self) -> Option<&MachineFile> {
        self.start.as_ref().map(|start| &start.machine)
    }

    /// True if a crashed run is resumed automatically: the computer was not restarted since the request.
    pub(super) fn may_go_on(&self) -> bool {
        !self.is_left_alone && !self.boot.is_empty() && self.boot == boot()
    }
}

/// Unique key of a request. Ids are unique per author.
pub(super) fn key(author: &str, id: &str) -> String {
    format!("{author}/{id}")
}

/// Id of the current boot. Empty if unknown.
fn boot() -> String {
    fs::read_to_string(BOOT_FILE).unwrap_or_default().trim().to_owned()
}

/// State of control stored in `folder`. Without a valid file, nobody holds control.
pub(super) fn read_holding(folder: &Path) -> Holding {
    let bytes = fs::read(folder.join(CONTROL_FILE)).unwrap_or_default();
    serde_json::from_slice(&bytes).unwrap_or_default()
}

/// Stores the state of control atomically.
pub(super) fn write_holding(folder: &Path, holding: &Holding) -> io::Result<()> {
    replace(&folder.join(CONTROL_FILE), &serde_json::to_vec(holding)?, false)
}

/// Replaces a file atomically, readable for its owner only. With `synced`, it survives a power cut.
fn replace(path: &Path, bytes: &[u8], synced: bool) -> io::Result<()> {
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
    use super::{CONTROL_FILE, REQUEST_FILE, RunRequest, read_holding, write_holding};
    use crate::runs::control::{GivenCommand, Holding};
    use std::os::unix::fs::PermissionsExt as _;
    use std::time::Duration;

    #[test]
    fn a_request_is_read_as_it_was_written_and_is_for_its_owner_only() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(RunRequest::read(folder.path()), None);
        let start = serde_json::json!({"id": "7", "machine": {"project": "p", "path": "pick"}});
        let request = RunRequest::to_start("ana", serde_json::from_value(start).unwrap());
        request.write(folder.path()).unwrap();
        assert_eq!(RunRequest::read(folder.path()), Some(request));
        let file = folder.path().join(REQUEST_FILE);
        assert_eq!(file.metadata().unwrap().permissions().mode() & 0o777, 0o600);
    }

    #[test]
    fn a_run_goes_on_by_itself_unless_the_computer_was_started_anew_or_it_is_left_alone() {
        let request = RunRequest::default().resuming("ana", "1");
        let fates = [true, false].map(|is_live| request.was_resumed("ana", "1", is_live));
        assert_eq!(fates, [Some(true), None]);
        let request = request.resumed();
        let fates = ["ana", "bob"].map(|author| request.was_resumed(author, "1", false));
        assert_eq!(fates, [Some(true), Some(false)]);
        assert!(request.may_go_on());
        assert!(!RunRequest { boot: "another".to_owned(), ..request.clone() }.may_go_on());
        assert!(!RunRequest { is_left_alone: true, ..request.clone() }.may_go_on());
        assert_eq!(request.author, "ana");
    }

    #[test]
    fn who_holds_a_run_is_kept_for_its_owner_only_and_has_time_again() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(read_holding(folder.path()), Holding::default());
        let mut holding = Holding::default();
        let given = GivenCommand { user: "ana", id: "ana/1", epoch: None };
        holding.command(given, 5, Duration::ZERO).unwrap();
        write_holding(folder.path(), &holding).unwrap();
        let told = read_holding(folder.path()).go_on(70).told(Duration::ZERO);
        assert_eq!((told.holder.as_deref(), told.since_ms, told.heard_ms), (Some("ana"), 5, 70));
        let file = folder.path().join(CONTROL_FILE);
        assert_eq!(file.metadata().unwrap().permissions().mode() & 0o777, 0o600);
        std::fs::write(file, "nonsense").unwrap();
        assert_eq!(read_holding(folder.path()), Holding::default());
    }
}
