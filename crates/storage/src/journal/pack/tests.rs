//! A machine that is packed, stored and unpacked is unchanged.

use super::store::manifest;
use super::{Hash, Packed};
use crate::journal::store::Database;
use crate::journal::{About, Journal, Options, Pack};
use crate::{Libraries, Loaded, Packer, Root, load, load_packed};
use proptest::prelude::*;
use rafcon_model::{Machine, diff};
use rafcon_testkit::files::make_files;
use rafcon_testkit::machines::{EVERY_KIND, machine};
use rafcon_testkit::notation;
use std::path::Path;
use std::sync::Arc;

fn keep(run: &Path, packs: &[&Pack]) -> Hash {
    let options = Options { recorder_bytes: 1 << 15, ..Options::default() };
    let journal = Journal::create(run, &About::default(), &options).unwrap();
    let hashes = packs.iter().map(|pack| journal.keep_root(pack).unwrap());
    hashes.last().unwrap()
}

/// Reads the machine that the run in the folder `run` has stored.
fn unpacked(run: &Path, hash: Hash) -> Loaded {
    let packed = Arc::new(Packed::read(run, hash).unwrap());
    let libraries = Libraries::default().packed(Arc::clone(&packed));
    load_packed(&packed, Packed::MACHINE, Path::new("/where/it/lay"), &libraries).unwrap()
}

/// Packs, stores and reads a machine.
fn check(machine: &Machine) {
    let folder = tempfile::tempdir().unwrap();
    let pack = Packer::default().pack(machine, None, &Libraries::default());
    let hash = keep(&folder.path().join("run"), &[&pack]);
    let loaded = unpacked(&folder.path().join("run"), hash);
    assert_eq!(diff(machine, &loaded.machine), []);
    assert_eq!(notation::print(machine), notation::print(&loaded.machine));
}

#[test]
fn every_kind_of_state_comes_back() {
    check(&machine(EVERY_KIND));
}

#[test]
fn examples_come_back_with_their_libraries() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for name in ["library_reuse", "mission", "barrier_with_decider"] {
        let dir = examples.join("libraries");
        let libraries = Libraries::new(vec![Root { name: "examples".into(), dir }]);
        let Loaded { machine, saved, problems } = load(&examples.join(name), &libraries).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let pack = Packer::default().pack(&machine, Some(&saved), &libraries);
        let hash = keep(&folder.path().join("run"), &[&pack]);
        let loaded = unpacked(&folder.path().join("run"), hash);
        assert_eq!(diff(&machine, &loaded.machine), []);
        assert_eq!(problems, loaded.problems);
    }
}

#[test]
fn files_that_nobody_understands_come_back_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    make_files(
        &folder.path().join("in"),
        "== statemachine.json\n{\"creation_time\": \"now\"}\n== core_data.json\n{broken\n== script.py\nx = 1\n",
    );
    let libraries = Libraries::default();
    let Loaded { machine, saved, problems } = load(&folder.path().join("in"), &libraries).unwrap();
    let pack = Packer::default().pack(&machine, Some(&saved), &libraries);
    let hash = keep(&folder.path().join("run"), &[&pack]);
    let loaded = unpacked(&folder.path().join("run"), hash);
    assert_eq!(diff(&machine, &loaded.machine), []);
    assert_eq!(problems, loaded.problems);
    let again = Packer::default().pack(&loaded.machine, Some(&loaded.saved), &libraries);
    assert_eq!(again.manifest, pack.manifest);
}

#[test]
fn one_edit_costs_one_edit() {
    let folder = tempfile::tempdir().unwrap();
    let first = machine(EVERY_KIND);
    let mut packer = Packer::default();
    let one = packer.pack(&first, None, &Libraries::default());
    let mut second = first.clone();
    let root = Arc::make_mut(&mut second.root);
    root.name = "another".into();
    let two = packer.pack(&second, None, &Libraries::default());
    assert_eq!((one.fresh.len(), two.fresh.len()), (15, 3));
    let hash = keep(folder.path(), &[&one, &two, &one]);
    assert_eq!(hash, one.manifest.hash());
    let loaded = unpacked(folder.path(), two.manifest.hash());
    assert_eq!(diff(&second, &loaded.machine), []);
}

#[test]
fn a_long_line_of_edits_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut machine = machine(EVERY_KIND);
    let mut packer = Packer::default();
    let packs: Vec<Pack> = (0..70)
        .map(|number| {
            Arc::make_mut(&mut machine.root).name = format!("name {number}").into();
            packer.pack(&machine, None, &Libraries::default())
        })
        .collect();
    keep(folder.path(), &packs.iter().collect::<Vec<_>>());
    let mut database = Database::open(folder.path()).unwrap();
    for pack in packs {
        let found = database.run(|connection| manifest(connection, pack.manifest.hash()));
        assert_eq!(found.unwrap().unwrap(), Some(pack.manifest));
    }
}

proptest! {
    #[test]
    fn changes_lead_from_any_list_to_any_other(
        before in prop::collection::btree_map("[a-c]{1,2}", 0_u8..3, 0..9),
        after in prop::collection::btree_map("[a-c]{1,2}", 0_u8..3, 0..9),
    ) {
        let manifest = |files: std::collections::BTreeMap<String, u8>| {
            let file = |(path, content)| (path, Hash::of(&[content]));
            super::Manifest::new(files.into_iter().map(file).collect())
        };
        let (before, after) = (manifest(before), manifest(after));
        let changes = after.changes(&before);
        prop_assert_eq!(before.changed(&changes).unwrap(), after);
    }
}
