//! Detection of runs that have begun, and handling of journals without events.

use rafcon_storage::journal::folder::{ABOUT_FILE, DATABASE_FILE, RECORDER_FILE};
use rafcon_storage::journal::{
    About, Journal, JournalError, Options, Reader, RunState, Summary, has_begun,
};
use rafcon_testkit::journal_notation;
use std::fs;
use std::path::Path;

fn create(folder: &Path, name: &str) -> Result<Journal, JournalError> {
    let about = About { name: name.to_owned(), ..About::default() };
    Journal::create(folder, &about, &Options::default())
}

#[test]
fn a_journal_without_an_event_is_begun_anew_and_one_with_an_event_never() {
    let folder = tempfile::tempdir().unwrap();
    assert!(!has_begun(folder.path()));
    drop(create(folder.path(), "first").unwrap());
    assert!(!has_begun(folder.path()));
    let journal = create(folder.path(), "second").unwrap();
    let batch = journal_notation::batch("place R \"Root\" outcome done\nenter R\n", 0).unwrap();
    journal.append(&batch).unwrap();
    drop(journal);
    assert!(has_begun(folder.path()));
    let refused = create(folder.path(), "third").unwrap_err();
    assert!(matches!(refused, JournalError::Exists { .. }), "{refused}");
    assert_eq!(About::read(folder.path()).unwrap().name, "second");
}

#[test]
fn a_journal_that_was_only_half_made_is_made_again() {
    let steps = [DATABASE_FILE, RECORDER_FILE, ABOUT_FILE];
    for made in 0..steps.len() {
        let folder = tempfile::tempdir().unwrap();
        drop(create(folder.path(), "first").unwrap());
        for missing in &steps[made..] {
            fs::remove_file(folder.path().join(missing)).unwrap();
        }
        assert!(!has_begun(folder.path()), "{made} steps");
        drop(create(folder.path(), "second").unwrap());
        assert_eq!(About::read(folder.path()).unwrap().name, "second");
    }
}

#[test]
fn a_database_without_tables_is_one_of_a_run_that_never_began() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(DATABASE_FILE), "").unwrap();
    drop(create(folder.path(), "first").unwrap());
    create(folder.path(), "second").unwrap().discard().unwrap();
    assert!(!folder.path().join(ABOUT_FILE).exists());
}

#[test]
fn a_run_that_was_resumed_after_its_end_has_no_end_until_its_next_one() {
    let folder = tempfile::tempdir().unwrap();
    let end = r#"told {"type": "finished", "outcome": {"id": 0, "name": "done"}, "outputs": {}, "globals": {}, "scoped_variables": {}, "states_run": 1}"#;
    let resumed = r#"told {"type": "resumed", "life": 2, "crash": {"reason": "", "active": []}, "policy": "abort"}"#;
    let state = |text: &str| {
        let run = folder.path().join(text.len().to_string());
        let journal = create(&run, "R").unwrap();
        journal.append(&journal_notation::batch(text, 0).unwrap()).unwrap();
        drop(journal);
        let has_end = Reader::open(&run).unwrap().last_end().unwrap().is_some();
        (matches!(Summary::of(&run).state, RunState::Finished { .. }), has_end)
    };
    assert_eq!(state(&format!("{end}\n")), (true, true));
    assert_eq!(state(&format!("{end}\n{resumed}\n")), (false, false));
    assert_eq!(state(&format!("{end}\n{resumed}\n{end}\n")), (true, true));
}
