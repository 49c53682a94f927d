//! Saves machines and states. Never overwrites an open machine, and never writes into another machine.

use super::disk;
use super::documents::Documents;
use super::session::{FileLocation, Saving};
use crate::projects::is_machine;
use crate::{Failure, ServerState};
use rafcon_model::{Header, Kind, Machine, State, StatePath};
use rafcon_protocol::api::{LibraryName, SaveMachine, SaveState, SavedState};
use rafcon_protocol::calendar::Date;
use rafcon_supervisor::clock::since_1970_ms;
use std::fs;
use std::sync::Arc;

impl Documents {
    /// Saves an open machine and returns the saved revision.
    pub(crate) fn save(
        &self,
        server: &ServerState,
        id: &str,
        wish: &SaveMachine,
    ) -> Result<u64, Failure> {
        let session = self.session(id)?;
        let to =
            wish.file.as_ref().map(|file| self.requested_location(server, file)).transpose()?;
        let to = to.filter(|location| location.folder != session.folder());
        if wish.copy && to.is_none() {
            let message = "a copy needs a folder of its own: name one in `file`";
            return Err(Failure::bad("no_place_for_a_copy", message));
        }
        let _claim = to.as_ref().map(|location| self.claim(&location.folder));
        if let Some(location) = &to {
            self.must_be_free(server, location, wish.overwrite)?;
        }
        let tools = self.tools(server);
        let revision = match to {
            Some(location) if wish.copy => session.copy(&location, &tools)?,
            to => session.save(&Saving { to, overwrite: wish.overwrite }, &tools)?,
        };
        server.news.machines();
        Ok(revision)
    }

    /// Saves a state of an open machine as a separate machine.
    pub(crate) fn save_state(
        &self,
        server: &ServerState,
        id: &str,
        wish: &SaveState,
    ) -> Result<SavedState, Failure> {
        let (_, machine) = self.session(id)?.machine();
        let state = machine.state(&StatePath::parse(&wish.path)).ok_or_else(|| {
            let message = format!("there is no state {}: it may have changed", wish.path);
            Failure::not_found("no_such_state", message)
        })?;
        let machine = of_state(state)?;
        let location = self.requested_location(server, &wish.file)?;
        let _claim = self.claim(&location.folder);
        self.must_be_free(server, &location, wish.overwrite)?;
        let tools = self.tools(server);
        disk::write(&machine, &location.folder, None, tools.naming)?;
        server.news.files();
        let library = tools.libraries.reference(&location.folder);
        let library =
            library.map(|(path, name)| LibraryName { path: path.into(), name: name.into() });
        Ok(SavedState { file: location.file, library })
    }

    /// Refuses a target folder if the save could destroy data, or would be lost itself.
    fn must_be_free(
        &self,
        server: &ServerState,
        location: &FileLocation,
        overwrite: bool,
    ) -> Result<(), Failure> {
        let path = &location.file.path;
        unless_in_a_machine(server, location)?;
        if self.room_of(&location.folder).is_some() {
            let message = format!("{path} is open: close it first");
            return Err(Failure::conflict("is_open", message));
        }
        if location.draft.exists() {
            let message = format!(
                "{path} has edits that a server that ended had taken: open it and save or close it first"
            );
            return Err(Failure::conflict("has_draft", message));
        }
        if !location.folder.exists() {
            return Ok(());
        }
        if !overwrite {
            let message = format!("{path} exists: choose another folder, or save with `overwrite`");
            return Err(Failure::conflict("folder_exists", message));
        }
        let is_empty =
            fs::read_dir(&location.folder).is_ok_and(|mut inside| inside.next().is_none());
        if is_machine(&location.folder) || is_empty {
            return Ok(());
        }
        let message = format!("{path} is no machine, and not empty: choose another folder");
        Err(Failure::conflict("not_a_machine", message))
    }
}

/// Refuses a folder inside another machine, which would load it as one of its states.
pub(super) fn unless_in_a_machine(
    server: &ServerState,
    location: &FileLocation,
) -> Result<(), Failure> {
    let home = &server.projects.named(&location.file.project)?.folder;
    let mut around =
        location.folder.ancestors().skip(1).take_while(|folder| folder.starts_with(home));
    let Some(machine) = around.find(|folder| is_machine(folder)) else { return Ok(()) };
    let message = format!(
        "{} lies in the machine {}: choose a folder outside of it",
        location.file.path,
        machine.display()
    );
    Err(Failure::conflict("inside_a_machine", message))
}

/// A machine with this state as its root.
fn of_state(state: &Arc<State>) -> Result<Machine, Failure> {
    let refused = |message: String| Err(Failure::unprocessable("no_machine", message));
    match &state.kind {
        Kind::Library(library) => refused(format!(
            "{} runs the library {}/{}: save that under another name",
            state.name, library.path, library.name
        )),
        Kind::Decider(_) => refused(format!(
            "{} is the decider of its barrier, and belongs there: save the barrier",
            state.name
        )),
        Kind::Execution(_) | Kind::Hierarchy(_) | Kind::Barrier(_) | Kind::Preemptive(_) => {
            let now = Date::since_1970(since_1970_ms() / 1000).to_string();
            let header = Header { creation_time: now.into(), ..Header::default() };
            Ok(Machine { header, root: Arc::clone(state) })
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::documents::operation::EditRequest;
    use crate::documents::session::Saving;
    use crate::documents::{MachineSession, Operation};
    use crate::{ServerState, Settings};
    use proptest::collection::vec;
    use proptest::prelude::*;
    use rafcon_protocol::api::{CloseMachine, DiskState, EditMachine, MachineFile, NewMachine};
    use rafcon_protocol::edit::Edit;
    use rafcon_testkit::edits::{Dice, edit};
    use std::fs;
    use std::path::Path;
    use std::sync::Arc;

    /// A server with an open machine `Mission` in `project/one`.
    fn open(place: &Path) -> (Arc<ServerState>, Arc<MachineSession>) {
        for folder in ["project", "state"] {
            fs::create_dir(place.join(folder)).unwrap();
        }
        let settings = Settings::new(place.join("state"), place.join("runs"));
        let projects = vec![place.join("project")];
        let server = ServerState::new(Settings { projects, ..settings }).unwrap();
        let file = MachineFile { project: "project".to_owned(), path: "one".to_owned() };
        let new = NewMachine { file, name: "Mission".to_owned() };
        let id = server.documents.make(&server, &new).unwrap().id;
        let session = server.documents.session(&id).unwrap();
        (server, session)
    }

    /// A save that waited while another client closed the machine and discarded its edits.
    #[test]
    fn what_was_given_up_is_not_saved() {
        let place = tempfile::tempdir().unwrap();
        let (server, session) = open(place.path());
        let (documents, id) = (&server.documents, session.id().to_owned());
        let root = session.machine().1.root.id.clone();
        let edit = format!(r#"{{"edit":"set_name","path":"{root}","name":"Given up"}}"#);
        let edit = format!(r#"{{"id":"1","name":"Rename","edit":{edit}}}"#);
        let edit: EditMachine = serde_json::from_str(&edit).unwrap();
        let request = EditRequest { author: "ann".to_owned(), id: edit.id.clone() };
        documents.change(&server, &id, request, Operation::edit(edit)).unwrap();
        documents.close(&server, &id, &CloseMachine { discard: true }).unwrap();
        let saving = Saving { to: None, overwrite: false };
        let failure = session.save(&saving, &documents.tools(&server)).unwrap_err();
        assert_eq!(failure.code(), "no_such_machine");
        let core = fs::read_to_string(place.path().join("project/one/core_data.json")).unwrap();
        assert!(core.contains("Mission"), "{core}");
    }

    /// The machine ignores the broken file, so its content does not change, and a save leaves the file untouched.
    #[test]
    fn a_fault_that_another_program_brought_in_is_known_after_a_save() {
        let place = tempfile::tempdir().unwrap();
        let (server, session) = open(place.path());
        let before = session.problems(&server).unwrap().len();
        fs::write(place.path().join("project/one").join("meta_data.json"), "{").unwrap();
        session
            .save(&Saving { to: None, overwrite: false }, &server.documents.tools(&server))
            .unwrap();
        assert_eq!(session.problems(&server).unwrap().len(), before + 1);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        /// A save records its content without reading it back: the record must match the next check.
        #[test]
        fn what_a_save_wrote_is_what_lies_there(numbers in vec(any::<u16>(), 0..120)) {
            let place = tempfile::tempdir().unwrap();
            let (server, session) = open(place.path());
            let tools = server.documents.tools(&server);
            let (mut dice, mut number) = (Dice::new(numbers), 0);
            while !dice.is_empty() {
                number += 1;
                let request = EditRequest { author: "ann".to_owned(), id: number.to_string() };
                let edit = Edit::of(&edit(&session.machine().1, &mut dice));
                let name = "Any".to_owned();
                let operation = edit.map(|edit| Operation::Edit { name, edit: Box::new(edit) });
                if let Some(operation) = operation {
                    drop(server.documents.change(&server, session.id(), request, operation));
                }
                session.save(&Saving { to: None, overwrite: false }, &tools).unwrap();
                session.look(&tools.libraries).unwrap();
                prop_assert_eq!(session.summary().unwrap().disk, DiskState::Same);
            }
        }
    }
}
