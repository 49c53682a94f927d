//! Reads a machine that a run has stored. The result equals a load from its folder, but no file is opened. Converts packed files to
//! the model; must never read the disk.

use super::assemble::assemble;
use super::bounds::Unread;
use super::state_files::{Node, ReadState, StateFiles, StateReader};
use super::walk::MAX_THREADS;
use super::{Loaded, loaded, read_header};
use crate::files::Part;
use crate::journal::Packed;
use crate::journal::pack::packed::Folder;
use crate::libraries::{Libraries, Loading};
use crate::problem::LoadError;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::thread;

/// The path of a state's folder in the pack, the folder's name, and its files.
type PackedState<'p> = (&'p str, &'p OsStr, &'p Folder);

/// The number of states that justifies a second thread.
const WORTH_A_THREAD: usize = 64;

/// Reads the machine in `folder` of a pack, and its libraries from that pack. `dir` is the original folder of its files.
pub fn load_packed(
    packed: &Packed,
    folder: &str,
    dir: &Path,
    libraries: &Libraries,
) -> Result<Loaded, LoadError> {
    load_packed_folder(packed, folder, dir, libraries, &Loading::first(PathBuf::from(folder)))
}

/// Reads the machine within `loading`, the machines that are being read around it.
pub(crate) fn load_packed_folder(
    packed: &Packed,
    folder: &str,
    dir: &Path,
    libraries: &Libraries,
    loading: &Loading<'_>,
) -> Result<Loaded, LoadError> {
    let file = |name| Ok(packed.of_machine(folder, name).map(<[u8]>::to_vec));
    let head = read_header(dir, file)?;
    let states = packed.states(folder).enumerate();
    // The root is in the folder of the machine, which is not named after it.
    let name = |index, path| if index == 0 { OsStr::new("") } else { name(path) };
    let nodes = nodes(
        &states.map(|(index, (path, files))| (path, name(index, path), files)).collect::<Vec<_>>(),
    );
    if nodes.is_empty() {
        return Err(LoadError::NoRoot { path: dir.to_owned() });
    }
    Ok(loaded(dir, head, assemble(nodes, libraries, loading)))
}

/// The states in these folders; the first is the root's.
fn nodes(folders: &[PackedState<'_>]) -> Vec<Node> {
    let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
    let mut nodes: Vec<Node> = Vec::new();
    for (index, ((path, name, _), state)) in folders.iter().zip(states(folders)).enumerate() {
        let Some(state) = state else { continue };
        let around = path.rsplit_once('/').map(|(around, _)| around);
        let parent = around.and_then(|around| numbers.get(around).copied());
        let is_inside = parent.is_some_and(|number| nodes[number].state.container().is_some());
        if index == 0 || is_inside {
            numbers.insert(path, nodes.len());
            let number = nodes.len();
            nodes.push(state.node(number, parent, name.to_os_string(), false));
        }
    }
    nodes
}

fn name(path: &str) -> &OsStr {
    OsStr::new(path.rsplit('/').next().unwrap_or_default())
}

/// The states of these folders, in their order; `None` for a folder without a state.
fn states(folders: &[PackedState<'_>]) -> Vec<Option<ReadState>> {
    let threads = thread::available_parallelism().map_or(1, usize::from).min(MAX_THREADS);
    let threads = threads.min(folders.len() / WORTH_A_THREAD + 1);
    let share = folders.len().div_ceil(threads).max(1);
    thread::scope(|scope| {
        let (first, rest) = folders.split_at(share.min(folders.len()));
        let helpers: Vec<_> = rest.chunks(share).map(|share| scope.spawn(|| read(share))).collect();
        let mut states = read(first);
        for helper in helpers {
            match helper.join() {
                Ok(more) => states.extend(more),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        states
    })
}

fn read(folders: &[PackedState<'_>]) -> Vec<Option<ReadState>> {
    let mut reader = StateReader::default();
    // Reading memory cannot fail.
    let read = |(_, name, files): &PackedState<'_>| reader.read(name, &mut &**files).ok()?;
    folders.iter().map(read).collect()
}

impl StateFiles for &Folder {
    fn read(&mut self, part: Part) -> Result<Option<&[u8]>, Unread> {
        Ok(self.part(part))
    }
}
