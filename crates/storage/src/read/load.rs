//! From a path to a machine: finds the folder, reads header and states, and reports. Knows the order of things; each
//! thing itself is done elsewhere.

use super::assemble::{Assembled, assemble};
use super::bounds::{Bounds, Unread};
use super::confine;
use super::folder::{self, FileReader};
use super::header;
use super::state_files::{Node, compact_layout, parse};
use super::walk::walk;
use crate::files::{HEADER, MACHINE_LAYOUT, Part, YAML_HEADER};
use crate::libraries::{Libraries, Loading};
use crate::place::Saved;
use crate::problem::{Fault, LoadProblem};
use crate::write::settle_before_reading;
use rafcon_model::{Header, Layout, Machine, StatePath};
use rustix::fd::OwnedFd;
use rustix::io::Errno;
use smol_str::SmolStr;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// A machine as it was read.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The machine, whatever its problems are.
    pub machine: Machine,
    /// Faults of its files, by state.
    pub problems: Vec<LoadProblem>,
    /// What is on disk, for the next save.
    pub saved: Saved,
}

/// Why nothing could be read.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// Nothing is at the path.
    #[error("{} does not exist; give the folder of a state machine or a file in it", path.display())]
    NotFound {
        /// What was asked for.
        path: PathBuf,
    },
    /// There is no header.
    #[error("{} is not a state machine: it has no statemachine.json", path.display())]
    NotAMachine {
        /// The folder.
        path: PathBuf,
    },
    /// The machine is older than any layout that can be read.
    #[error(
        "{} has only a statemachine.yaml; save it with a RAFCON before 1.0, which writes statemachine.json",
        path.display()
    )]
    Yaml {
        /// The folder.
        path: PathBuf,
    },
    /// There is a header, and no state at all.
    #[error("{} has no root state: a folder with core_data.json is missing", path.display())]
    NoRoot {
        /// The folder.
        path: PathBuf,
    },
    /// The disk does not give what it has.
    #[error("cannot read {}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Whoever loads for others reads in some folders only.
    #[error(
        "{} leads out of the folders that may be read; put there what it leads to, or give the folder in which that lies",
        link.display()
    )]
    Outside {
        /// The link.
        link: PathBuf,
    },
    /// Whoever loads for others reads no such file.
    #[error("{} is not a regular file of at most 64 MiB; put one there", file.display())]
    Unfit {
        /// The file.
        file: PathBuf,
    },
    /// A save was interrupted and cannot be finished.
    #[error("cannot finish the interrupted save in {}", path.display())]
    Recovery {
        /// The machine's folder.
        path: PathBuf,
        /// What stood in the way.
        source: io::Error,
    },
}

impl LoadError {
    pub(crate) fn io(path: &Path, error: Errno) -> Self {
        Self::Io { path: path.to_owned(), source: error.into() }
    }

    /// Something at `path` was not read; what lies elsewhere is named by its path in `folder`.
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
/// Finishes or drops a save that was interrupted; waits for one that runs.
pub fn load(path: &Path, libraries: &Libraries) -> Result<Loaded, LoadError> {
    let dir = machine_folder(path)?;
    let identity = fs::canonicalize(&dir).unwrap_or_else(|_| dir.clone());
    load_folder(&dir, libraries, &Loading::first(identity))
}

/// Reads the machine in the folder `dir`; `loading` says which machines are being read around it.
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

/// Reads the machine in the folder `dir`, without libraries, for one who holds its lock.
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

/// Header and states as one machine, whose files lie in `dir`.
pub(super) fn loaded(dir: &Path, head: MachineFileHeader, assembled: Assembled) -> Loaded {
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

/// What `statemachine.json` says.
pub(super) struct MachineFileHeader {
    header: Header,
    root_folder: OsString,
    outdated: bool,
    problems: Vec<LoadProblem>,
}

impl MachineFileHeader {
    /// The root is not where the header says.
    fn note_root_elsewhere(&mut self) {
        self.outdated = true;
        let folder = self.root_folder.to_string_lossy().into();
        self.problems.push(about_machine(Fault::RootElsewhere(folder)));
    }
}

/// Reads the header of the machine in `dir`; `read` gives its files by name.
pub(super) fn read_header(
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
            root_folder: header::root_folder(&document).unwrap_or_default().as_str().into(),
            outdated: header::is_outdated(&document),
            header: header::decode(&document, layout, &mut faults),
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

/// The states below the root, and whether the root was not where the header says.
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

/// The name of a library as messages show it.
pub(crate) fn library_label(path: &str, name: &str) -> SmolStr {
    if path.is_empty() { name.into() } else { smol_str::format_smolstr!("{path}/{name}") }
}
