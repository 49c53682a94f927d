//! Journals from text, read as events and as moments.

use expect_test::{Expect, expect};
use rafcon_protocol::api;
use rafcon_storage::journal::{About, Entry, Journal, Options, Reader};
use rafcon_testkit::journal_notation;
use std::path::Path;

/// The places of a run of a small machine.
pub(crate) const PLACES: &str = r#"
    place R "Root" in speed scoped n outcome done
    place R/A "Root/Scan" script in a out b outcome ok
    place R/H "Root/Search" scoped m outcome ok
    place R/H/X "Root/Search/Look" script out x outcome ok
"#;

const RUN: &str = r#"
    enter R speed=1.5
    scoped R n=0
    global map={"rooms": [1, 2]}
    enter R/A a=[1, 2]
    log R/A info "scanning"
    persistent R/A {"calls": 1}
    leave R/A ok b="far"
    scoped R n=1
    enter R/H
    scoped R/H m=null
    enter R/H/X
    leave R/H/X ok x=7
    told {"type": "waiting", "path": "R/H", "reason": "no transition"}
"#;

/// Writes a run of this text whose runner has died. Everything before the mark `---` is committed.
fn dead_run(folder: &Path, text: &str) -> Reader {
    let about = About { name: "test".to_owned(), ..About::default() };
    let journal = Journal::create(folder, &about, &Options::default()).unwrap();
    let (safe, left) = text.split_once("---").unwrap_or((text, ""));
    let mut batch = journal_notation::batch(&format!("{PLACES}{safe}"), 0).unwrap();
    journal.append(&batch).unwrap();
    journal.commit().unwrap();
    let (count, t_ns) = (batch.count(), batch.t_last());
    batch.clear();
    if !left.trim().is_empty() {
        // The places must be known; they are defined again.
        batch = journal_notation::batch(&format!("{PLACES}{left}"), t_ns).unwrap();
        journal.append(&batch).unwrap();
    }
    assert_eq!(journal.sequence(), u64::from(count + batch.count()));
    drop(journal);
    Reader::open(folder).unwrap()
}

fn check_events(text: &str, expect: &Expect) {
    let folder = tempfile::tempdir().unwrap();
    let mut reader = dead_run(folder.path(), text);
    let page = reader.page(1, 100).unwrap();
    let line = |entry| {
        let event = serde_json::to_string(&reader.event(entry, true).unwrap()).unwrap();
        format!("{} {event}\n", entry.sequence)
    };
    expect.assert_eq(&page.iter().map(line).collect::<String>());
}

#[test]
fn events_have_names_and_values() {
    check_events(
        RUN,
        &expect![[r#"
        1 {"type":"entered","path":"R","inputs":{"speed":1.5}}
        2 {"type":"scoped","path":"R","name":"n","value":0}
        3 {"type":"global","name":"map","value":{"rooms":[1,2]}}
        4 {"type":"entered","path":"R/A","inputs":{"a":[1,2]}}
        5 {"type":"log","path":"R/A","level":"info","stream":"logger","message":"scanning"}
        6 {"type":"persistent","path":"R/A","value":{"calls":1}}
        7 {"type":"left","path":"R/A","outcome":{"id":0,"name":"ok"},"outputs":{"b":"far"}}
        8 {"type":"scoped","path":"R","name":"n","value":1}
        9 {"type":"entered","path":"R/H","inputs":{}}
        10 {"type":"scoped","path":"R/H","name":"m","value":null}
        11 {"type":"entered","path":"R/H/X","inputs":{}}
        12 {"type":"left","path":"R/H/X","outcome":{"id":0,"name":"ok"},"outputs":{"x":7}}
        13 {"type":"waiting","path":"R/H","reason":"no transition"}
    "#]],
    );
}

#[test]
fn what_a_dead_runner_left_is_read_behind_the_database() {
    check_events(
        "enter R speed=1 \n --- \n enter R/A a={\"k\": [1]} \n leave R/A ok b=2",
        &expect![[r#"
            1 {"type":"entered","path":"R","inputs":{"speed":1}}
            2 {"type":"entered","path":"R/A","inputs":{"a":{"k":[1]}}}
            3 {"type":"left","path":"R/A","outcome":{"id":0,"name":"ok"},"outputs":{"b":2}}
        "#]],
    );
}

#[test]
fn a_moment_has_names_and_values() {
    let folder = tempfile::tempdir().unwrap();
    let mut reader = dead_run(folder.path(), RUN);
    let moment = reader.moment(12).unwrap();
    let picture = reader.picture(&moment).unwrap();
    let active = picture.active.iter().map(|state| serde_json::to_string(state).unwrap());
    expect![[r#"
        {"path":"R","names":"Root","depth":0,"entered":1,"since_ns":1000000,"inputs":{"speed":1.5},"scoped":{"n":1},"ended":[{"path":"R/A","names":"Root/Scan","outcome":{"id":0,"name":"ok"},"outputs":{"b":"far"},"error":null,"sequence":7}]}
        {"path":"R/H","names":"Root/Search","depth":1,"entered":9,"since_ns":9000000,"inputs":{},"scoped":{"m":null},"ended":[{"path":"R/H/X","names":"Root/Search/Look","outcome":{"id":0,"name":"ok"},"outputs":{"x":7},"error":null,"sequence":12}]}"#]].assert_eq(&active.collect::<Vec<_>>().join("\n"));
    let rest = api::Moment { active: Vec::new(), ..picture };
    expect![[r#"{"sequence":12,"t_ns":12000000,"status":"running","outcome":null,"root":null,"life":1,"states_run":4,"active":[],"held":[],"waiting":{},"globals":{"map":{"rooms":[1,2]}},"persistent":{"R/A":{"calls":1}},"breakpoints":[],"questions":[]}"#]].assert_eq(&serde_json::to_string(&rest).unwrap());
}

#[test]
fn a_page_begins_and_ends_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let mut reader = dead_run(folder.path(), RUN);
    let numbers = |page: Vec<Entry>| page.iter().map(|e| e.sequence).collect::<Vec<_>>();
    assert_eq!(numbers(reader.page(0, 2).unwrap()), [1, 2]);
    assert_eq!(numbers(reader.page(12, 5).unwrap()), [12, 13]);
    assert_eq!(numbers(reader.page(14, 5).unwrap()), [0; 0]);
    assert_eq!(numbers(reader.page(3, 0).unwrap()), [0; 0]);
    assert_eq!(reader.last_sequence().unwrap(), 13);
}

#[test]
fn an_event_is_found_by_its_time() {
    let folder = tempfile::tempdir().unwrap();
    let mut reader =
        dead_run(folder.path(), "enter R\nenter R/A\n--- @5 leave R/A ok\n@5 enter R/H");
    let at = [0, 1_000_000, 1_000_001, 5_000_000, 5_000_001, u64::MAX];
    assert_eq!(at.map(|t_ns| reader.first_at(t_ns).unwrap()), [1, 1, 2, 3, 5, 5]);
}

#[test]
fn what_an_event_names_by_number_has_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"enter R speed=[1]
        global map={"a": 1}
        enter R/A a="short"
        leave R/A ok b=[2] error={"__exc__": "E"}"#;
    let mut reader = dead_run(folder.path(), text);
    let page = reader.page(1, 10).unwrap();
    let named = page.iter().map(|entry| {
        let values = reader.named_values(entry);
        values
            .iter()
            .map(|(name, number)| format!("{name}={}", number.0))
            .collect::<Vec<_>>()
            .join(" ")
    });
    assert_eq!(named.collect::<Vec<_>>(), ["speed=1", "map=2", "", "b=3 error=4"]);
}
