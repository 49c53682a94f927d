//! The planned contacts of a station's robots: one file for each robot, shared between the station's thread and its server.
//!
//! Knows files. `rafcon_protocol::contacts` knows the content of a plan.

use parking_lot::Mutex;
use rafcon_protocol::{BadContacts, Contact, ContactPlan};
use rafcon_storage::journal::{JournalError, folder::replace_file, make_folder};
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Name of the file in the robot's folder at its station.
const CONTACTS_FILE: &str = "contacts.json";

/// The file with the contacts of one robot.
#[derive(Debug, Clone)]
pub struct ContactFile(PathBuf);

/// Reason why a file of contacts cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ContactFileError {
    /// The disk refuses to read it.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Error of the disk.
        source: io::Error,
    },
    /// Its content is no plan.
    #[error("{} is no plan of contacts: {source}; set the contacts again with `rafcon contacts`", path.display())]
    Bad {
        /// Path of the file.
        path: PathBuf,
        /// First fault of the list.
        source: BadContacts,
    },
}

impl ContactFile {
    /// The file of a robot whose folder at the station is `folder`.
    pub fn in_folder(folder: &Path) -> Self {
        Self(folder.join(CONTACTS_FILE))
    }

    /// Reads the plan; an empty one if there is no file.
    pub fn read(&self) -> Result<ContactPlan, ContactFileError> {
        let path = &self.0;
        match fs::read_to_string(path) {
            Ok(text) => ContactPlan::of_text(&text)
                .map_err(|source| ContactFileError::Bad { path: path.clone(), source }),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(ContactPlan::default()),
            Err(source) => Err(ContactFileError::Io { path: path.clone(), source }),
        }
    }

    /// Replaces the plan atomically.
    pub fn write(&self, plan: &ContactPlan) -> Result<(), JournalError> {
        if let Some(folder) = self.0.parent() {
            make_folder(folder)?;
        }
        let mut text = serde_json::to_string_pretty(&plan.windows()).unwrap_or_default();
        text.push('\n');
        replace_file(&self.0, text.as_bytes())
    }

    /// Identity of the content: another one after each change.
    fn version(&self) -> Option<FileVersion> {
        let about = fs::metadata(&self.0).ok()?;
        Some(FileVersion {
            inode: about.ino(),
            length: about.len(),
            changed: (about.mtime(), about.mtime_nsec()),
        })
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct FileVersion {
    inode: u64,
    length: u64,
    changed: (i64, i64),
}

/// The contacts of all robots that a station receives.
#[derive(Debug, Clone, Default)]
pub struct ContactStore(Arc<SharedContacts>);

#[derive(Debug, Default)]
struct SharedContacts {
    robots: Mutex<BTreeMap<String, RobotContacts>>,
    /// Held while a file is read or written. A reader of a known plan does not wait for the disk.
    files: Mutex<()>,
}

#[derive(Debug)]
struct RobotContacts {
    file: ContactFile,
    version: Option<FileVersion>,
    known: KnownContacts,
}

/// Contacts of a robot, as the station knows them.
#[derive(Debug, Clone, Default)]
pub struct KnownContacts {
    /// The plan. After a problem it is the last one that was read.
    pub plan: Arc<ContactPlan>,
    /// Reason why the file cannot be read, if it cannot.
    pub problem: Option<String>,
}

/// Reason why contacts were not stored.
#[derive(Debug, thiserror::Error)]
pub enum ContactsNotSet {
    /// The station does not receive this robot.
    #[error("this server does not receive the robot: run it as its station (`rafcon station`)")]
    NotReceived,
    /// The disk refuses to write them.
    #[error("the contacts are not stored, the plan before counts: {0}")]
    Disk(#[from] JournalError),
}

impl KnownContacts {
    /// The open contact, or else the next one. `None` if no contact is planned, or that is unknown.
    pub fn current(&self, now_ms: u64) -> Option<&Contact> {
        self.plan.current(now_ms)
    }
}

impl ContactStore {
    /// The contacts of a robot that the station receives.
    pub fn known(&self, robot: &str) -> Option<KnownContacts> {
        self.0.robots.lock().get(robot).map(|robot| robot.known.clone())
    }

    /// Stores a plan, then uses it.
    pub fn set(&self, robot: &str, plan: ContactPlan) -> Result<(), ContactsNotSet> {
        let _files = self.0.files.lock();
        let file = self.0.robots.lock().get(robot).map(|robot| robot.file.clone());
        let file = file.ok_or(ContactsNotSet::NotReceived)?;
        file.write(&plan)?;
        let known = KnownContacts { plan: Arc::new(plan), problem: None };
        // The next refresh reads the file: another program may have replaced it since.
        let contacts = RobotContacts { file, version: None, known };
        self.0.robots.lock().insert(robot.to_owned(), contacts);
        Ok(())
    }

    /// Notes that the station receives this robot, whose folder there is `folder`. Returns a problem of its file.
    pub(crate) fn receive(&self, robot: &str, folder: &Path) -> Option<String> {
        let file = ContactFile::in_folder(folder);
        let (version, known) = (file.version(), read(&file, KnownContacts::default()));
        let problem = known.problem.clone();
        let contacts = RobotContacts { file, version, known };
        self.0.robots.lock().insert(robot.to_owned(), contacts);
        problem
    }

    /// Reads the plan again if another program has changed the file. Returns a new problem.
    pub(crate) fn refresh(&self, robot: &str) -> Option<String> {
        // A plan that is being set needs no reading.
        let _files = self.0.files.try_lock()?;
        let (file, before) = {
            let robots = self.0.robots.lock();
            let contacts = robots.get(robot)?;
            (contacts.file.clone(), contacts.version)
        };
        let version = file.version();
        if version == before {
            return None;
        }
        let known = read(&file, self.known(robot)?);
        let problem = known.problem.clone();
        let contacts = RobotContacts { file, version, known };
        self.0.robots.lock().insert(robot.to_owned(), contacts);
        problem
    }
}

/// The plan in a file. If it cannot be read, the plan before stays, with the reason.
fn read(file: &ContactFile, before: KnownContacts) -> KnownContacts {
    match file.read() {
        Ok(plan) => KnownContacts { plan: Arc::new(plan), problem: None },
        Err(error) => KnownContacts { problem: Some(error.to_string()), ..before },
    }
}

#[cfg(test)]
mod tests {
    use super::{ContactFile, ContactStore, ContactsNotSet};
    use rafcon_protocol::ContactPlan;
    use std::fs;
    use std::os::unix::fs::PermissionsExt as _;

    fn plan(end: &str) -> ContactPlan {
        let text = format!(
            r#"[{{"begin": "2026-11-28T14:00:00Z", "end": "2026-11-28T{end}:00Z", "profile": "deep"}}]"#
        );
        ContactPlan::of_text(&text).unwrap()
    }

    #[test]
    fn a_plan_is_private_and_survives_a_restart() {
        let folder = tempfile::tempdir().unwrap();
        let robot = folder.path().join("scout");
        let store = ContactStore::default();
        assert!(matches!(store.set("scout", plan("14:20")), Err(ContactsNotSet::NotReceived)));
        assert!(store.known("scout").is_none());
        assert_eq!(store.receive("scout", &robot), None);
        assert_eq!(*store.known("scout").unwrap().plan, ContactPlan::default());
        store.set("scout", plan("14:20")).unwrap();
        assert_eq!(*store.known("scout").unwrap().plan, plan("14:20"));
        let file = robot.join("contacts.json");
        assert_eq!(file.metadata().unwrap().permissions().mode() & 0o777, 0o600);
        let again = ContactStore::default();
        assert_eq!(again.receive("scout", &robot), None);
        assert_eq!(*again.known("scout").unwrap().plan, plan("14:20"));
    }

    #[test]
    fn a_file_that_another_program_changes_is_read_and_a_bad_one_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let store = ContactStore::default();
        assert_eq!(store.receive("scout", folder.path()), None);
        ContactFile::in_folder(folder.path()).write(&plan("14:20")).unwrap();
        assert_eq!(store.refresh("scout"), None);
        assert_eq!(*store.known("scout").unwrap().plan, plan("14:20"));
        fs::write(folder.path().join("contacts.json"), "[1]").unwrap();
        let problem = store.refresh("scout").unwrap();
        assert!(problem.contains("is no plan of contacts: window 1: "), "{problem}");
        // It is reported once.
        assert_eq!(store.refresh("scout"), None);
        let known = store.known("scout").unwrap();
        assert_eq!((&*known.plan, known.problem.as_ref()), (&plan("14:20"), Some(&problem)));
        // A station that starts with it knows no plan.
        assert_eq!(ContactStore::default().receive("scout", folder.path()), Some(problem));
        store.set("scout", plan("15:00")).unwrap();
        assert!(store.known("scout").unwrap().problem.is_none());
        assert_eq!(store.refresh("scout"), None);
        fs::remove_file(folder.path().join("contacts.json")).unwrap();
        assert_eq!(store.refresh("scout"), None);
        assert_eq!(*store.known("scout").unwrap().plan, ContactPlan::default());
    }
}
