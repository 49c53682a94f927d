//! Journals of other versions, which must not be written.

use super::{SMALL, append, create};
use crate::journal::folder::{ABOUT_FILE, DATABASE_FILE};
use crate::journal::store::Database;
use crate::journal::{About, Batch, Journal, JournalError};
use expect_test::{Expect, expect};
use std::fs;
use std::path::Path;

fn check(spoil: impl FnOnce(&Path), expect: &Expect) {
    let folder = tempfile::tempdir().unwrap();
    create(folder.path()).close().unwrap();
    spoil(folder.path());
    let refused = Journal::resume(folder.path(), &SMALL).unwrap_err();
    expect.assert_eq(&refused.to_string().replace(&*folder.path().to_string_lossy(), "RUN"));
}

#[test]
fn a_newer_journal_is_left_alone() {
    let newer_tables = |folder: &Path| {
        let mut database = Database::open(folder).unwrap();
        database.run(|connection| connection.pragma_update(None, "user_version", 7)).unwrap();
    };
    check(
        newer_tables,
        &expect![
            "RUN/journal.db is of version 7, this rafcon reads up to 2: use the rafcon that wrote it, or a newer one"
        ],
    );
    let newer_about = |folder: &Path| {
        fs::write(folder.join(ABOUT_FILE), r#"{"version": 9, "what": "ever"}"#).unwrap();
    };
    check(
        newer_about,
        &expect![
            "RUN/run.json is of version 9, this rafcon reads up to 2: use the rafcon that wrote it, or a newer one"
        ],
    );
}

#[test]
fn what_is_no_journal_is_named() {
    check(
        |folder| fs::remove_file(folder.join(ABOUT_FILE)).unwrap(),
        &expect!["there is no run in RUN: it has no run.json; `rafcon runs` lists all runs"],
    );
    check(
        |folder| fs::remove_file(folder.join(DATABASE_FILE)).unwrap(),
        &expect!["there is no run in RUN: it has no journal.db; `rafcon runs` lists all runs"],
    );
    check(
        |folder| fs::write(folder.join(ABOUT_FILE), "{").unwrap(),
        &expect![
            "RUN/run.json is damaged: EOF while parsing an object at line 1 column 1; `rafcon history` shows what can still be read"
        ],
    );
    check(
        |folder| fs::write(folder.join(DATABASE_FILE), "not a database").unwrap(),
        &expect![
            "RUN/journal.db is damaged: file is not a database; `rafcon history` shows what can still be read"
        ],
    );
}

#[test]
fn a_run_is_begun_once() {
    let folder = tempfile::tempdir().unwrap();
    let journal = create(folder.path());
    append(&journal, &mut Batch::default(), [1]);
    journal.close().unwrap();
    let refused = Journal::create(folder.path(), &About::default(), &SMALL).unwrap_err();
    assert!(matches!(refused, JournalError::Exists { .. }));
}
