//! Saving: compares with what is on disk and carries out the difference. Knows the order of things; each thing itself is
//! done elsewhere.

use super::commit::{commit, is_interrupted, recover};
use super::deep;
use super::disk::{Disk, RealDisk};
use super::encode;
use super::lock;
use super::parts::Old;
use super::plan::{Mode, Plan, Planner};
use crate::config::Naming;
use crate::files::{HEADER, MACHINE_LAYOUT};
use crate::place::{Saved, StateFolder};
use crate::read::{LoadError, load_locked};
use rafcon_model::{Header, Machine};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Why a machine was not saved. What was on disk before is there, or will be after the next load.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The disk refused something.
    #[error("cannot save to {}", path.display())]
    Io {
        /// The machine's folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// There is a machine in the folder that cannot be read, and so not be replaced.
    #[error("cannot replace the machine in {}", path.display())]
    Occupied {
        /// The folder.
        path: PathBuf,
        /// Why it cannot be read.
        source: LoadError,
    },
}

/// Writes what of `machine` differs from what is on disk, into the folder `target`.
///
/// `previous` is what was loaded from or saved to `target` before: then only changed states are looked at, and folders
/// keep their names. With the `previous` of another folder, a copy is written. Without, a machine that is in `target` is
/// replaced. Foreign files stay in every case. A kill at any moment leaves the old or the new machine.
pub fn save(
    machine: &Machine,
    target: &Path,
    previous: Option<&Saved>,
    naming: Naming,
) -> Result<Saved, SaveError> {
    save_on(&RealDisk, machine, target, previous, naming)
}

/// The same on any disk.
pub(crate) fn save_on(
    disk: &dyn Disk,
    machine: &Machine,
    target: &Path,
    previous: Option<&Saved>,
    naming: Naming,
) -> Result<Saved, SaveError> {
    let failed = |source| SaveError::Io { path: target.to_owned(), source };
    disk.create_dir(target).map_err(failed)?;
    let _lock = lock::exclusive(target).map_err(failed)?;
    let recovered = is_interrupted(disk, target) && recover(disk, target).map_err(failed)?;
    let known = previous.filter(|previous| !recovered && is_same_folder(&previous.dir, target));
    let occupant = if known.is_none() { occupant(disk, target)? } else { None };
    let old = known.or(occupant.as_ref()).or(previous);
    let here = known.is_some() || occupant.is_some();
    let rewrite = here && old.is_some_and(|old| old.outdated);
    let mode = Mode { naming, rewrite, stale: old.is_some_and(|old| old.stale), here };
    let (plan, place) = plan(disk, machine, target, old, mode).map_err(failed)?;
    commit(disk, target, &plan).map_err(failed)?;
    Ok(saved(machine, target, place))
}

/// What is on disk after a save.
pub(crate) fn saved(machine: &Machine, target: &Path, place: StateFolder) -> Saved {
    Saved {
        dir: target.to_owned(),
        header: machine.header.clone(),
        root: Arc::clone(&machine.root),
        place,
        outdated: false,
        stale: false,
    }
}

/// The plan that brings the disk from `old` to `machine`, and where everything is then.
pub(crate) fn plan(
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
    let depth = deep::depth(&machine.root, shared);
    let place = deep::with_room(depth, || planner.root(&machine.root, old))?;
    Ok((planner.plan, place))
}

fn machine_files(planner: &mut Planner<'_>, new: &Header, old: Option<&Header>) -> io::Result<()> {
    let header = encode::header(new);
    let same = old.is_some_and(|old| encode::header(old) == header);
    planner.machine_file(HEADER, Some(header.into_bytes()), same)?;
    let same = old.map_or(new.layout.text().is_none(), |old| old.layout == new.layout);
    planner.machine_file(MACHINE_LAYOUT, encode::machine_layout(new).map(String::into_bytes), same)
}

/// The machine that is in the folder already.
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
