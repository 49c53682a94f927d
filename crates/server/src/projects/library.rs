//! Libraries for clients, each loaded once until a file changes. Knows the roots and the libraries below them.

use super::library_documents::LibraryDocuments;
use super::{confine, workspace};
use crate::document_text::document_text;
use crate::failure::reason;
use crate::{Failure, Settings};
use axum::body::Bytes;
use rafcon_locks::{Mutex, RwLock};
use rafcon_protocol::api::{LibraryNode, LibraryNodeKind, LibraryRoot};
use rafcon_storage::config::{self, Config};
use rafcon_storage::libraries::{EntryKind, LibraryEntry};
use rafcon_storage::{Libraries, LoadError, Root, load, roots};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Libraries loaded since the last change of their files.
#[derive(Debug, Default)]
struct LoadedLibraries {
    libraries: Arc<Libraries>,
    documents: Mutex<LibraryDocuments>,
}

/// A library as it is sent to clients.
#[derive(Debug, Clone)]
pub(super) struct Content {
    /// A [`rafcon_protocol::document::Document`] as JSON.
    pub(super) document: Bytes,
    /// An `ETag` that changes with the document.
    pub(super) tag: String,
}

/// The libraries of the server, reloaded after changes.
#[derive(Debug, Default)]
pub(crate) struct LibraryCache {
    /// The folders of projects.
    projects: Vec<PathBuf>,
    stock: RwLock<Arc<LoadedLibraries>>,
}

impl LibraryCache {
    /// The libraries of these settings, for machines in these folders.
    pub(super) fn open(settings: &Settings, projects: Vec<PathBuf>) -> Self {
        let stock = LoadedLibraries::new(library_roots(settings), &projects);
        Self { projects, stock: RwLock::new(Arc::new(stock)) }
    }

    /// Libraries for loading machines. The returned snapshot does not include later changes.
    pub(crate) fn libraries(&self) -> Arc<Libraries> {
        Arc::clone(&self.stock().libraries)
    }

    /// Folders of the roots, with links resolved.
    pub(crate) fn folders(&self) -> Vec<PathBuf> {
        let libraries = self.libraries();
        libraries.roots().iter().map(|root| super::at_home(&root.dir)).collect()
    }

    /// Drops everything loaded, after files of libraries changed. Running reads keep their snapshot.
    pub(crate) fn refresh(&self) {
        let roots = self.stock().libraries.roots().to_vec();
        *self.stock.write() = Arc::new(LoadedLibraries::new(roots, &self.projects));
    }

    /// The roots with the current content below them.
    pub(super) fn roots(&self) -> Vec<LibraryRoot> {
        self.libraries().tree().into_iter().map(root_of).collect()
    }

    /// The library at `path` below the root named `root`.
    pub(super) fn document(&self, root: &str, path: &str) -> Result<Content, Failure> {
        self.stock().document(&format!("{root}/{path}"))
    }

    fn stock(&self) -> Arc<LoadedLibraries> {
        Arc::clone(&self.stock.read())
    }
}

impl LoadedLibraries {
    /// Libraries are loaded only from the projects, from below the roots, and from workspaces that are installed in a project.
    fn new(roots: Vec<Root>, projects: &[PathBuf]) -> Self {
        let homes = roots.iter().map(|root| super::at_home(&root.dir));
        let sources = projects.iter().flat_map(|project| workspace::sources(project));
        let homes = homes.chain(projects.iter().cloned()).chain(sources).collect();
        let libraries = Arc::new(Libraries::new(roots).within(homes));
        Self { libraries, documents: Mutex::default() }
    }

    fn document(&self, path: &str) -> Result<Content, Failure> {
        let folder = self.folder(path)?;
        if let Some(document) = self.documents.lock().get(&folder) {
            return Ok(document);
        }
        let loaded = load(&folder, &self.libraries).map_err(|error| unloaded(path, &error))?;
        let text = document_text(&loaded.machine);
        let text = text.map_err(|error| unreadable(path, &error))?;
        let tag = format!("\"{}\"", &blake3::hash(&text).to_hex()[..32]);
        let content = Content { document: text.into(), tag };
        self.documents.lock().insert(folder, content.clone());
        Ok(content)
    }

    /// A root's name may have several parts. The longest match counts.
    fn folder(&self, path: &str) -> Result<PathBuf, Failure> {
        let inside = |root: &Root| {
            let inside = path.strip_prefix(root.name.as_str())?.strip_prefix('/')?;
            Some((root.name.len(), root.dir.clone(), inside.to_owned()))
        };
        let found = self.libraries.roots().iter().filter_map(inside).max_by_key(|found| found.0);
        let Some((_, dir, inside)) = found else {
            let message = format!(
                "`{path}` lies below no library root: choose one from the list of libraries"
            );
            return Err(Failure::not_found("no_such_library", message));
        };
        confine::machine(&dir, &inside)
    }
}

fn unloaded(path: &str, error: &LoadError) -> Failure {
    match error {
        LoadError::NotFound { .. } => {
            let message =
                format!("there is no library {path}: choose one from the list of libraries");
            Failure::not_found("no_such_library", message)
        }
        LoadError::Outside { .. } => {
            let message = format!("the library {path} cannot be read: {error}");
            Failure::forbidden("outside_project", message)
        }
        LoadError::Unfit { .. }
        | LoadError::NotAMachine { .. }
        | LoadError::Yaml { .. }
        | LoadError::NoRoot { .. }
        | LoadError::Io { .. }
        | LoadError::Recovery { .. } => unreadable(path, error),
    }
}

fn unreadable(path: &str, error: &dyn std::error::Error) -> Failure {
    let message = format!("the library {path} cannot be read: {}", reason(error));
    Failure::unprocessable("unreadable_library", message)
}

fn root_of(entry: LibraryEntry) -> LibraryRoot {
    let folder = shown(&entry.dir);
    let node = node_of(entry);
    LibraryRoot { name: node.name, folder, children: node.children }
}

fn node_of(entry: LibraryEntry) -> LibraryNode {
    let (kind, children) = match entry.kind {
        EntryKind::Folder(inside) => {
            (LibraryNodeKind::Folder, inside.into_iter().map(node_of).collect())
        }
        EntryKind::Library => (LibraryNodeKind::Library, Vec::new()),
    };
    LibraryNode { name: entry.name.to_string(), kind, children }
}

fn shown(folder: &Path) -> String {
    folder.to_string_lossy().into_owned()
}

/// The roots of these settings. Reports faults in the configuration, and uses the rest.
fn library_roots(settings: &Settings) -> Vec<Root> {
    let config = match config::find(settings.config.as_deref(), &settings.variable) {
        Ok((config, _file)) => config,
        Err(error) => {
            (settings.tell)(&format!(
                "{error}: {}; library roots of it do not count",
                error.source
            ));
            Config::default()
        }
    };
    let (roots, notes) = roots(&config, &settings.variable, &settings.libraries);
    for note in notes {
        (settings.tell)(&note.to_string());
    }
    roots
}
