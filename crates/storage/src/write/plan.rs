//! Plans the operations of a save: new files, moved folders, removals. Uses both trees and the folders of the old one. Reads names
//! of folders and writes nothing.

use super::naming::{folder_name, free_name};
use super::parts::{self, Old};
use crate::config::Naming;
use crate::files::{Part, STAGING, StateFolder};
use crate::staging::{Disk, NewFile, Plan};
use rafcon_model::{State, StateId};
use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Extent of the comparison and of the writing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mode {
    pub(crate) naming: Naming,
    /// True to compare every file with the disk, and to give every folder its standard name.
    pub(crate) rewrite: bool,
    /// True if some unchanged state differs from its file.
    pub(crate) stale: bool,
    /// True if the old tree is in the target folder.
    pub(crate) here: bool,
}

impl Mode {
    /// Returns true if states identical to the loaded ones are skipped.
    pub(crate) fn is_lazy(self) -> bool {
        self.here && !self.rewrite && !self.stale
    }
}

/// Creates the plan of one save.
pub(crate) struct Planner<'p> {
    disk: &'p dyn Disk,
    dir: &'p Path,
    mode: Mode,
    pub(crate) plan: Plan,
    staged: usize,
}

/// The folders of a state, relative to the machine's folder.
#[derive(Debug, Clone)]
struct StateLocation {
    /// Current folder of the files. `None` if they are not on this disk.
    now: Option<PathBuf>,
    /// Location of the folder after its ancestors have moved.
    moved: PathBuf,
    /// Folder for new files: the folder itself, or a staged one.
    path: PathBuf,
    /// True if the folder does not exist yet and is prepared as a whole.
    staged: bool,
}

/// A state to write.
struct Job<'j> {
    new: &'j State,
    old: Option<Old<'j>>,
    location: &'j StateLocation,
}

impl<'p> Planner<'p> {
    pub(crate) fn new(disk: &'p dyn Disk, dir: &'p Path, mode: Mode) -> Self {
        Self { disk, dir, mode, plan: Plan::default(), staged: 0 }
    }

    /// Plans the whole tree and returns its folders after the save.
    pub(crate) fn root(
        &mut self,
        new: &Arc<State>,
        old: Option<Old<'_>>,
    ) -> io::Result<StateFolder> {
        let lies = old.map(|old| PathBuf::from(&*old.place.folder)).unwrap_or_default();
        let now = self.mode.here.then(|| lies.clone());
        let moved = if self.mode.here { lies.clone() } else { PathBuf::new() };
        let location = StateLocation { now, moved, path: PathBuf::new(), staged: false };
        let place = self.state(new, old, &location)?;
        if self.mode.here && !lies.as_os_str().is_empty() {
            self.remove_files(&lies);
        }
        Ok(place.in_folder(OsString::new()))
    }

    /// Plans one of the machine's own files.
    pub(crate) fn machine_file(
        &mut self,
        name: &str,
        bytes: Option<Vec<u8>>,
        is_same: bool,
    ) -> io::Result<()> {
        let path = PathBuf::from(name);
        let on_disk = if self.mode.rewrite { self.disk.read(&self.dir.join(name))? } else { None };
        let skip = if self.mode.rewrite { on_disk == bytes } else { is_same };
        match bytes {
            _ if skip => {}
            Some(bytes) => self.replace(path, bytes),
            None => {
                self.plan.changed.push(path.clone());
                self.plan.manifest.removed.push(path);
            }
        }
        Ok(())
    }

    fn state(
        &mut self,
        new: &Arc<State>,
        old: Option<Old<'_>>,
        location: &StateLocation,
    ) -> io::Result<StateFolder> {
        if let Some(old) = old.filter(|old| self.is_untouched(new, *old, location)) {
            return Ok(old.place.clone());
        }
        for part in Part::ALL {
            self.part(&Job { new, old, location }, part)?;
        }
        let children = self.children(new, old, location)?;
        let place = StateFolder::new(OsString::new(), children).with(parts::oddities(new, old));
        Ok(place)
    }

    fn part(&mut self, job: &Job<'_>, part: Part) -> io::Result<()> {
        if self.is_as_before(job, part) {
            return Ok(());
        }
        let bytes = parts::bytes(job.new, job.old, part);
        let at = job.location.path.join(part.file_name());
        if job.location.staged {
            self.plan.files.extend(bytes.map(|bytes| NewFile { path: at, bytes, like: None }));
            return Ok(());
        }
        if self.is_there(job, part, bytes.as_deref())? {
            return Ok(());
        }
        match bytes {
            Some(bytes) => self.replace(at, bytes),
            None if job.location.now.is_some() => {
                self.plan.changed.push(at.clone());
                self.plan.manifest.removed.push(at);
            }
            None => {}
        }
        Ok(())
    }

    /// Returns true if this program loaded or saved the file and its part did not change.
    fn is_as_before(&self, job: &Job<'_>, part: Part) -> bool {
        let Some(old) = job.old.filter(|_| job.location.now.is_some() && !self.mode.rewrite) else {
            return false;
        };
        let is_stale = part == Part::Core && old.place.is_stale();
        !is_stale && parts::is_same(job.new, old.state, part)
    }

    /// Returns true if the file on disk is correct. Applies only if every file is compared.
    fn is_there(&self, job: &Job<'_>, part: Part, bytes: Option<&[u8]>) -> io::Result<bool> {
        let Some(now) = job.location.now.as_ref().filter(|_| self.mode.rewrite) else {
            return Ok(false);
        };
        if job.location.moved != job.location.path {
            return Ok(bytes.is_none());
        }
        let found = self.disk.read(&self.dir.join(now).join(part.file_name()))?;
        Ok(found.as_deref() == bytes)
    }

    /// Plans a file that replaces another one.
    fn replace(&mut self, to: PathBuf, bytes: Vec<u8>) {
        let path = self.staged_path();
        self.plan.files.push(NewFile { path: path.clone(), bytes, like: Some(to.clone()) });
        self.plan.changed.push(to.clone());
        self.plan.manifest.moves.push((path, to));
    }

    fn staged_path(&mut self) -> PathBuf {
        self.staged += 1;
        Path::new(STAGING).join(self.staged.to_string())
    }

    fn children(
        &mut self,
        new: &State,
        old: Option<Old<'_>>,
        location: &StateLocation,
    ) -> io::Result<Vec<(StateId, StateFolder)>> {
        self.remove_children(new, old, location);
        let Some(container) = new.container() else { return Ok(Vec::new()) };
        let mut names = Names { taken: None };
        let mut places = Vec::with_capacity(container.states.len());
        let mut earlier = old.into_iter().flat_map(Old::children).peekable();
        for (id, child) in container.states.iter() {
            while earlier.next_if(|(known, _)| *known < id).is_some() {}
            let before = earlier.next_if(|(known, _)| *known == id).map(|(_, before)| before);
            if let Some(before) =
                before.filter(|before| self.is_untouched(child, *before, location))
            {
                places.push((id.clone(), before.place.clone()));
                continue;
            }
            let (folder, inside) = self.child(child, before, location, &mut names)?;
            let place = self.state(child, before, &inside)?;
            places.push((id.clone(), place.in_folder(folder)));
        }
        Ok(places)
    }

    /// Returns true if the child and its path are unchanged.
    fn is_untouched(&self, child: &Arc<State>, before: Old<'_>, location: &StateLocation) -> bool {
        self.mode.is_lazy() && location.now.is_some() && Arc::ptr_eq(child, before.state)
    }

    /// Returns the child's folder and its location.
    fn child(
        &mut self,
        child: &State,
        before: Option<Old<'_>>,
        location: &StateLocation,
        names: &mut Names,
    ) -> io::Result<(OsString, StateLocation)> {
        if location.staged {
            let folder = names.free(child, self.mode.naming);
            let path = location.path.join(&folder);
            self.plan.folders.push(path.clone());
            return Ok((
                folder,
                StateLocation { now: None, moved: path.clone(), path, staged: true },
            ));
        }
        let here = before.zip(location.now.as_ref());
        let Some((before, now)) = here else {
            return self.new_child(child, location, names);
        };
        let lies = &before.place.folder;
        let stays = location.moved == location.path && !self.is_renamed(child, before);
        let folder = if stays {
            lies.to_os_string()
        } else {
            self.take_names(location, names)?;
            names.free_but(child, self.mode.naming, lies)
        };
        let (from, to) = (location.moved.join(Path::new(&**lies)), location.path.join(&folder));
        if from != to {
            self.plan.changed.push(to.clone());
            self.plan.manifest.moves.push((from, to.clone()));
        }
        Ok((
            folder,
            StateLocation {
                now: Some(now.join(Path::new(&**lies))),
                moved: to.clone(),
                path: to,
                staged: false,
            },
        ))
    }

    fn is_renamed(&self, child: &State, before: Old<'_>) -> bool {
        let is_damaged = before.place.verbatim(Part::Core).is_some();
        let renamed = (self.mode.rewrite && !is_damaged) || child.name != before.state.name;
        renamed && *before.place.folder != *OsStr::new(&folder_name(child, self.mode.naming))
    }

    fn new_child(
        &mut self,
        child: &State,
        location: &StateLocation,
        names: &mut Names,
    ) -> io::Result<(OsString, StateLocation)> {
        self.take_names(location, names)?;
        let folder = names.free(child, self.mode.naming);
        let path = self.staged_path();
        let to = location.path.join(&folder);
        self.plan.folders.push(path.clone());
        self.plan.changed.push(to.clone());
        self.plan.manifest.moves.push((path.clone(), to));
        Ok((folder, StateLocation { now: None, moved: path.clone(), path, staged: true }))
    }

    /// Reads the names in the folder, once.
    fn take_names(&self, location: &StateLocation, names: &mut Names) -> io::Result<()> {
        if names.taken.is_none() {
            let mut taken: BTreeSet<OsString> = BTreeSet::new();
            for folder in location.now.iter().chain([&location.path]) {
                taken.extend(self.disk.list(&self.dir.join(folder))?);
            }
            names.taken = Some(taken);
        }
        Ok(())
    }

    /// Plans the removal of states that are not in `new`, with their content.
    fn remove_children(&mut self, new: &State, old: Option<Old<'_>>, location: &StateLocation) {
        let Some(old) = old.filter(|_| location.now.is_some()) else { return };
        let states = new.container().map(|container| &container.states);
        for (id, place) in old.place.children() {
            if states.is_none_or(|states| !states.contains_key(id)) {
                self.remove_tree(place, &location.moved.join(Path::new(&*place.folder)));
            }
        }
    }

    fn remove_tree(&mut self, place: &StateFolder, at: &Path) {
        for (_, inner) in place.children() {
            self.remove_tree(inner, &at.join(Path::new(&*inner.folder)));
        }
        self.remove_files(at);
    }

    fn remove_files(&mut self, at: &Path) {
        let files = Part::ALL.iter().map(|part| at.join(part.file_name()));
        self.plan.manifest.removed.extend(files);
        self.plan.manifest.emptied.push(at.to_owned());
        self.plan.changed.push(at.to_owned());
    }
}

/// Names in use in one folder.
struct Names {
    taken: Option<BTreeSet<OsString>>,
}

impl Names {
    /// Returns an unused name.
    fn free(&mut self, state: &State, naming: Naming) -> OsString {
        self.free_but(state, naming, OsStr::new(""))
    }

    /// Returns an unused name for a folder that may keep its own.
    fn free_but(&mut self, state: &State, naming: Naming, own: &OsStr) -> OsString {
        let taken = self.taken.get_or_insert_default();
        let is_taken = |name: &OsStr| name != own && taken.contains(name);
        let name = free_name(&folder_name(state, naming), is_taken);
        taken.insert(name.clone());
        name
    }
}
