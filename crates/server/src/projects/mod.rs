//! Projects: the folders that the server was started with, and the only places below which requests read and write.
//! Knows their names, and which folder a request means. Does not know what is inside a machine.

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

/// So many look through everything at a time.
const SEARCHES: usize = 2;

/// The projects, in the order in which they were given.
#[derive(Debug, Default)]
pub(crate) struct Projects {
    known: Vec<Project>,
    shelf: LibraryCache,
    looks: Gate,
    searches: Gate,
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

    /// The libraries that machines are loaded with now. Whoever keeps them reads no later changes.
    pub(crate) fn libraries(&self) -> Arc<Libraries> {
        self.shelf.libraries()
    }

    /// The libraries as clients see them.
    pub(crate) fn shelf(&self) -> &LibraryCache {
        &self.shelf
    }

    /// Before folders and libraries are read.
    pub(crate) fn looks(&self) -> &Gate {
        &self.looks
    }

    /// Before everything is looked through: who asks for one folder or library does not wait for that.
    pub(crate) fn searches(&self) -> &Gate {
        &self.searches
    }

    /// All of them.
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

    /// The folder that a request means, with every link followed: inside its project, whether it exists or not.
    pub(crate) fn resolve(&self, file: &MachineFile) -> Result<PathBuf, Failure> {
        let project = self.named(&file.project)?;
        confine::below(Path::new(&project.folder), &file.path)
    }

    /// The folder of the machine that a request means, by its folder or by a file in it.
    pub(crate) fn machine(&self, file: &MachineFile) -> Result<PathBuf, Failure> {
        let project = self.named(&file.project)?;
        confine::machine(Path::new(&project.folder), &file.path)
    }

    /// The one name of a folder that a request of this project means.
    pub(crate) fn canonical(&self, file: &MachineFile, folder: &Path) -> MachineFile {
        let home = self.named(&file.project).map(|project| at_home(Path::new(&project.folder)));
        let path =
            home.ok().and_then(|home| folder.strip_prefix(home).ok()?.to_str().map(str::to_owned));
        MachineFile {
            project: file.project.clone(),
            path: path.unwrap_or_else(|| file.path.clone()),
        }
    }

    /// Where machines and libraries lie: the folders of projects, then those of library roots.
    pub(crate) fn folders(&self) -> Vec<PathBuf> {
        let projects = self.known.iter().map(|project| PathBuf::from(&project.folder));
        projects.chain(self.shelf.folders()).collect()
    }

    /// Folders from which machines are read: [`Self::folders`], sources and builds of installed workspaces.
    pub(crate) fn readable(&self) -> Vec<PathBuf> {
        let projects = self.known.iter().map(|project| Path::new(&project.folder));
        self.folders().into_iter().chain(projects.flat_map(workspace::sources)).collect()
    }

    /// The project in which a folder lies, with every link followed.
    pub(crate) fn home_of(&self, folder: &Path) -> Option<PathBuf> {
        let folder = at_home(folder);
        let homes = self.known.iter().map(|project| at_home(Path::new(&project.folder)));
        homes.filter(|home| folder.starts_with(home)).max_by_key(|home| home.as_os_str().len())
    }

    /// How requests name a folder; nothing if it lies in no project.
    pub(crate) fn file_of(&self, folder: &Path) -> Option<MachineFile> {
        let folder = at_home(folder);
        let inside = |project: &Project| {
            let inside = folder.strip_prefix(&project.folder).ok()?.to_str()?;
            Some(MachineFile { project: project.id.clone(), path: inside.to_owned() })
        };
        self.known.iter().filter_map(inside).min_by_key(|file| file.path.len())
    }
}

/// Where a folder really is, if it is there.
fn at_home(folder: &Path) -> PathBuf {
    folder.canonicalize().unwrap_or_else(|_| folder.to_owned())
}
