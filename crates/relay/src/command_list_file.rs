//! The command list of a robot at its station: one file, with the mark of its release. Knows files, and no robot.

use rafcon_protocol::{
    BadCommandList, CommandList, ContactPlan, GivenTimes, LISTED_MAX, ListLine, ListRelease,
    ListTimes, ListedCommand, list_times,
};
use rafcon_storage::journal::{JournalError, folder::replace_file, make_folder};
use rustix::rand::{GetRandomFlags, getrandom};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

/// Name of the file in the robot's folder at its station.
const LIST_FILE: &str = "commands.json";
/// Attempts to lock the list, and the interval between them. A change takes milliseconds.
const LOCK_ATTEMPTS_MAX: u32 = 40;
const LOCK_EVERY: Duration = Duration::from_millis(50);

/// The file with the command list of one robot.
#[derive(Debug, Clone)]
pub struct CommandListFile(PathBuf);

/// Reason why a file of commands cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum CommandListFileError {
    /// The disk refuses to read it.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Error of the disk.
        source: io::Error,
    },
    /// Its content is no list of commands.
    #[error("{} is no list of commands ({fault}): set the commands again with `rafcon commands`", path.display())]
    Bad {
        /// Path of the file.
        path: PathBuf,
        /// First fault.
        fault: String,
    },
    /// The disk refuses to write it.
    #[error("the commands are not stored, the list before counts: {0}")]
    NotWritten(#[from] JournalError),
    /// The disk refuses the lock that keeps other programs from changing the list.
    #[error("the commands are not stored, because {} cannot be locked: {source}", path.display())]
    NotLocked {
        /// Path of the lock.
        path: PathBuf,
        /// Error of the disk.
        source: io::Error,
    },
    /// Another program holds the lock for too long.
    #[error(
        "the commands are not stored, because another program is changing the list: end it, or try again"
    )]
    Busy,
    /// Another user or program has set or released a list since.
    #[error("the list was changed since it was read: nothing was stored; read it again")]
    Changed,
    /// The system gives no random numbers.
    #[error("the commands are not stored: the system gives no random numbers: {0}")]
    NoRandom(rustix::io::Errno),
}

/// A list of commands as it is on the disk.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct StoredList {
    /// Random text, so that equal lists have different revisions.
    salt: String,
    commands: Vec<ListedCommand>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    released: Option<StoredRelease>,
}

/// Mark of a release. It is on the disk before any command is sent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct StoredRelease {
    revision: String,
    at_ms: u64,
    user: String,
    /// Times of each command: later releases do not change them.
    times: Vec<ListTimes>,
}

impl CommandListFile {
    /// The file of a robot whose folder at the station is `folder`.
    pub fn in_folder(folder: &Path) -> Self {
        Self(folder.join(LIST_FILE))
    }

    /// Reads the list; an empty one if there is no file.
    pub fn read(&self) -> Result<StoredList, CommandListFileError> {
        let path = || self.0.clone();
        let text = match fs::read_to_string(&self.0) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Ok(StoredList::default());
            }
            Err(source) => return Err(CommandListFileError::Io { path: path(), source }),
        };
        let bad = |fault| CommandListFileError::Bad { path: path(), fault };
        let list: StoredList =
            serde_json::from_str(&text).map_err(|error| bad(error.to_string()))?;
        list.check().map_err(bad)?;
        Ok(list)
    }

    /// Replaces the list atomically by one that is not released and has another revision. With a `revision`, only a list of this
    /// revision is replaced.
    pub fn set(
        &self,
        commands: Vec<ListedCommand>,
        revision: Option<&str>,
    ) -> Result<StoredList, CommandListFileError> {
        let _lock = self.lock()?;
        if let Some(revision) = revision
            && self.read()?.revision() != revision
        {
            return Err(CommandListFileError::Changed);
        }
        let mut random = [0; 8];
        getrandom(&mut random, GetRandomFlags::empty()).map_err(CommandListFileError::NoRandom)?;
        let list = StoredList { salt: hex(&random), commands, released: None };
        self.write(&list)?;
        Ok(list)
    }

    /// Replaces exactly this list.
    pub(crate) fn replace(
        &self,
        before: &StoredList,
        list: &StoredList,
    ) -> Result<(), CommandListFileError> {
        let _lock = self.lock()?;
        if self.read()? != *before {
            return Err(CommandListFileError::Changed);
        }
        Ok(self.write(list)?)
    }

    /// Waits until no other program changes the list, but not for one that hangs. The lock ends with the returned file.
    #[expect(clippy::disallowed_methods, reason = "no event reports that a file is unlocked")]
    fn lock(&self) -> Result<File, CommandListFileError> {
        let path = self.0.with_extension("lock");
        if let Some(folder) = self.0.parent() {
            make_folder(folder)?;
        }
        let not_locked = |source| CommandListFileError::NotLocked { path: path.clone(), source };
        let file = File::create(&path).map_err(not_locked)?;
        for _attempt in 0..LOCK_ATTEMPTS_MAX {
            match file.try_lock() {
                Ok(()) => return Ok(file),
                Err(TryLockError::WouldBlock) => thread::sleep(LOCK_EVERY),
                Err(TryLockError::Error(source)) => return Err(not_locked(source)),
            }
        }
        Err(CommandListFileError::Busy)
    }

    fn write(&self, list: &StoredList) -> Result<(), JournalError> {
        let mut text = serde_json::to_string_pretty(list).unwrap_or_default();
        text.push('\n');
        replace_file(&self.0, text.as_bytes())
    }
}

impl StoredList {
    /// The commands, in their order.
    pub fn commands(&self) -> &[ListedCommand] {
        &self.commands
    }

    /// The revision. It names salt and content.
    pub fn revision(&self) -> String {
        let content = serde_json::to_vec(&(&self.salt, &self.commands)).unwrap_or_default();
        hex(&blake3::hash(&content).as_bytes()[..8])
    }

    /// The list as the station's disk has it: without delay, faults that the link finds, and fates.
    pub fn without_link(&self, plan: &ContactPlan, now_ms: u64) -> CommandList {
        let line = |times: Result<ListTimes, String>| {
            let ListTimes { not_before_ms, expiry_ms } = times.clone().unwrap_or_default();
            let given = GivenTimes { given_ms: now_ms, delay_ms: None, not_before_ms };
            let send_at_ms = plan.expected(given, now_ms).send_at_ms;
            LineReport {
                times: ListTimes { not_before_ms, expiry_ms },
                send_at_ms: send_at_ms.filter(|_| self.released.is_none()),
                fault: times.err(),
                ..LineReport::default()
            }
        };
        self.with(self.times(plan, now_ms).into_iter().map(line).collect())
    }

    /// The list with what is known of each line.
    pub(crate) fn with(&self, reports: Vec<LineReport>) -> CommandList {
        let line = |(listed, report): (&ListedCommand, LineReport)| {
            let LineReport { times, send_at_ms, effect_ms, fault, fate } = report;
            let ListTimes { not_before_ms, expiry_ms: expires_ms } = times;
            let listed = listed.clone();
            ListLine { listed, not_before_ms, expires_ms, send_at_ms, effect_ms, fault, fate }
        };
        let release = |it: &StoredRelease| ListRelease { at_ms: it.at_ms, user: it.user.clone() };
        CommandList {
            revision: self.revision(),
            released: self.released.as_ref().map(release),
            lines: self.commands.iter().zip(reports).map(line).collect(),
        }
    }

    /// Id of each command.
    pub(crate) fn ids(&self) -> Vec<String> {
        let revision = self.revision();
        (0..self.commands.len()).map(|line| CommandList::id(&revision, line)).collect()
    }

    pub(crate) fn is_released(&self) -> bool {
        self.released.is_some()
    }

    /// Times of each command: those of the release, or those that a release now would give.
    pub(crate) fn times(&self, plan: &ContactPlan, now_ms: u64) -> Vec<Result<ListTimes, String>> {
        match &self.released {
            Some(release) => release.times.iter().copied().map(Ok).collect(),
            None => list_times(&self.commands, plan, now_ms),
        }
    }

    /// The same list with the mark of a release.
    pub(crate) fn released(&self, user: &str, at_ms: u64, times: Vec<ListTimes>) -> Self {
        let release =
            StoredRelease { revision: self.revision(), at_ms, user: user.to_owned(), times };
        Self { released: Some(release), ..self.clone() }
    }

    fn check(&self) -> Result<(), String> {
        if self.commands.len() > LISTED_MAX {
            return Err(BadCommandList::TooMany(self.commands.len()).to_string());
        }
        match &self.released {
            Some(it) if it.revision != self.revision() || it.times.len() != self.commands.len() => {
                Err("it was changed after its release".to_owned())
            }
            _ => Ok(()),
        }
    }
}

/// State of a line, as the station knows it.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct LineReport {
    pub(crate) times: ListTimes,
    pub(crate) send_at_ms: Option<u64>,
    pub(crate) effect_ms: Option<u64>,
    pub(crate) fault: Option<String>,
    pub(crate) fate: Option<rafcon_protocol::ListFate>,
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a string does not fail.
        let _written = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rafcon_protocol::Command;
    use std::os::unix::fs::PermissionsExt as _;

    fn commands() -> Vec<ListedCommand> {
        let run = "r".to_owned();
        vec![ListedCommand { run, command: Command::Pause, not_before: None, expiry: None }]
    }

    #[test]
    fn each_list_that_is_set_has_its_own_ids() {
        let folder = tempfile::tempdir().unwrap();
        let file = CommandListFile::in_folder(&folder.path().join("scout"));
        assert_eq!(file.read().unwrap(), StoredList::default());
        let first = file.set(commands(), None).unwrap();
        assert_eq!(file.read().unwrap(), first);
        let mode = folder.path().join("scout/commands.json").metadata().unwrap().permissions();
        assert_eq!(mode.mode() & 0o777, 0o600);
        let second = file.set(commands(), None).unwrap();
        assert_ne!(first.revision(), second.revision());
        assert_ne!(first.ids(), second.ids());
        let released = second.released("ana", 7, vec![ListTimes::default()]);
        assert_eq!((released.ids(), released.revision()), (second.ids(), second.revision()));
    }

    /// Two programs hold files of their own.
    #[test]
    fn of_two_changes_of_one_revision_one_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = CommandListFile::in_folder(folder.path());
        let before = file.set(commands(), None).unwrap();
        let revision = before.revision();
        let change = || {
            let file = CommandListFile::in_folder(folder.path());
            (0..50).filter(|_| file.set(Vec::new(), Some(&revision)).is_ok()).count()
        };
        let mark = || {
            let marked = before.released("ana", 7, vec![ListTimes::default()]);
            let file = CommandListFile::in_folder(folder.path());
            (0..50).filter(|_| file.replace(&before, &marked).is_ok()).count()
        };
        let (changed, marked) = thread::scope(|scope| {
            let (changed, marked) = (scope.spawn(change), scope.spawn(mark));
            (changed.join().unwrap(), marked.join().unwrap())
        });
        // A release does not change the revision: after it, the list can be set, not before it and released.
        assert!(matches!((changed, marked), (1, 0 | 1)), "{changed} {marked}");
        assert!(!file.read().unwrap().is_released());
        let late = file.set(Vec::new(), Some(&revision)).unwrap_err();
        assert!(matches!(late, CommandListFileError::Changed), "{late}");
    }

    #[test]
    fn a_program_that_hangs_with_the_lock_holds_up_no_other_for_ever() {
        let folder = tempfile::tempdir().unwrap();
        let file = CommandListFile::in_folder(folder.path());
        let held = file.lock().unwrap();
        let refused = file.set(commands(), None).unwrap_err();
        assert!(matches!(refused, CommandListFileError::Busy), "{refused}");
        assert_eq!(file.read().unwrap(), StoredList::default());
        drop(held);
        file.set(commands(), None).unwrap();
    }

    #[test]
    fn a_list_that_was_changed_after_its_release_is_no_list() {
        let folder = tempfile::tempdir().unwrap();
        let file = CommandListFile::in_folder(folder.path());
        let list =
            file.set(commands(), None).unwrap().released("ana", 7, vec![ListTimes::default()]);
        file.write(&list).unwrap();
        assert_eq!(file.read().unwrap(), list);
        let path = folder.path().join("commands.json");
        let text = fs::read_to_string(&path).unwrap();
        let check = |text: &str, fault: &str| {
            fs::write(&path, text).unwrap();
            let error = file.read().unwrap_err().to_string();
            assert!(error.contains(&format!("is no list of commands ({fault}")), "{error}");
        };
        check(&text.replace("pause", "stop"), "it was changed after its release");
        check("[]", "invalid length 0");
        let line = serde_json::to_value(&commands()[0]).unwrap();
        let many = serde_json::json!({ "salt": "", "commands": vec![line; LISTED_MAX + 1] });
        check(&many.to_string(), "the list has 101 commands and the limit is 100");
    }
}
