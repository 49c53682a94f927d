//! What a server keeps in the folder of a run, so that another server knows: who commands it; and, written down before it is
//! started or resumed, who asked for that, by which id, and since when this computer is up. Knows nothing of the rules.

use super::control::Holding;
use rafcon_protocol::api::{MachineFile, StartRun};
use serde::{Deserialize, Serialize};
use std::fs::{self, OpenOptions};
use std::io::{self, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;
use std::time::Duration;

/// The file of a request.
const REQUEST_FILE: &str = "request.json";
/// The file of who holds control.
const CONTROL_FILE: &str = "control.json";
/// So long a run that has not begun waits for the same request.
const REMEMBERED: Duration = Duration::from_hours(24);
/// Where Linux tells one start of the computer from another.
const BOOT_FILE: &str = "/proc/sys/kernel/random/boot_id";

/// What a server was asked about one run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct RunRequest {
    /// Who asked first.
    pub(super) author: String,
    /// When it was asked last, this computer had been started as this.
    pub(super) boot: String,
    /// What was started; nothing if the run was only resumed here.
    #[serde(default)]
    pub(super) start: Option<StartRun>,
    /// By which it was resumed: authors with their ids.
    #[serde(default)]
    pub(super) resumed: Vec<String>,
    /// By which it was about to be resumed when this was written: whether a runner was started is not known.
    #[serde(default)]
    pub(super) resuming: Option<String>,
    /// No one resumes the run by itself any more: someone has to decide.
    #[serde(default)]
    pub(super) is_left_alone: bool,
}

impl RunRequest {
    /// That a run is started.
    pub(super) fn to_start(author: &str, start: StartRun) -> Self {
        Self { author: author.to_owned(), boot: boot(), start: Some(start), ..Self::default() }
    }

    /// What was asked about the run in `folder`; nothing if no server was.
    pub(super) fn read(folder: &Path) -> Option<Self> {
        serde_json::from_slice(&fs::read(folder.join(REQUEST_FILE)).ok()?).ok()
    }

    /// Whether no one will ask again for the run in `folder`, which has not begun.
    pub(super) fn is_forgotten(folder: &Path) -> bool {
        let written = fs::metadata(folder.join(REQUEST_FILE)).and_then(|about| about.modified());
        let age = written.ok().and_then(|written| written.elapsed().ok());
        age.is_some_and(|age| age > REMEMBERED)
    }

    /// Writes it down, safe from a power cut.
    pub(super) fn write(&self, folder: &Path) -> io::Result<()> {
        replace(&folder.join(REQUEST_FILE), &serde_json::to_vec(self)?, true)
    }

    /// Nothing was asked after all.
    pub(super) fn remove(folder: &Path) -> io::Result<()> {
        fs::remove_file(folder.join(REQUEST_FILE))
    }

    /// The same, about to be resumed by someone.
    pub(super) fn resuming(mut self, author: &str, id: &str) -> Self {
        if self.start.is_none() && self.resumed.is_empty() {
            author.clone_into(&mut self.author);
        }
        (self.boot, self.is_left_alone) = (boot(), false);
        self.resuming = Some(key(author, id));
        self
    }

    /// The same, with a runner.
    pub(super) fn resumed(mut self) -> Self {
        self.resumed.extend(self.resuming.take());
        self
    }

    /// True if this request of the author resumed the run, false if not; none if the server that began it may have died before the
    /// program ran, or after.
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

    /// What tells a request to start a run from all other requests.
    pub(super) fn start_key(author: &str, id: &str) -> String {
        format!("start/{}", key(author, id))
    }

    /// The same of what was started here.
    pub(super) fn key(&self) -> Option<String> {
        self.start.as_ref().map(|start| Self::start_key(&self.author, &start.id))
    }

    /// The machine, as it was named.
    pub(super) fn machine(&self) -> Option<&MachineFile> {
        self.start.as_ref().map(|start| &start.machine)
    }

    /// Whether a run that is found dead is resumed without being asked: this computer was not started anew since.
    pub(super) fn may_go_on(&self) -> bool {
        !self.is_left_alone && !self.boot.is_empty() && self.boot == boot()
    }
}

/// Ids are their author's own: those of others are others.
pub(super) fn key(author: &str, id: &str) -> String {
    format!("{author}/{id}")
}

/// This start of the computer; empty where it cannot be told.
fn boot() -> String {
    fs::read_to_string(BOOT_FILE).unwrap_or_default().trim().to_owned()
}

/// What the run in `folder` keeps; no one holds it if it keeps nothing that can be read.
pub(super) fn read_holding(folder: &Path) -> Holding {
    let bytes = fs::read(folder.join(CONTROL_FILE)).unwrap_or_default();
    serde_json::from_slice(&bytes).unwrap_or_default()
}

/// Keeps it: there is the old file or the new one, whatever happens.
pub(super) fn write_holding(folder: &Path, holding: &Holding) -> io::Result<()> {
    replace(&folder.join(CONTROL_FILE), &serde_json::to_vec(holding)?, false)
}

/// Writes a file for its owner only, as a whole; with `synced` it outlives a power cut.
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
