//! Appending, committing, closing and resuming without accidents.

use super::{SMALL, append, create, entered, kept};
use crate::journal::folder::RECORDER_FILE;
use crate::journal::{
    Batch, Definition, Full, Journal, JournalError, Place, PlaceNumber, Stored, ValueNumber,
    record::Content, writer_of,
};
use expect_test::expect;
use serde_json::json;

#[test]
fn what_is_appended_is_there_after_a_commit() {
    let folder = tempfile::tempdir().unwrap();
    let journal = create(folder.path());
    let mut batch = Batch::new(0);
    append(&journal, &mut batch, [1, 2]);
    assert_eq!(journal.disk_safe(), 0);
    assert_eq!(journal.commit().unwrap().sequence, 2);
    append(&journal, &mut batch, [3]);
    assert_eq!((journal.sequence(), journal.disk_safe()), (3, 2));
    journal.close().unwrap();
    expect!["1:1:1 2:2:2 3:3:3"].assert_eq(&kept(folder.path()));
    assert!(!folder.path().join(RECORDER_FILE).exists());
}

#[test]
fn a_run_is_resumed_with_what_its_recorder_held() {
    let folder = tempfile::tempdir().unwrap();
    let journal = create(folder.path());
    let mut batch = Batch::new(0);
    append(&journal, &mut batch, [1, 2]);
    journal.commit().unwrap();
    append(&journal, &mut batch, [3, 4]);
    drop(journal);
    let (journal, resume_point) = Journal::resume(folder.path(), &SMALL).unwrap();
    assert_eq!((resume_point.sequence, resume_point.t_ns, resume_point.life), (4, 4, 2));
    append(&journal, &mut Batch::new(4), [5]);
    drop(journal);
    let (_journal, resume_point) = Journal::resume(folder.path(), &SMALL).unwrap();
    assert_eq!((resume_point.sequence, resume_point.life), (5, 3));
    expect!["1:1:1 2:2:2 3:3:3 4:4:4 5:5:5"].assert_eq(&kept(folder.path()));
}

#[test]
fn the_recorder_is_full_until_the_next_commit() {
    let folder = tempfile::tempdir().unwrap();
    let journal = create(folder.path());
    let mut batch = Batch::new(0);
    for round in 0..5 {
        let mut count = 0;
        let full = loop {
            entered(&mut batch, 0, round);
            match journal.append(&batch) {
                Ok(_) => count += 1,
                Err(full) => break full,
            }
            batch.clear();
        };
        assert!(matches!(full, Full::Recorder) && count > 300, "{count}");
        journal.commit().unwrap();
        journal.append(&batch).unwrap();
        batch.clear();
    }
    let all = journal.sequence();
    journal.close().unwrap();
    assert_eq!(kept(folder.path()).split(' ').count() as u64, all);
}

#[test]
fn a_group_larger_than_the_recorder_is_kept_as_a_whole() {
    let folder = tempfile::tempdir().unwrap();
    let journal = create(folder.path());
    let mut batch = Batch::new(0);
    (1..5000).for_each(|place| entered(&mut batch, 0, place));
    journal.append(&batch).unwrap();
    batch.clear();
    append(&journal, &mut batch, [5000]);
    drop(journal);
    let (journal, resume_point) = Journal::resume(folder.path(), &SMALL).unwrap();
    assert_eq!(resume_point.sequence, 5000);
    batch.clear();
    (5001..9000).for_each(|place| entered(&mut batch, 0, place));
    assert_eq!(journal.append(&batch).unwrap(), 8999);
    assert_eq!(journal.close().unwrap().sequence, 8999);
    assert_eq!(kept(folder.path()).split(' ').count(), 8999);
}

#[test]
fn places_and_values_are_known_after_taking_up() {
    let folder = tempfile::tempdir().unwrap();
    let journal = create(folder.path());
    let mut batch = Batch::new(0);
    let place = |names: &str| Place {
        path: "A".to_owned(),
        names: names.to_owned(),
        is_library: false,
        is_script: true,
        inputs: vec![],
        outputs: vec![],
        scoped: vec![],
        outcomes: vec![(0, "done".into())],
    };
    let stored =
        Stored { view: json!("x".repeat(300)), type_name: "str".into(), content: Content::View };
    batch.define(&Definition::Place(PlaceNumber(7), place("early")));
    batch.define(&Definition::Value(ValueNumber(1), stored.clone()));
    entered(&mut batch, 1, 7);
    batch.define(&Definition::Place(PlaceNumber(7), place("late")));
    batch.define(&Definition::Value(ValueNumber(2), stored));
    entered(&mut batch, 2, 7);
    journal.append(&batch).unwrap();
    drop(journal);
    let (_journal, resume_point) = Journal::resume(folder.path(), &SMALL).unwrap();
    assert_eq!(resume_point.next_value, ValueNumber(3));
    assert_eq!(resume_point.places, [(PlaceNumber(7), place("late"))]);
    expect!["1:1:7 2:2:7"].assert_eq(&kept(folder.path()));
}

#[test]
fn times_never_go_backwards() {
    let folder = tempfile::tempdir().unwrap();
    let journal = create(folder.path());
    let mut batch = Batch::new(0);
    for t_ns in [5, 9, 3, 0, 11] {
        entered(&mut batch, t_ns, 1);
        journal.append(&batch).unwrap();
        batch.clear();
    }
    journal.close().unwrap();
    expect!["1:5:1 2:9:1 3:9:1 4:9:1 5:11:1"].assert_eq(&kept(folder.path()));
}

#[test]
fn a_run_has_one_writer() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(writer_of(folder.path()).unwrap(), None);
    let journal = create(folder.path());
    assert_eq!(writer_of(folder.path()).unwrap(), Some(std::process::id()));
    let refused = Journal::resume(folder.path(), &SMALL).unwrap_err();
    assert!(matches!(refused, JournalError::Going { .. }));
    assert_eq!(writer_of(folder.path()).unwrap(), Some(std::process::id()));
    drop(journal);
    assert_eq!(writer_of(folder.path()).unwrap(), None);
    Journal::resume(folder.path(), &SMALL).unwrap();
}
