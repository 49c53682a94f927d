//! Other versions of an open machine, for comparison: the saved one, and those in git. Knows folders and how to load a machine
//! from one, but not the client.

mod git;
mod routes;

pub(super) use routes::routes;

use super::disk;
use crate::{Failure, ServerState, log};
use git::{CommittedFile, GitFolder};
use rafcon_protocol::api::MachineVersions;
use rafcon_protocol::document::Document;
use rafcon_storage::files::{HEADER, MACHINE_LAYOUT, Part};
use rafcon_storage::{Libraries, fill_library, load, remedy};
use std::path::{Path, PathBuf};
use std::{fs, io};
use tempfile::TempDir;
use tokio::runtime::Handle;

/// The machine on disk: a [`Document`] as JSON.
fn saved(server: &ServerState, id: &str) -> Result<Vec<u8>, Failure> {
    let folder = server.documents.session(id)?.folder();
    let on_disk = disk::read(&folder, &server.projects.libraries())?;
    let on_disk = on_disk.ok_or_else(|| super::session::vanished(&folder))?;
    Ok(on_disk.document)
}

/// Commits that changed the machine's folder.
async fn versions(server: &ServerState, id: &str) -> Result<MachineVersions, Failure> {
    let path = server.documents.session(id)?.folder();
    let Some(project) = server.projects.home_of(&path).filter(|_| path.is_dir()) else {
        return Ok(MachineVersions::default());
    };
    let programs = (server.settings.variable)("PATH");
    GitFolder { path: &path, project: &project, programs: programs.as_deref() }.versions().await
}

/// The machine at a commit: a [`Document`] as JSON. Call it on a blocking thread.
fn version(server: &ServerState, id: &str, commit: &str) -> Result<Vec<u8>, Failure> {
    let path = server.documents.session(id)?.folder();
    let project = server.projects.home_of(&path).unwrap_or_else(|| path.clone());
    let programs = (server.settings.variable)("PATH");
    let folder = GitFolder { path: &path, project: &project, programs: programs.as_deref() };
    let (files, contents) = Handle::current().block_on(async {
        let mut files = folder.files(commit).await?;
        files.retain(|file| is_of_machine(&file.path));
        let contents = folder.contents(&files).await?;
        Ok::<_, Failure>((files, contents))
    })?;
    let all = place(&server.settings.state);
    let place = put(&all, &files, &contents).map_err(|error| no_room(&error))?;
    document(place.path(), commit, &server.projects.libraries())
}

/// True if machines are loaded from files of this name.
fn is_of_machine(path: &str) -> bool {
    let name = path.rsplit('/').next().unwrap_or(path);
    name == HEADER
        || name == MACHINE_LAYOUT
        || Part::ALL.iter().any(|part| name == part.file_name())
}

/// Folder in which versions are unpacked temporarily.
fn place(state: &Path) -> PathBuf {
    state.join("versions")
}

/// Removes the files of a server that was killed while it read a version.
pub(super) fn sweep(state: &Path) {
    match fs::remove_dir_all(place(state)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            log::say(&format!("{} cannot be removed: {error}", place(state).display()));
        }
        _ => {}
    }
}

/// Writes the files to a temporary folder.
fn put(all: &Path, files: &[CommittedFile], contents: &[Vec<u8>]) -> io::Result<TempDir> {
    fs::create_dir_all(all)?;
    let place = tempfile::tempdir_in(all)?;
    for (file, content) in files.iter().zip(contents) {
        let path = place.path().join(&file.path);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::write(path, content)?;
    }
    Ok(place)
}

/// The machine in a temporary folder, with current libraries.
fn document(folder: &Path, commit: &str, libraries: &Libraries) -> Result<Vec<u8>, Failure> {
    let unread = |why: String| {
        let message = format!("the machine as of {commit} cannot be read: {why}");
        Failure::unprocessable("unreadable_version", message)
    };
    let loaded = load(folder, &Libraries::default());
    let loaded = loaded.map_err(|error| {
        unread(error.to_string().replace(&*folder.to_string_lossy(), "its folder"))
    })?;
    let mut look_up = |state: &mut _| drop(fill_library(state, libraries));
    let machine = Document::of(&loaded.machine).read(&mut look_up);
    Ok(disk::content(&machine.map_err(|error| unread(error.to_string()))?)?.1)
}

fn no_room(error: &io::Error) -> Failure {
    let message =
        format!("the version cannot be put into the server's folder: {error}; {}", remedy(error));
    Failure::unavailable("no_room", message)
}
