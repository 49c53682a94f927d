//! Detects changes of other programs, with real files and real watches.

use super::*;
use crate::Settings;
use rafcon_protocol::api::{DiskState, MachineFile, NewMachine, SaveMachine};
use std::fs;
use std::path::Path;
use tokio::sync::watch::Receiver;
use tokio::time::timeout;

/// Far longer than the detection of a change takes.
const TEST_TIMEOUT: Duration = Duration::from_secs(30);

/// A server with a project and a library root in a temporary folder.
struct Place {
    folder: tempfile::TempDir,
    server: Arc<ServerState>,
    files: Receiver<u64>,
}

impl Place {
    /// When this returns, all folders are watched.
    async fn new(folders: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["project/state", "libraries"].iter().chain(folders) {
            fs::create_dir_all(folder.path().join(name)).unwrap();
        }
        let path = |name: &str| folder.path().join(name);
        let settings = Settings {
            projects: vec![path("project")],
            libraries: vec![("lib".to_owned(), path("libraries"))],
            ..Settings::new(path("project/state"), path("project/runs"))
        };
        let server = ServerState::new(settings).unwrap();
        let files = server.news.of_files();
        begin(&server);
        let mut place = Self { folder, server, files };
        place.news().await;
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Waits for a change of files.
    async fn news(&mut self) {
        timeout(TEST_TIMEOUT, self.files.changed()).await.expect("news").unwrap();
    }
}

fn machine(folder: &Path) {
    fs::create_dir_all(folder.join("STATE_A")).unwrap();
    fs::write(folder.join("statemachine.json"), "{}").unwrap();
}

#[tokio::test]
async fn a_new_machine_deep_in_new_folders_is_noticed_and_so_is_what_happens_to_it() {
    let mut place = Place::new(&[]).await;
    let deep = place.path("project/a/b/c");
    fs::create_dir_all(&deep).unwrap();
    place.news().await;
    machine(&deep);
    place.news().await;
    fs::rename(place.path("project/a/b"), place.path("project/a/d")).unwrap();
    place.news().await;
    fs::write(place.path("project/a/d/c/statemachine.json"), "[]").unwrap();
    place.news().await;
}

#[tokio::test]
async fn a_changed_library_is_read_again() {
    let mut place = Place::new(&["libraries/one/STATE_A"]).await;
    let before = place.server.projects.libraries();
    fs::write(place.path("libraries/one/STATE_A/script.py"), "").unwrap();
    place.news().await;
    assert!(!Arc::ptr_eq(&before, &place.server.projects.libraries()));
}

/// A machine that the server has made, and its id while it is open.
fn made(place: &Place) -> String {
    let file = MachineFile { project: "project".to_owned(), path: "one".to_owned() };
    let new = NewMachine { file, name: "Mission".to_owned() };
    place.server.documents.make(&place.server, &new).unwrap().id
}

#[tokio::test]
async fn what_another_program_does_to_an_open_machine_is_told_and_what_the_server_does_is_not() {
    let mut place = Place::new(&[]).await;
    let id = made(&place);
    place.server.documents.save(&place.server, &id, &SaveMachine::default()).unwrap();
    fs::write(place.path("project/one/notes.txt"), "").unwrap();
    place.news().await;
    let mut status = place.server.documents.session(&id).unwrap().status().unwrap();
    assert_eq!(status.borrow_and_update().summary.disk, DiskState::Same);

    let core = place.path("project/one/core_data.json");
    let text = fs::read_to_string(&core).unwrap();
    fs::write(&core, text.replace("Mission", "Errand")).unwrap();
    let is_changed = status.wait_for(|status| status.summary.disk == DiskState::Changed);
    timeout(TEST_TIMEOUT, is_changed).await.expect("a change").unwrap();

    fs::remove_dir_all(place.path("project/one")).unwrap();
    let is_missing = status.wait_for(|status| status.summary.disk == DiskState::Missing);
    timeout(TEST_TIMEOUT, is_missing).await.expect("a change").unwrap();
}
