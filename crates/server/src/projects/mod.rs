//! Projects: the folders that the server was started with. Requests read and write only below them.
//! Knows their names and resolves requests to folders. Does not know the content of machines.

mod confine;
mod library;
mod library_documents;
mod names;
mod routes;
mod tree;
mod usages;
mod workspace;

pub(crate) use routes::routes;
pub(crate) use tree::{is_foreign, is_machine};
pub(crate) use usages::Search;

use crate::gate::Gate;
use crate::{Failure, Settings};
use library::LibraryCache;
use rafcon_protocol::api::{MachineFile, Project};
use rafcon_storage::Libraries;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Maximum number of parallel searches through all folders.
const SEARCHES: usize = 2;

/// The projects, in the order of the settings.
#[derive(Debug, Default)]
pub(crate) struct Projects {
    known: Vec<Project>,
    shelf: LibraryCache,
    looks: Gate,
    searches: Gate,
}

/// The ids of the projects of a server with these folders, each with its folder without links.
pub fn project_ids(folders: &[PathBuf]) -> Vec<(String, PathBuf)> {
    let folders: Vec<_> = folders.iter().map(|folder| at_home(folder)).collect();
    let ids = names::named(folders.iter().cloned()).into_iter().map(|project| project.id);
    ids.zip(folders).collect()
}

impl Projects {
    /// The projects of these settings.
    pub(crate) fn new(settings: &Settings) -> Self {
        let folders: Vec<_> = settings.projects.iter().map(|folder| at_home(folder)).collect();
        let known = names::named(folders.iter().cloned());
        Self {
            known,
            shelf: LibraryCache::open(settings, folders),
            looks: Gate::default(),
            searches: Gate::of(SEARCHES),
        }
    }

    /// Libraries for loading machines. The returned snapshot does not include later changes.
    pub(crate) fn libraries(&self) -> Arc<Libraries> {
        self.shelf.libraries()
    }

    /// The libraries for clients.
    pub(crate) fn shelf(&self) -> &LibraryCache {
        &self.shelf
    }

    /// Limits parallel reads of folders and libraries.
    pub(crate) fn looks(&self) -> &Gate {
        &self.looks
    }

    /// Limits parallel searches through all folders. Other reads do not wait for them.
    pub(crate) fn searches(&self) -> &Gate {
        &self.searches
    }

    /// All projects of the server.
    pub(crate) fn all(&self) -> &[Project] {
        &self.known
    }

    /// The project with this id.
    pub(crate) fn named(&self, id: &str) -> Result<&Project, Failure> {
        let found = self.known.iter().find(|project| project.id == id);
        found.ok_or_else(|| {
            let message = format!("there is no project `{id}`: /api/v1/projects lists them");
            Failure::not_found("no_such_project", message)
        })
    }

    /// The folder that a request names, with links resolved. It is inside its project, but need not exist.
    pub(crate) fn resolve(&self, file: &MachineFile) -> Result<PathBuf, Failure> {
        let project = self.named(&file.project)?;
        confine::below(Path::new(&project.folder), &file.path)
    }

    /// The folder of the machine that a request names, either by its folder or by a file in it.
    pub(crate) fn machine(&self, file: &MachineFile) -> Result<PathBuf, Failure> {
        let project = self.named(&file.project)?;
        confine::machine(Path::new(&project.folder), &file.path)
    }

    /// The unique name of a folder that a request of this project names.
    pub(crate) fn canonical(&self, file: &MachineFile, folder: &Path) -> MachineFile {
        let home = self.named(&file.project).map(|project| at_home(Path::new(&project.folder)));
        let path =
            home.ok().and_then(|home| folder.strip_prefix(home).ok()?.to_str().map(str::to_owned));
        MachineFile {
            project: file.project.clone(),
            path: path.unwrap_or_else(|| file.path.clone()),
        }
    }

    /// Folders with machines and libraries: those of the projects, then those of the library roots.
    pub(crate) fn folders(&self) -> Vec<PathBuf> {
        let projects = self.known.iter().map(|project| PathBuf::from(&project.folder));
        projects.chain(self.shelf.folders()).collect()
    }

    /// Folders from which machines may be read: [`Self::folders`], and the sources and builds of installed workspaces.
    pub(crate) fn readable(&self) -> Vec<PathBuf> {
        let projects = self.known.iter().map(|project| Path::new(&project.folder));
        self.folders().into_iter().chain(projects.flat_map(workspace::sources)).collect()
    }

    /// The project that contains a folder, with links resolved.
    pub(crate) fn home_of(&self, folder: &Path) -> Option<PathBuf> {
        let folder = at_home(folder);
        let homes = self.known.iter().map(|project| at_home(Path::new(&project.folder)));
        homes.filter(|home| folder.starts_with(home)).max_by_key(|home| home.as_os_str().len())
    }

    /// The name of a folder in requests. `None` if no project contains it.
    pub(crate) fn file_of(&self, folder: &Path) -> Option<MachineFile> {
        let folder = at_home(folder);
        let inside = |project: &Project| {
            let inside = folder.strip_prefix(&project.folder).ok()?.to_str()?;
            Some(MachineFile { project: project.id.clone(), path: inside.to_owned() })
        };
        self.known.iter().filter_map(inside).min_by_key(|file| file.path.len())
    }
}

/// The folder with links resolved, if it exists.
fn at_home(folder: &Path) -> PathBuf {
    folder.canonicalize().unwrap_or_else(|_| folder.to_owned())
}
