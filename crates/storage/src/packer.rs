//! Converts a machine and its libraries to the files that a save would write. Caches what was packed before, so that unchanged
//! states are not encoded again.

use crate::config::Naming;
use crate::files::{HEADER, MACHINE_LAYOUT, Part};
use crate::journal::pack::{MACHINE, library_folder};
use crate::journal::{Hash, Manifest, Pack};
use crate::write::{Old, file_bytes, folder_name, free_name, header_text, layout_text};
use crate::{Libraries, Saved};
use rafcon_model::{Header, Kind, Library, LibraryContent, Machine, State, StateId};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::sync::Arc;

/// Packer for the machines of one run.
#[derive(Debug, Default)]
pub struct Packer {
    /// Hashes of a state's files by the address of the state. Holds the state, so that no other state gets the address.
    known: BTreeMap<usize, (Arc<State>, Files)>,
}

type Files = [Option<Hash>; Part::ALL.len()];

impl Packer {
    /// Packs a machine that was loaded as `saved` with `libraries`, including later changes.
    pub fn pack(
        &mut self,
        machine: &Machine,
        saved: Option<&Saved>,
        libraries: &Libraries,
    ) -> Pack {
        let mut walk =
            PackerWalk { before: std::mem::take(&mut self.known), ..PackerWalk::default() };
        let old = saved.map(Old::of);
        walk.machine(MACHINE.to_owned(), &machine.header, &machine.root, old);
        while let Some((folder, (library, root))) = walk.waiting.pop_first() {
            walk.done.insert(folder.clone());
            let parsed = libraries.known(&library.path, &library.name);
            let saved = parsed.as_ref().map(|parsed| &parsed.saved);
            let header = saved.map_or_else(Header::default, |saved| saved.header.clone());
            walk.machine(folder, &header, &root, saved.map(Old::of));
        }
        self.known = walk.known;
        Pack { manifest: Manifest::new(walk.files), fresh: walk.fresh }
    }
}

/// The state while one machine is packed.
#[derive(Default)]
struct PackerWalk {
    before: BTreeMap<usize, (Arc<State>, Files)>,
    known: BTreeMap<usize, (Arc<State>, Files)>,
    files: Vec<(String, Hash)>,
    fresh: BTreeMap<Hash, Vec<u8>>,
    /// Found libraries by folder.
    waiting: BTreeMap<String, (Library, Arc<State>)>,
    done: BTreeSet<String>,
}

impl PackerWalk {
    fn machine(
        &mut self,
        folder: String,
        header: &Header,
        root: &Arc<State>,
        old: Option<Old<'_>>,
    ) {
        let texts = [(HEADER, Some(header_text(header))), (MACHINE_LAYOUT, layout_text(header))];
        for (name, text) in texts {
            if let Some(text) = text {
                let hash = self.keep(text.into_bytes());
                self.files.push((format!("{folder}/{name}"), hash));
            }
        }
        let old = old.filter(|old| old.state.id == root.id);
        let mut open = vec![(folder, root, old)];
        while let Some((folder, state, old)) = open.pop() {
            self.state(&folder, state, old);
            children(&folder, state, old, &mut open);
        }
    }

    fn state(&mut self, folder: &str, state: &Arc<State>, old: Option<Old<'_>>) {
        let address = Arc::as_ptr(state).addr();
        let known = self.before.remove(&address);
        let known = known.or_else(|| self.known.get(&address).cloned());
        let (kept, files) = known.unwrap_or_else(|| {
            let file = |part| file_bytes(state, old, part).map(|bytes| self.keep(bytes));
            (Arc::clone(state), Part::ALL.map(file))
        });
        for (part, hash) in Part::ALL.into_iter().zip(files) {
            let path = || format!("{folder}/{}", part.file_name());
            self.files.extend(hash.map(|hash| (path(), hash)));
        }
        self.known.insert(address, (kept, files));
        if let Kind::Library(library) = &state.kind {
            self.library(library);
        }
    }

    fn library(&mut self, library: &Library) {
        let LibraryContent::Found(root) = &library.content else { return };
        let Some(folder) = library_folder(&library.path, &library.name) else { return };
        if !self.done.contains(&folder) {
            self.waiting.entry(folder).or_insert_with(|| (library.clone(), Arc::clone(root)));
        }
    }

    fn keep(&mut self, bytes: Vec<u8>) -> Hash {
        let hash = Hash::of(&bytes);
        self.fresh.insert(hash, bytes);
        hash
    }
}

type Open<'m> = Vec<(String, &'m Arc<State>, Option<Old<'m>>)>;

/// The states in `state`, each with a folder of its own.
fn children<'m>(folder: &str, state: &'m Arc<State>, old: Option<Old<'m>>, open: &mut Open<'m>) {
    let Some(container) = state.container() else { return };
    let mut taken: BTreeSet<OsString> = BTreeSet::new();
    for (id, child) in container.states.iter() {
        let name = free_name(&folder_name(child, Naming::default()), |name| taken.contains(name));
        open.push((format!("{folder}/{}", name.display()), child, old_child(old, id)));
        taken.insert(name);
    }
}

fn old_child<'m>(old: Option<Old<'m>>, id: &StateId) -> Option<Old<'m>> {
    let old = old?;
    Some(Old { state: old.state.container()?.states.get(id)?, place: old.place.child(id)? })
}
