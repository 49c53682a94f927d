//! Reads a machine from its folder: finds the folder, reads header and states in every layout of `docs/format.md`, and
//! reports faults as a list of problems. Must never write, except to finish an interrupted save.

mod assemble;
mod bounds;
mod compact;
mod confine;
mod decode;
mod elements;
mod folder;
pub mod libraries;
mod library_content;
mod library_state;
mod packed;
mod queue;
mod script_text;
mod state_files;
mod walk;

pub use decode::state_from_core_data;
pub use library_content::fill_library;
pub use packed::load_packed;

use crate::files::{HEADER, MACHINE_LAYOUT, Part, Saved, YAML_HEADER};
use crate::problem::{Fault, LoadError, LoadProblem, Wrong};
use crate::staging::settle_before_reading;
use assemble::{Assembled, assemble};
use bounds::{Bounds, Unread};
use elements::UnmodelledContent;
use folder::FileReader;
use libraries::{Libraries, Loading};
use library_state::version;
use rafcon_model::{Header, Json, Layout, Machine, StatePath};
use rustix::fd::OwnedFd;
use rustix::io::Errno;
use smol_str::SmolStr;
use state_files::{Node, compact_layout, parse};
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::{fs, io};
use walk::walk;

/// A machine as read from its files, with their faults.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The machine, with or without problems.
    pub machine: Machine,
    /// Faults of its files, by state.
    pub problems: Vec<LoadProblem>,
    /// The machine on disk, for the next save.
    pub saved: Saved,
}

impl LoadError {
    pub(crate) fn io(path: &Path, error: Errno) -> Self {
        Self::Io { path: path.to_owned(), source: error.into() }
    }

    /// An error about `path`, which was not read; the message names it by its path in `folder`.
    pub(crate) fn unread(folder: &Path, path: &Path, why: Unread) -> Self {
        match why {
            Unread::System(error) => Self::io(&folder.join(path), error),
            Unread::Outside(link) => Self::Outside { link: folder.join(link) },
            Unread::Unfit(file) => Self::Unfit { file: folder.join(file) },
        }
    }
}

/// Reads the machine in the folder `path`, or in the folder of the file `path`, with the libraries that it uses.
///
/// Finishes or discards an interrupted save; waits for a running one.
pub fn load(path: &Path, libraries: &Libraries) -> Result<Loaded, LoadError> {
    let dir = machine_folder(path)?;
    let identity = fs::canonicalize(&dir).unwrap_or_else(|_| dir.clone());
    load_folder(&dir, libraries, &Loading::first(identity))
}

/// Reads the machine in the folder `dir`; `loading` lists the machines that are being read around it.
pub(crate) fn load_folder(
    dir: &Path,
    libraries: &Libraries,
    loading: &Loading<'_>,
) -> Result<Loaded, LoadError> {
    let bounds = Bounds(libraries.homes());
    let fd = folder::open(dir).map_err(|error| LoadError::io(dir, error))?;
    if !bounds.holds(&fd) {
        return Err(LoadError::Outside { link: dir.to_owned() });
    }
    settle_before_reading(&fd, dir, || confine::check(dir, bounds))?;
    load_open(fd, dir, libraries, loading)
}

/// Reads the machine in the folder `dir`, without libraries. The caller holds its lock.
pub(crate) fn load_locked(dir: &Path) -> Result<Loaded, LoadError> {
    let fd = folder::open(dir).map_err(|error| LoadError::io(dir, error))?;
    load_open(fd, dir, &Libraries::default(), &Loading::first(dir.to_owned()))
}

fn load_open(
    fd: OwnedFd,
    dir: &Path,
    libraries: &Libraries,
    loading: &Loading<'_>,
) -> Result<Loaded, LoadError> {
    let bounds = Bounds(libraries.homes());
    let mut files = FileReader::new(bounds);
    let mut head = read_header(dir, |file| {
        let bytes = files.read(&fd, OsStr::new(""), file);
        bytes
            .map(|bytes| bytes.map(<[u8]>::to_vec))
            .map_err(|why| LoadError::unread(dir, Path::new(file), why))
    })?;
    let (nodes, elsewhere) = find_root(&fd, dir, &head.root_folder, bounds)?;
    drop(fd);
    if elsewhere {
        head.note_root_elsewhere();
    }
    Ok(loaded(dir, head, assemble(nodes, libraries, loading)))
}

/// Combines header and states into the machine in `dir`.
fn loaded(dir: &Path, head: MachineFileHeader, assembled: Assembled) -> Loaded {
    let Assembled { root, place, problems: more } = assembled;
    let mut problems = head.problems;
    problems.extend(more);
    let machine = Machine { header: head.header, root };
    let saved = Saved {
        dir: dir.to_owned(),
        header: machine.header.clone(),
        root: machine.root.clone(),
        place,
        outdated: head.outdated,
        stale: problems.iter().any(|problem| matches!(problem.fault, Fault::TakenId { .. })),
    };
    Loaded { machine, problems, saved }
}

/// The folder of the machine that `path` names.
pub(crate) fn machine_folder(path: &Path) -> Result<PathBuf, LoadError> {
    let metadata = fs::metadata(path).map_err(|source| match source.kind() {
        io::ErrorKind::NotFound => LoadError::NotFound { path: path.to_owned() },
        _ => LoadError::Io { path: path.to_owned(), source },
    })?;
    if metadata.is_dir() {
        return Ok(path.to_owned());
    }
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    Ok(parent.unwrap_or(Path::new(".")).to_owned())
}

/// The content of `statemachine.json`.
struct MachineFileHeader {
    header: Header,
    root_folder: OsString,
    outdated: bool,
    problems: Vec<LoadProblem>,
}

impl MachineFileHeader {
    /// Adds a note that the root is not in the folder that the header names.
    fn note_root_elsewhere(&mut self) {
        self.outdated = true;
        let folder = self.root_folder.to_string_lossy().into();
        self.problems.push(about_machine(Fault::RootElsewhere(folder)));
    }
}

/// Reads the header of the machine in `dir`; `read` returns its files by name.
fn read_header(
    dir: &Path,
    mut read: impl FnMut(&'static str) -> Result<Option<Vec<u8>>, LoadError>,
) -> Result<MachineFileHeader, LoadError> {
    let mut faults = Vec::new();
    let Some(bytes) = read(HEADER)? else {
        let path = dir.to_owned();
        let is_yaml = read(YAML_HEADER)?.is_some();
        return Err(if is_yaml {
            LoadError::Yaml { path }
        } else {
            LoadError::NotAMachine { path }
        });
    };
    let mut problems = Vec::new();
    let layout = match read(MACHINE_LAYOUT)?.map(|bytes| compact_layout(&bytes, &mut String::new()))
    {
        Some(Ok(layout)) => layout,
        Some(Err(fault)) => {
            problems.push(LoadProblem { file: MACHINE_LAYOUT.into(), ..about_machine(fault) });
            Layout::default()
        }
        None => Layout::default(),
    };
    let head = match parse(&bytes) {
        Ok(document) => MachineFileHeader {
            root_folder: root_folder(&document).unwrap_or_default().as_str().into(),
            outdated: is_outdated(&document),
            header: decode_header(&document, layout, &mut faults),
            problems,
        },
        Err(fault) => {
            faults.push(fault);
            let header = Header { layout, ..Header::default() };
            MachineFileHeader { header, root_folder: OsString::new(), outdated: true, problems }
        }
    };
    let faults = faults.into_iter().map(about_machine);
    Ok(MachineFileHeader { problems: head.problems.into_iter().chain(faults).collect(), ..head })
}

fn about_machine(fault: Fault) -> LoadProblem {
    LoadProblem { state: StatePath::default(), file: HEADER.into(), fault }
}

/// Returns the states below the root, and true if the root is not in the folder that the header names.
fn find_root(
    fd: &OwnedFd,
    dir: &Path,
    folder: &OsStr,
    bounds: Bounds<'_>,
) -> Result<(Vec<Node>, bool), LoadError> {
    let nodes = walk(duplicate(fd, dir)?, dir, folder, bounds)?;
    if !nodes.is_empty() {
        return Ok((nodes, false));
    }
    let entries = folder::folders(fd).map_err(|error| LoadError::io(dir, error))?;
    let mut folders: Vec<_> = entries.into_iter().map(|entry| entry.name).collect();
    folders.push(OsString::new());
    folders.sort();
    for folder in folders {
        let nodes = walk(duplicate(fd, dir)?, dir, &folder, bounds)?;
        if !nodes.is_empty() {
            return Ok((nodes, true));
        }
    }
    Err(LoadError::NoRoot { path: dir.to_owned() })
}

fn duplicate(fd: &OwnedFd, dir: &Path) -> Result<OwnedFd, LoadError> {
    fd.try_clone().map_err(|source| LoadError::Io { path: dir.to_owned(), source })
}

/// The file of a state's part, relative to the machine's folder.
pub(crate) fn file_of(folder: &Path, part: Part) -> PathBuf {
    folder.join(part.file_name())
}

/// The name of a library in messages.
pub(crate) fn library_label(path: &str, name: &str) -> SmolStr {
    if path.is_empty() { name.into() } else { smol_str::format_smolstr!("{path}/{name}") }
}

/// Known keys; all others are kept.
const HEADER_KEYS: [&str; 7] = [
    "creation_time",
    "state_machine_version",
    "version",
    "used_rafcon_version",
    "last_update",
    "root_state_storage_id",
    "root_state_id",
];

/// The folder of the root state, if an older layout gives it one.
fn root_folder(document: &Json) -> Option<SmolStr> {
    let named = document.get("root_state_storage_id").or_else(|| document.get("root_state_id"));
    let folder = named?.as_str()?;
    let is_plain = !folder.is_empty() && folder != "." && folder != ".." && !folder.contains('/');
    is_plain.then(|| folder.into())
}

/// Returns true if the document has a layout that is no longer written.
fn is_outdated(document: &Json) -> bool {
    ["root_state_storage_id", "root_state_id", "version", "last_update"]
        .iter()
        .any(|key| document.get(key).is_some())
}

/// The header that `document` describes.
fn decode_header(document: &Json, layout: Layout, faults: &mut Vec<Fault>) -> Header {
    let Some(members) = document.as_object() else {
        faults.push(Fault::Wrong(Wrong::NotAnObject(document.kind())));
        return Header { layout, ..Header::default() };
    };
    let creation_time = document.get("creation_time").and_then(Json::as_str);
    if creation_time.is_none() {
        faults.push(Fault::Wrong(Wrong::Missing("creation_time")));
    }
    let own_version = document.get("version").or_else(|| document.get("state_machine_version"));
    let writer = document.get("used_rafcon_version").and_then(Json::as_str);
    Header {
        creation_time: creation_time.map(SmolStr::new).unwrap_or_default(),
        version: version(own_version),
        used_rafcon_version: writer.map(SmolStr::new),
        layout,
        extra: UnmodelledContent::default().into_extra(members, |key| HEADER_KEYS.contains(&key)),
    }
}
