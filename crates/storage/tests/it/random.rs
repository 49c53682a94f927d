//! Any machine reads back as it was written.

use crate::arbitrary::{Shown, machine};
use crate::folders::{files, read};
use proptest::prelude::*;
use rafcon_model::Machine;
use rafcon_model::notation::print;
use rafcon_storage::{Libraries, Naming, format, save};

/// The first line in which the two differ.
fn first_difference(found: &Machine, expected: &Machine) -> Option<(String, String)> {
    let (found, expected) = (print(found), print(expected));
    let mut lines = found.lines().zip(expected.lines());
    let pair = lines.find(|(found, expected)| found != expected)?;
    Some((pair.0.to_owned(), pair.1.to_owned()))
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
