//! Keyframes of a run, which give its state at any moment without reading all events.

use super::create;
use crate::journal::record::Content;
use crate::journal::store::Database;
use crate::journal::{Batch, Journal, Kept, Options, PlaceNumber, Record, Stored, ValueNumber};
use expect_test::{Expect, expect};
use rafcon_protocol::{LogLevel, Stream};
use serde_json::json;
use std::path::Path;

/// Shows keyframes (sequence and next value), then values that were named after the keyframe before theirs.
fn check(folder: &Path, expect: &Expect) {
    let mut database = Database::open(folder).unwrap();
    let pair = |row: &rusqlite::Row<'_>| Ok((row.get(0)?, row.get(1)?));
    let mut read = |query: &str| -> Vec<(i64, i64)> {
        database.run(|c| c.prepare(query)?.query_map([], pair)?.collect()).unwrap()
    };
    let keyframes = read("SELECT sequence, next_value FROM keyframes ORDER BY sequence");
    let named = read("SELECT number, last FROM named ORDER BY number");
    expect.assert_eq(&format!("{keyframes:?} {named:?}"));
}

/// Appends and commits this many lines.
fn fill(journal: &Journal, batch: &mut Batch, lines: u32) {
    let message = String::new();
    let line = Record::Log { place: None, level: LogLevel::Info, stream: Stream::Stdout, message };
    for number in 1..=lines {
        batch.record(2, &line);
        if number % 200 == 0 {
            journal.append(batch).unwrap();
            batch.clear();
        }
        if number % 2000 == 0 {
            journal.commit().unwrap();
        }
    }
}

#[test]
fn keyframes_come_every_fifty_thousand_records_also_after_taking_up() {
    let folder = tempfile::tempdir().unwrap();
    let journal = create(folder.path());
    let mut batch = Batch::new(0);
    let value = |number| {
        let content = Content::Nothing("no reason".to_owned());
        (ValueNumber(number), Stored { view: json!(1), type_name: "lock".into(), content })
    };
    let scoped = |batch: &mut Batch, number| {
        let value = Kept::Value(ValueNumber(number));
        batch.record(1, &Record::Scoped { place: PlaceNumber(1), port: 0, value });
    };
    for number in 1..=2 {
        let (number, stored) = value(number);
        batch.define_value(number, &stored);
        scoped(&mut batch, number.0);
    }
    fill(&journal, &mut batch, 60_000);
    check(folder.path(), &expect!["[(50002, 3)] []"]);
    scoped(&mut batch, 1);
    fill(&journal, &mut batch, 30_000);
    drop(journal);
    let (journal, resume_point) = Journal::resume(folder.path(), &Options::default()).unwrap();
    assert_eq!(resume_point.next_value, ValueNumber(3));
    let mut batch = Batch::new(resume_point.t_ns);
    fill(&journal, &mut batch, 30_000);
    check(folder.path(), &expect!["[(50002, 3), (100003, 3)] [(1, 60003)]"]);
}
