//! Data in a run's folder for resuming the run: its description, the marks of running scripts, and the journal. Unreadable data
//! counts as missing.

use rafcon_model::Machine;
use rafcon_protocol::{Crash, Event, Launch, OnCrash, Resume, active};
use rafcon_storage::journal::folder::ABOUT_FILE;
use rafcon_storage::journal::{About, Hash, Packed, Reader, Record, has_begun};
use rafcon_storage::{Libraries, load_packed};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Number of last events that are searched for log lines.
const EVENTS: u64 = 5000;

/// Paths of the states whose scripts ran when the runner of this folder ended. More reliable than its last messages: a mark is
/// written before its script begins.
pub fn running(folder: &Path) -> Vec<String> {
    let slots = fs::read(folder.join(active::SLOTS_FILE)).unwrap_or_default();
    let paths = fs::read_to_string(folder.join(active::PATHS_FILE)).unwrap_or_default();
    active::running(&slots, &paths)
}

/// Time and event of the run's end, if its runner stored an end that it could no longer report.
pub fn kept_end(folder: &Path) -> Option<(Duration, Event)> {
    Reader::open(folder).ok()?.last_end().ok()?
}

/// The last log line of each of these states, by path.
pub fn last_logged(folder: &Path, active: &[String]) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let Ok(mut reader) = Reader::open(folder) else { return found };
    let first = reader.last_sequence().unwrap_or_default().saturating_sub(EVENTS) + 1;
    let events = reader.page(first, usize::try_from(EVENTS).unwrap_or_default());
    for entry in events.unwrap_or_default() {
        let Record::Log { place: Some(place), message, .. } = entry.record else { continue };
        let Some(place) = reader.known_places().get(place) else { continue };
        if active.contains(&place.path) {
            found.insert(place.path.clone(), message);
        }
    }
    found
}

/// Stored facts about a run, for the decision to resume it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KeptRun {
    /// Policy for scripts that a crash interrupted.
    pub policy: OnCrash,
    /// True if the run has events.
    pub has_begun: bool,
}

impl KeptRun {
    /// The facts about the run in `folder`. Uses the requested policy if the run has not stored one.
    pub fn of(folder: &Path, asked: Option<OnCrash>) -> Self {
        let keeps_itself = folder.join(ABOUT_FILE).exists();
        let policy = if keeps_itself { policy_of(folder) } else { asked.unwrap_or_default() };
        Self { policy, has_begun: has_begun(folder) }
    }
}

/// The launch that resumes the run in `folder` with `policy`, from its end or from the event `from`.
pub fn resume_launch(folder: &Path, policy: OnCrash, from: Option<u64>) -> Launch {
    Launch {
        machine: machine_of(folder),
        run_folder: Some(folder.to_path_buf()),
        resume: Some(Resume { policy, from }),
        crash: Some(Crash {
            reason: "the runner ended before the run".to_owned(),
            active: running(folder),
        }),
        listen: true,
        ..Launch::default()
    }
}

/// Stored path of the run's machine. Empty if unknown.
pub fn machine_of(folder: &Path) -> PathBuf {
    let about = about(folder);
    let machine = about.as_ref().and_then(|about| about.get("machine")?.as_str());
    machine.map(PathBuf::from).unwrap_or_default()
}

/// The stored machine with this hash; without a hash, the current one.
pub fn kept_machine(folder: &Path, hash: Option<&str>) -> Option<Machine> {
    let goes_by = || {
        let mut reader = Reader::open(folder).ok()?;
        let last = reader.last_sequence().ok()?;
        reader.moment(last).ok()?.whole().root.clone()
    };
    let hash = Hash::parse(&hash.map(ToOwned::to_owned).or_else(goes_by)?)?;
    let packed = Arc::new(Packed::read(folder, hash).ok()?);
    let libraries = Libraries::default().packed(Arc::clone(&packed));
    let folder = Path::new(Packed::MACHINE);
    Some(load_packed(&packed, Packed::MACHINE, folder, &libraries).ok()?.machine)
}

/// Stored policy for scripts that a crash interrupted.
pub fn policy_of(folder: &Path) -> OnCrash {
    about(folder)
        .and_then(|about| serde_json::from_value(about.get("on_crash")?.clone()).ok())
        .unwrap_or_default()
}

/// The run's description. `None` if its file is missing or damaged.
fn about(folder: &Path) -> Option<serde_json::Value> {
    About::json(folder).ok()
}

#[cfg(test)]
mod tests {
    use super::{policy_of, resume_launch};
    use expect_test::{Expect, expect};
    use rafcon_protocol::OnCrash;

    fn check(about: Option<&str>, expect: &Expect) {
        let folder = tempfile::tempdir().unwrap();
        if let Some(about) = about {
            std::fs::write(folder.path().join("run.json"), about).unwrap();
        }
        let launch = resume_launch(folder.path(), OnCrash::Restart, Some(7));
        assert_eq!(launch.run_folder.as_deref(), Some(folder.path()));
        let facts = (launch.machine, launch.resume, launch.listen, policy_of(folder.path()));
        expect.assert_eq(&format!("{facts:?}"));
    }

    #[test]
    fn a_run_is_resumed_as_it_says_itself() {
        check(
            Some(r#"{"machine": "/m/pick", "on_crash": "abort"}"#),
            &expect![[
                r#"("/m/pick", Some(Resume { policy: Restart, from: Some(7) }), true, Abort)"#
            ]],
        );
    }

    #[test]
    fn a_run_that_says_nothing_asks() {
        let nothing =
            &expect![[r#"("", Some(Resume { policy: Restart, from: Some(7) }), true, Ask)"#]];
        for about in [None, Some("{"), Some("{}"), Some(r#"{"on_crash": "dance"}"#)] {
            check(about, nothing);
        }
    }
}
