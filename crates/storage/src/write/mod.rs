//! Writes the changes of a machine in one atomic step. Compares with the disk, plans the difference and executes the plan. Writes
//! the current layout; older ones are only read.

mod encode;
mod naming;
mod parts;
mod plan;

#[cfg(test)]
mod kill_tests;

pub use encode::core as core_data;
pub(crate) use encode::{header as header_text, machine_layout as layout_text};
pub(crate) use naming::{folder_name, free_name};
pub(crate) use parts::{Old, bytes as file_bytes};

use crate::config::Naming;
use crate::files::{HEADER, MACHINE_LAYOUT, Saved, StateFolder};
use crate::problem::{Fault, LoadError, LoadProblem};
use crate::read::{load_locked, machine_folder};
use crate::staging::{Disk, Plan, RealDisk, commit, exclusive, is_interrupted, recover};
use plan::{Mode, Planner};
use rafcon_model::{Header, Machine, State};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::{fs, io, thread};

/// Reason why a machine was not saved. The disk still has the old machine, at the latest after the next load.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// An operation on the disk failed.
    #[error("cannot save to {}", path.display())]
    Io {
        /// Folder of the machine.
        path: PathBuf,
        /// Error reported by the system.
        source: io::Error,
    },
    /// A file that would be replaced is a link.
    #[error(
        "{} is a link to {}, which a save would replace by a file: save the machine where its files really lie, or in another folder",
        link.display(), to.display()
    )]
    Linked {
        /// File of the machine that is a link.
        link: PathBuf,
        /// Target of the link, outside the machine.
        to: PathBuf,
    },
    /// The folder contains a machine that cannot be read. It is not replaced.
    #[error("cannot replace the machine in {}", path.display())]
    Occupied {
        /// Path of the folder.
        path: PathBuf,
        /// Reason why it cannot be read.
        source: LoadError,
    },
}

/// Writes the parts of `machine` that differ from the machine on disk into the folder `target`.
///
/// `previous` is the machine last loaded from or saved to `target`: then only changed states are examined, and folders keep their
/// names. With the `previous` of another folder, a copy is written. Without it, a machine in `target` is replaced. Foreign files
/// are never touched. A kill at any moment leaves the old or the new machine.
pub fn save(
    machine: &Machine,
    target: &Path,
    previous: Option<&Saved>,
    naming: Naming,
) -> Result<Saved, SaveError> {
    save_on(&RealDisk, machine, target, previous, naming)
}

/// Saves on a given disk.
fn save_on(
    disk: &dyn Disk,
    machine: &Machine,
    target: &Path,
    previous: Option<&Saved>,
    naming: Naming,
) -> Result<Saved, SaveError> {
    let failed = |source| SaveError::Io { path: target.to_owned(), source };
    disk.create_dir(target).map_err(failed)?;
    let _lock = exclusive(target).map_err(failed)?;
    let recovered = is_interrupted(disk, target) && recover(disk, target).map_err(failed)?;
    let known = previous.filter(|previous| !recovered && is_same_folder(&previous.dir, target));
    let occupant = if known.is_none() { occupant(disk, target)? } else { None };
    let old = known.or(occupant.as_ref()).or(previous);
    let here = known.is_some() || occupant.is_some();
    let rewrite = here && old.is_some_and(|old| old.outdated);
    let mode = Mode { naming, rewrite, stale: old.is_some_and(|old| old.stale), here };
    let (plan, place) = plan(disk, machine, target, old, mode).map_err(failed)?;
    unless_linked(target, &plan)?;
    commit(disk, target, &plan).map_err(failed)?;
    Ok(saved(machine, target, place))
}

/// Refuses to replace or remove a link, because other programs read its target, as in an installed workspace.
fn unless_linked(target: &Path, plan: &Plan) -> Result<(), SaveError> {
    let moves = &plan.manifest.moves;
    let replaced = moves.iter().enumerate().map(|(at, (_, to))| before_moves(to, &moves[..at]));
    let removed = plan.manifest.removed.iter().map(|path| before_moves(path, moves));
    for path in replaced.chain(removed) {
        let link = target.join(path);
        if fs::symlink_metadata(&link).is_ok_and(|about| about.is_symlink()) {
            let to = fs::canonicalize(&link).or_else(|_dangling| fs::read_link(&link));
            return Err(SaveError::Linked { to: to.unwrap_or_default(), link });
        }
    }
    Ok(())
}

/// Returns the machine on disk after a save.
fn saved(machine: &Machine, target: &Path, place: StateFolder) -> Saved {
    Saved {
        dir: target.to_owned(),
        header: machine.header.clone(),
        root: Arc::clone(&machine.root),
        place,
        outdated: false,
        stale: false,
    }
}

/// Plans the change of the disk from `old` to `machine`. Also returns the folders afterwards.
fn plan(
    disk: &dyn Disk,
    machine: &Machine,
    target: &Path,
    old: Option<&Saved>,
    mode: Mode,
) -> io::Result<(Plan, StateFolder)> {
    let mut planner = Planner::new(disk, target, mode);
    let before = old.filter(|_| mode.here).map(|old| &old.header);
    machine_files(&mut planner, &machine.header, before)?;
    let old = old.map(Old::of);
    let shared = old.filter(|_| mode.is_lazy()).map(|old| old.state);
    let depth = depth(&machine.root, shared);
    let place = with_room(depth, || planner.root(&machine.root, old))?;
    Ok((planner.plan, place))
}

/// Returns the current location of a file or folder that will be at `path` after these moves.
fn before_moves(path: &Path, moves: &[(PathBuf, PathBuf)]) -> PathBuf {
    moves.iter().rev().fold(path.to_owned(), |path, (from, to)| match path.strip_prefix(to) {
        Ok(rest) if rest.as_os_str().is_empty() => from.clone(),
        Ok(rest) => from.join(rest),
        Err(_elsewhere) => path,
    })
}

fn machine_files(planner: &mut Planner<'_>, new: &Header, old: Option<&Header>) -> io::Result<()> {
    let header = encode::header(new);
    let same = old.is_some_and(|old| encode::header(old) == header);
    planner.machine_file(HEADER, Some(header.into_bytes()), same)?;
    let same = old.map_or(new.layout.text().is_none(), |old| old.layout == new.layout);
    planner.machine_file(MACHINE_LAYOUT, encode::machine_layout(new).map(String::into_bytes), same)
}

/// Returns the machine that is already in the folder.
fn occupant(disk: &dyn Disk, target: &Path) -> Result<Option<Saved>, SaveError> {
    if !disk.exists(&target.join(HEADER)) {
        return Ok(None);
    }
    match load_locked(target) {
        Ok(loaded) => Ok(Some(loaded.saved)),
        Err(LoadError::NoRoot { .. }) => Ok(None),
        Err(source) => Err(SaveError::Occupied { path: target.to_owned(), source }),
    }
}

fn is_same_folder(a: &Path, b: &Path) -> bool {
    a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Result of formatting a machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Formatted {
    /// Files and folders written, moved or removed, relative to the machine's folder.
    pub changed: Vec<PathBuf>,
    /// Problems found. Damaged files are not changed.
    pub problems: Vec<LoadProblem>,
}

/// Reason why a machine was not formatted.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The machine cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The machine cannot be written.
    #[error(transparent)]
    Save(#[from] SaveError),
}

/// Rewrites the machine in the folder `path` (or of the file `path`) in the current layout and dialect. Correct files and foreign
/// files are not touched. With `dry`, only returns the changes.
pub fn format(path: &Path, naming: Naming, dry: bool) -> Result<Formatted, FormatError> {
    let dir = machine_folder(path)?;
    let failed = |source: io::Error| SaveError::Io { path: dir.clone(), source };
    let _lock = exclusive(&dir).map_err(failed)?;
    if is_interrupted(&RealDisk, &dir) {
        recover(&RealDisk, &dir).map_err(failed)?;
    }
    let loaded = load_locked(&dir)?;
    let mode = Mode { naming, rewrite: true, stale: true, here: true };
    let saved = &loaded.saved;
    let (plan, _) = plan(&RealDisk, &loaded.machine, &dir, Some(saved), mode).map_err(failed)?;
    if !dry {
        unless_linked(&dir, &plan)?;
        commit(&RealDisk, &dir, &plan).map_err(failed)?;
    }
    let mut changed = plan.changed;
    changed.sort();
    changed.dedup();
    let mut problems = loaded.problems;
    problems.retain(|problem| !matches!(problem.fault, Fault::MissingLibrary { .. })); // not looked for
    Ok(Formatted { changed, problems })
}

/// Maximum depth for which the stack of any thread is large enough.
const USUAL: usize = 100;
/// Maximum stack of one level.
const BYTES_PER_LEVEL: usize = 16 * 1024;

/// Runs `work` on this thread, or on a thread with a stack that is large enough for `depth` levels.
fn with_room<T: Send>(depth: usize, work: impl FnOnce() -> io::Result<T> + Send) -> io::Result<T> {
    if depth <= USUAL {
        return work();
    }
    thread::scope(|scope| {
        let builder = thread::Builder::new().name("deep save".to_owned());
        let builder = builder.stack_size((depth + USUAL) * BYTES_PER_LEVEL);
        match builder.spawn_scoped(scope, work)?.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

/// Returns the nesting depth of `root`. Skips states shared with `old`.
fn depth(root: &Arc<State>, old: Option<&Arc<State>>) -> usize {
    let mut deepest = 0;
    let mut waiting = vec![(root, old, 1)];
    while let Some((state, old, depth)) = waiting.pop() {
        deepest = deepest.max(depth);
        let (Some(container), false) =
            (state.container(), old.is_some_and(|old| Arc::ptr_eq(old, state)))
        else {
            continue;
        };
        let before = old.and_then(|old| old.container());
        for (id, child) in container.states.iter() {
            let old = before.and_then(|before| before.states.get(id));
            waiting.push((child, old, depth + 1));
        }
    }
    deepest
}
