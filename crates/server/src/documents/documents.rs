//! All open machines, by folder and name. Knows machine sessions. Their file operations must run on blocking threads.

use super::disk;
use super::operation::{EditRequest, Operation, RecordedOperation};
use super::recover::recover;
use super::save::unless_in_a_machine;
use super::session::{FileLocation, MachineSession, Tools, closed};
use crate::extract::check_request_id;
use crate::gate::Gate;
use crate::{Failure, ServerState, Settings};
use rafcon_locks::{Condvar, Mutex};
use rafcon_model::{Fresh, Machine, StatePath};
use rafcon_protocol::api::{
    CloseMachine, CopyStates, MachineFile, MachineSummary, NewMachine, Presence,
};
use rafcon_protocol::calendar::Date;
use rafcon_protocol::document::Selection;
use rafcon_storage::config::{self, Naming};
use rafcon_supervisor::clock::{salt, since_1970_ms};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Maximum number of open machines.
const OPEN_MAX: usize = 64;
/// Maximum number of parallel git queries.
const GITS: usize = 2;
/// Maximum length of an edit's name, in characters.
const NAME_MAX: usize = 200;

/// The open machines of a server.
#[derive(Debug)]
pub(crate) struct Documents {
    /// The folder with all drafts.
    drafts: PathBuf,
    naming: Naming,
    /// Limits parallel loads of machines.
    pub(super) loads: Gate,
    /// Limits parallel saves and reloads.
    pub(super) saves: Gate,
    /// Limits parallel computations on open machines.
    pub(super) looks: Gate,
    /// Limits parallel git queries. They may take long, and opening a machine must not wait for them.
    pub(super) versions: Gate,
    sessions: Mutex<BTreeMap<String, Arc<MachineSession>>>,
    /// Folders that are being opened, closed or moved to.
    claimed: Mutex<BTreeSet<PathBuf>>,
    released: Condvar,
}

/// Exclusive claim on a folder, released on drop.
#[derive(Debug)]
pub(super) struct FolderClaim<'d> {
    documents: &'d Documents,
    folder: PathBuf,
}

impl Documents {
    /// The documents of a server that has just started: none are open.
    pub(crate) fn new(settings: &Settings) -> Self {
        super::versions::sweep(&settings.state);
        let found = config::find(settings.config.as_deref(), &settings.variable);
        Self {
            drafts: settings.state.join("drafts"),
            naming: found.map(|(config, _file)| config.naming).unwrap_or_default(),
            loads: Gate::default(),
            saves: Gate::default(),
            looks: Gate::default(),
            versions: Gate::of(GITS),
            sessions: Mutex::default(),
            claimed: Mutex::default(),
            released: Condvar::new(),
        }
    }

    /// Summaries of all open machines.
    pub(crate) fn summaries(&self) -> Vec<MachineSummary> {
        self.sessions.lock().values().filter_map(|session| session.summary().ok()).collect()
    }

    /// Sessions of all open machines.
    pub(super) fn all(&self) -> Vec<Arc<MachineSession>> {
        self.sessions.lock().values().cloned().collect()
    }

    /// The folders of open machines.
    pub(crate) fn folders(&self) -> Vec<PathBuf> {
        self.sessions.lock().values().map(|session| session.folder()).collect()
    }

    /// The session with this id.
    pub(crate) fn session(&self, id: &str) -> Result<Arc<MachineSession>, Failure> {
        self.sessions.lock().get(id).cloned().ok_or_else(|| closed(id))
    }

    /// The current content of an open machine.
    pub(crate) fn machine_of(&self, id: &str) -> Result<Machine, Failure> {
        Ok(self.session(id)?.machine().1)
    }

    pub(super) fn room_of(&self, folder: &Path) -> Option<Arc<MachineSession>> {
        self.sessions.lock().values().find(|session| session.folder() == folder).cloned()
    }

    /// Waits until the folder is unclaimed, and claims it.
    pub(super) fn claim(&self, folder: &Path) -> FolderClaim<'_> {
        let mut claimed = self.claimed.lock();
        while !claimed.insert(folder.to_owned()) {
            self.released.wait(&mut claimed);
        }
        FolderClaim { documents: self, folder: folder.to_owned() }
    }

    /// Claims the folder. `None` if it is already claimed.
    fn try_claim(&self, folder: &Path) -> Option<FolderClaim<'_>> {
        let is_free = self.claimed.lock().insert(folder.to_owned());
        is_free.then(|| FolderClaim { documents: self, folder: folder.to_owned() })
    }

    /// Location of the machine that a request names.
    pub(super) fn requested_location(
        &self,
        server: &ServerState,
        file: &MachineFile,
    ) -> Result<FileLocation, Failure> {
        Ok(self.location(server, file, server.projects.resolve(file)?))
    }

    fn location(&self, server: &ServerState, file: &MachineFile, folder: PathBuf) -> FileLocation {
        let draft = self.draft_of(&folder);
        FileLocation { file: server.projects.canonical(file, &folder), folder, draft }
    }

    fn draft_of(&self, folder: &Path) -> PathBuf {
        self.drafts.join(name_of(folder))
    }

    pub(super) fn tools(&self, server: &ServerState) -> Tools {
        Tools { libraries: server.projects.libraries(), naming: self.naming }
    }

    /// Opens the machine in a folder, once for all clients. Includes acknowledged edits of a server that crashed. Edits that no
    /// longer fit are set aside, but only for a user who may edit.
    pub(crate) fn open(
        &self,
        server: &ServerState,
        file: &MachineFile,
        may_edit: bool,
    ) -> Result<MachineSummary, Failure> {
        let location = self.location(server, file, server.projects.machine(file)?);
        let _claim = self.claim(&location.folder);
        if let Some(session) = self.room_of(&location.folder) {
            return session.summary();
        }
        self.make_room()?;
        let libraries = server.projects.libraries();
        let on_disk = disk::read(&location.folder, &libraries)?.ok_or_else(|| not_there(file))?;
        let recovered = recover(&location, &on_disk, first_revision(), &libraries, may_edit)?;
        let mut sessions = self.sessions.lock();
        let id = free_name(&name_of(&location.folder), |id| sessions.contains_key(id));
        let session = Arc::new(MachineSession::new(
            id.clone(),
            location,
            on_disk,
            recovered,
            since_1970_ms(),
        ));
        sessions.insert(id, Arc::clone(&session));
        drop(sessions);
        server.news.machines();
        session.summary()
    }

    /// At the limit of open machines, closes the oldest one that is saved and has no followers.
    fn make_room(&self) -> Result<(), Failure> {
        let mut sessions: Vec<_> = self.sessions.lock().values().cloned().collect();
        if sessions.len() < OPEN_MAX {
            return Ok(());
        }
        sessions.sort_by_key(|session| session.opened());
        for session in sessions {
            let claim = self.try_claim(&session.folder());
            if claim.is_some() && session.retire() {
                self.sessions.lock().remove(session.id());
                return Ok(());
            }
        }
        let message = format!(
            "{OPEN_MAX} machines are open that somebody follows or that are not saved, and that is the most: close one first"
        );
        Err(Failure::too_many("too_many_machines", message))
    }

    /// Makes a machine in a new folder, and opens it.
    pub(crate) fn make(
        &self,
        server: &ServerState,
        new: &NewMachine,
    ) -> Result<MachineSummary, Failure> {
        let location = self.requested_location(server, &new.file)?;
        {
            let _claim = self.claim(&location.folder);
            unless_in_a_machine(server, &location)?;
            if location.folder.exists() {
                let message = format!("{} exists: choose another folder", new.file.path);
                return Err(Failure::conflict("folder_exists", message));
            }
            if new.name.is_empty() || new.name.contains('/') {
                let message = "the name is empty or has a `/` in it: give the machine another one";
                return Err(Failure::bad("bad_name", message));
            }
            let now = since_1970_ms();
            let id = Fresh::new(now << 16 | u64::from(salt(0))).id(|_| false);
            let machine = disk::empty(&new.name, id, &Date::since_1970(now / 1000).to_string());
            disk::write(&machine, &location.folder, None, self.naming)?;
        }
        server.news.files();
        self.open(server, &new.file, true)
    }

    /// Performs an operation on an open machine and returns the new revision.
    pub(crate) fn change(
        &self,
        server: &ServerState,
        machine: &str,
        request: EditRequest,
        operation: Operation,
    ) -> Result<u64, Failure> {
        let session = self.session(machine)?;
        if let Operation::Edit { name, .. } = &operation {
            check_name(name)?;
        }
        let place = self.draft_of(&session.folder());
        let read = operation.read(&server.projects.libraries(), &place)?;
        check_request_id(&request.id)?;
        let record = RecordedOperation { request, at_ms: since_1970_ms(), operation };
        let revision = session.perform(record, read)?;
        server.news.machines();
        Ok(revision)
    }

    /// Reloads the files of an open machine and returns the new revision.
    pub(crate) fn reload(
        &self,
        server: &ServerState,
        id: &str,
        request: EditRequest,
    ) -> Result<u64, Failure> {
        check_request_id(&request.id)?;
        let revision = self.session(id)?.reload(request, &self.tools(server), since_1970_ms())?;
        server.news.machines();
        Ok(revision)
    }

    /// Closes an open machine for everyone.
    pub(crate) fn close(
        &self,
        server: &ServerState,
        id: &str,
        wish: &CloseMachine,
    ) -> Result<(), Failure> {
        let session = self.session(id)?;
        let _claim = self.claim(&session.folder());
        session.close(wish.discard)?;
        self.sessions.lock().remove(id);
        server.news.machines();
        Ok(())
    }

    /// Reacts to possible changes of files in the folder of an open machine.
    pub(crate) fn look(&self, server: &ServerState, folder: &Path) {
        let Some(session) = self.room_of(folder) else { return };
        if let Err(failure) = session.look(&server.projects.libraries()) {
            crate::log::say(&format!(
                "{} cannot be checked for changes: {failure}",
                folder.display()
            ));
        }
        server.news.machines();
    }

    /// Copies states of an open machine for pasting.
    pub(crate) fn copy(&self, id: &str, wish: &CopyStates) -> Result<Selection, Failure> {
        let (_, machine) = self.session(id)?.machine();
        let state = machine.state(&StatePath::parse(&wish.path));
        let state = state.filter(|state| state.container().is_some()).ok_or_else(|| {
            let message =
                format!("{} is no container: name the state around what is copied", wish.path);
            Failure::not_found("no_such_container", message)
        })?;
        let states: Vec<_> = wish.states.iter().map(rafcon_model::StateId::new).collect();
        let variables: Vec<_> =
            wish.scoped_variables.iter().copied().map(rafcon_model::PortId).collect();
        Ok(Selection::of(&rafcon_model::edit::copy(state, &states, &variables)))
    }

    /// Sets the states of an open machine that a connection shows.
    pub(crate) fn looks(
        &self,
        server: &ServerState,
        id: &str,
        presence: Presence,
    ) -> Result<(), Failure> {
        self.session(id)?.looks(presence);
        server.news.machines();
        Ok(())
    }

    /// Removes a connection from the viewers of all machines.
    pub(crate) fn leaves(&self, connection: u64) {
        let sessions: Vec<_> = self.sessions.lock().values().cloned().collect();
        for session in sessions {
            session.leaves(connection);
        }
    }
}

impl Drop for FolderClaim<'_> {
    fn drop(&mut self) {
        self.documents.claimed.lock().remove(&self.folder);
        self.documents.released.notify_all();
    }
}

fn check_name(name: &str) -> Result<(), Failure> {
    if name.chars().count() > NAME_MAX {
        let message = format!("the name of an edit has {NAME_MAX} characters at most: shorten it");
        return Err(Failure::bad("bad_name", message));
    }
    Ok(())
}

/// First revision of a machine that is opened now: above all earlier ones, and small enough to be exact in JavaScript.
fn first_revision() -> u64 {
    since_1970_ms() * 1000
}

/// A name for a folder that is stable across servers.
fn name_of(folder: &Path) -> String {
    let hash = blake3::hash(folder.as_os_str().as_encoded_bytes()).to_hex();
    hash[..16].to_owned()
}

/// Finds an unused name: a machine opened here may since have moved elsewhere.
fn free_name(wanted: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let mut name = wanted.to_owned();
    let mut number = 2_u32;
    while is_taken(&name) {
        name = format!("{wanted}-{number}");
        number += 1;
    }
    name
}

fn not_there(file: &MachineFile) -> Failure {
    let message = format!(
        "there is no machine in `{}` of the project {}: /api/v1/projects/{}/tree lists them",
        file.path, file.project, file.project
    );
    Failure::not_found("no_such_file", message)
}
