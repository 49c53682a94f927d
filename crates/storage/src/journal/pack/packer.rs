//! From a machine to the files that a save would write, of its libraries too. Knows what was packed before, so that states
//! that are still the same are not encoded again.

use super::manifest::{Hash, Manifest};
use crate::config::Naming;
use crate::files::{HEADER, MACHINE_LAYOUT, Part};
use crate::write::{Old, file_bytes, folder_name, free_name, header_text, layout_text};
use crate::{Libraries, Saved};
use rafcon_model::{Header, Kind, Library, LibraryContent, Machine, State, StateId};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::sync::Arc;

/// The folder of the machine itself.
pub(super) const MACHINE: &str = "machine";
/// The folder of the libraries; each lies below its library path.
const LIBRARIES: &str = "libraries";

/// A machine, ready to be kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pack {
    /// All files.
    pub manifest: Manifest,
    /// The content of those that the packer had not packed before.
    pub fresh: BTreeMap<Hash, Vec<u8>>,
}

/// Packs the machines of one run.
#[derive(Debug, Default)]
pub struct Packer {
    /// By address of a state, which is held here so that no other gets it: the hashes of its files.
    known: BTreeMap<usize, (Arc<State>, Files)>,
}

type Files = [Option<Hash>; Part::ALL.len()];

impl Packer {
    /// Packs a machine that was loaded as `saved` with `libraries`, and may have been changed since.
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

/// One packing.
#[derive(Default)]
struct PackerWalk {
    before: BTreeMap<usize, (Arc<State>, Files)>,
    known: BTreeMap<usize, (Arc<State>, Files)>,
    files: Vec<(String, Hash)>,
    fresh: BTreeMap<Hash, Vec<u8>>,
    /// Libraries that were found, by folder.
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

/// Where a library lies in a pack; `None` if its name leads out of any root.
pub(super) fn library_folder(path: &str, name: &str) -> Option<String> {
    let parts = path.split('/').chain(name.split('/'));
    let is_plain = |part: &str| !part.is_empty() && part != "." && part != "..";
    parts.clone().all(is_plain).then(|| {
        let folder = parts.collect::<Vec<_>>().join("/");
        format!("{LIBRARIES}/{folder}")
    })
}
