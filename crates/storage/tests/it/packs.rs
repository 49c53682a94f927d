//! Any machine that a run stores is restored unchanged, with its libraries.

use crate::arbitrary::{Shown, machine};
use crate::folders::read;
use proptest::prelude::*;
use rafcon_model::{Kind, Library, Machine, notation};
use rafcon_storage::journal::{About, Journal, Options, Packed};
use rafcon_storage::{Libraries, Naming, Packer, Root, load_packed, save};
use std::path::Path;
use std::sync::Arc;

fn options() -> Options {
    Options { recorder_bytes: 1 << 15, ..Options::default() }
}

/// All library states below the root.
fn libraries(machine: &Machine) -> Vec<Library> {
    let mut open = vec![&machine.root];
    let mut found = Vec::new();
    while let Some(state) = open.pop() {
        if let Kind::Library(library) = &state.kind {
            found.push(library.clone());
        }
        open.extend(state.container().into_iter().flat_map(|c| c.states.iter().map(|(_, s)| s)));
    }
    found
}

/// The machine as text, without the folders in which a library was not found.
fn shown(machine: &Machine) -> Vec<String> {
    let text = notation::print(machine);
    let is_told = |line: &&str| !line.trim_start().starts_with("missing ");
    text.lines().filter(is_told).map(str::to_owned).collect()
}

/// The machine after it was packed, kept, unpacked and loaded below `folder`.
fn again(machine: &Machine, known: &Libraries, folder: &Path) -> Machine {
    let journal = Journal::create(&folder.join("run"), &About::default(), &options()).unwrap();
    let pack = Packer::default().pack(machine, None, known);
    let hash = journal.keep_root(&pack).unwrap();
    assert_eq!(hash, pack.manifest.hash());
    let packed = Arc::new(Packed::read(&folder.join("run"), hash).unwrap());
    let libraries = Libraries::default().packed(Arc::clone(&packed));
    load_packed(&packed, Packed::MACHINE, folder, &libraries).unwrap().machine
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_machine_comes_back(
        Shown(machine) in machine(),
        Shown(one) in machine(),
        Shown(other) in machine(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("libraries");
        // Libraries in libraries, and some that are missing.
        for (machine, library) in [(&machine, &one), (&one, &other)] {
            for reference in libraries(machine).iter().skip(1) {
                let place = dir.join(&*reference.name);
                if !place.exists() {
                    save(library, &place, None, Naming::default()).unwrap();
                }
            }
        }
        std::fs::create_dir_all(&dir).unwrap();
        save(&machine, &folder.path().join("machine"), None, Naming::default()).unwrap();
        let known = Libraries::new(vec![Root { name: "lib".into(), dir }]);
        let machine = read(&folder.path().join("machine"), &known).machine;
        let again = again(&machine, &known, folder.path());
        prop_assert_eq!(shown(&machine), shown(&again));
    }
}
