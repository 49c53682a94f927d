//! Any machine is read as it was written.

use crate::arbitrary::{Shown, machine};
use crate::folders::{files, read};
use proptest::prelude::*;
use rafcon_model::Machine;
use rafcon_model::notation::print;
use rafcon_storage::{Libraries, Naming, core_data, format, save, state_from_core_data};

const DOCUMENTS: [&str; 3] = [
    include_str!("../../../../tests/fixtures/layouts/2.2/machine/core_data.json"),
    include_str!("../../../../tests/fixtures/layouts/2.2/machine/ask_where_ASKASK/core_data.json"),
    include_str!("../../../../tests/fixtures/layouts/0.7.12/machine/ROOTAA/SEARCH/core_data.json"),
];

/// Returns the first line in which the two differ.
fn first_difference(found: &Machine, expected: &Machine) -> Option<(String, String)> {
    let (found, expected) = (print(found), print(expected));
    let mut lines = found.lines().zip(expected.lines());
    let pair = lines.find(|(found, expected)| found != expected)?;
    Some((pair.0.to_owned(), pair.1.to_owned()))
}

/// Pieces of JSON that are valid in various places.
const PIECES: [&str; 12] = [
    "{}",
    "[]",
    "null",
    "\"",
    "1",
    "-2",
    "{\"0\": ",
    "}",
    ",",
    "\"outcomes\": {\"00\": {}}, ",
    "1e9",
    "\\u00",
];

proptest! {
    #[test]
    fn damaged_documents_are_states_or_faults(
        document in 0..DOCUMENTS.len(),
        cuts in proptest::collection::vec((any::<prop::sample::Index>(), 0..20_usize, 0..PIECES.len()), 1..4),
    ) {
        let mut text = DOCUMENTS[document].to_owned();
        for (at, length, piece) in cuts {
            let at = at.index(text.len());
            let end = (at + length).min(text.len());
            text.replace_range(at..end, PIECES[piece]);
        }
        if let Ok((state, _)) = state_from_core_data(&text, "folder_FOLDER") {
            let once = core_data(&state);
            let again = state_from_core_data(&once, "folder_FOLDER");
            prop_assert_eq!(again.map(|(state, _)| core_data(&state)), Ok(once));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_machine_reads_back_and_a_second_save_writes_nothing(Shown(machine) in machine()) {
        let dir = tempfile::tempdir().unwrap();
        let saved = save(&machine, dir.path(), None, Naming::default()).unwrap();
        let read = read(dir.path(), &Libraries::default());
        prop_assert_eq!(first_difference(&read.machine, &machine), None);
        prop_assert!(read.machine == machine);
        let before = files(dir.path());
        save(&read.machine, dir.path(), Some(&saved), Naming::default()).unwrap();
        save(&machine, dir.path(), Some(&read.saved), Naming::default()).unwrap();
        prop_assert!(files(dir.path()) == before);
        prop_assert!(format(dir.path(), Naming::default(), true).unwrap().changed.is_empty());
    }

    #[test]
    fn any_machine_becomes_any_other(Shown(one) in machine(), Shown(other) in machine()) {
        let dir = tempfile::tempdir().unwrap();
        let saved = save(&one, dir.path(), None, Naming::default()).unwrap();
        save(&other, dir.path(), Some(&saved), Naming::default()).unwrap();
        let read = read(dir.path(), &Libraries::default()).machine;
        prop_assert_eq!(first_difference(&read, &other), None);
        prop_assert!(read == other);
        let fresh = tempfile::tempdir().unwrap();
        save(&other, fresh.path(), None, Naming::default()).unwrap();
        prop_assert_eq!(files(dir.path()).len(), files(fresh.path()).len());
    }
}
