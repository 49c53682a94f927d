//! History of runs in pages and moments, compared with the journals.

use crate::harness::TestServer;
use crate::past::{END, RUN, append, get, said, server, write};
use expect_test::{Expect, expect};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use rafcon_protocol::api::{HistoryEntry, Role};
use rafcon_storage::journal::{Filter, Found, Reader, Search};
use serde_json::{Value, json};
use std::ops::ControlFlow;

/// Prints one line per entry of a list.
fn check(server: &TestServer, path: &str, list: &str, expect: &Expect) {
    let answer = get(server, path);
    let lines = answer[list].as_array().unwrap().iter().map(|entry| format!("{entry}\n"));
    let cursor = format!("next {} last {}\n", answer["next"], answer["last"]);
    expect.assert_eq(&(lines.collect::<String>() + &cursor));
}

#[test]
fn events_are_told_with_and_without_values_as_far_as_they_are_wanted() {
    let server = server(&[("run", &format!("{RUN}{END}"))]);
    check(
        &server,
        "run/events?from=3&count=3&values=true",
        "events",
        &expect![[r#"
            {"event":{"name":"map","type":"global","value":{"rooms":[1,2]}},"sequence":3,"t_ns":3000000}
            {"event":{"inputs":{"a":[1,2]},"path":"R/A","type":"entered"},"sequence":4,"t_ns":4000000}
            {"event":{"level":"info","message":"scanning the ROOM","path":"R/A","stream":"logger","type":"log"},"sequence":5,"t_ns":5000000}
            next 6 last 15
        "#]],
    );
    check(
        &server,
        "run/events?state=scan&kinds=entered,left,scoped",
        "events",
        &expect![[r#"
            {"event":{"path":"R/A","type":"entered"},"sequence":4,"t_ns":4000000}
            {"event":{"outcome":{"id":0,"name":"ok"},"path":"R/A","type":"left"},"sequence":7,"t_ns":7000000}
            next 16 last 15
        "#]],
    );
    check(
        &server,
        "run/events?since_ms=11&until_ms=12",
        "events",
        &expect![[r#"
            {"event":{"level":"debug","message":"looking","path":"R/H/X","stream":"logger","type":"log"},"sequence":11,"t_ns":11000000}
            {"event":{"outcome":{"id":0,"name":"ok"},"path":"R/H/X","type":"left"},"sequence":12,"t_ns":12000000}
            next 16 last 15
        "#]],
    );
}

#[test]
fn a_cursor_beyond_the_end_waits_there() {
    let server = server(&[("run", RUN)]);
    for from in [13, 99, i64::MAX.cast_unsigned() + 7, u64::MAX] {
        let page = get(&server, &format!("run/events?from={from}&text=room"));
        assert_eq!(page, json!({"events": [], "next": from, "last": 12}));
    }
}

#[test]
fn the_log_is_told_by_level_state_and_text() {
    let server = server(&[("run", RUN)]);
    check(
        &server,
        "run/log?level=info&count=1",
        "lines",
        &expect![[r#"
            {"level":"info","message":"scanning the ROOM","names":"Root/Scan","path":"R/A","sequence":5,"stream":"logger","t_ns":5000000}
            next 6 last 12
        "#]],
    );
    check(
        &server,
        "run/log?text=LOOK&state=*X",
        "lines",
        &expect![[r#"
            {"level":"debug","message":"looking","names":"Root/Search/Look","path":"R/H/X","sequence":11,"stream":"logger","t_ns":11000000}
            next 13 last 12
        "#]],
    );
}

#[test]
fn a_moment_is_found_by_its_number_and_by_its_time() {
    let server = server(&[("run", &format!("{RUN}{END}"))]);
    let at = get(&server, "run/moments/6");
    assert_eq!(at, get(&server, "run/moments?t_ms=6"));
    assert_eq!(at["globals"], json!({"map": {"rooms": [1, 2]}}));
    assert_eq!(at["active"][1]["names"], "Root/Scan");
    assert_eq!(at["active"][1]["inputs"], json!({"a": [1, 2]}));
    assert_eq!(get(&server, "run/moments/0")["active"], json!([]));
    assert_eq!(get(&server, "run/moments")["outcome"]["name"], "done");
    let path = server.runs().join("run");
    let mut reader = Reader::open(&path).unwrap();
    for sequence in 0..=15 {
        let moment = reader.moment(sequence).unwrap();
        let picture = serde_json::to_value(reader.picture(&moment).unwrap()).unwrap();
        assert_eq!(get(&server, &format!("run/moments/{sequence}")), picture);
    }
}

#[test]
fn an_event_by_itself_names_what_is_kept_of_its_values() {
    let server = server(&[("run", RUN)]);
    let event = get(&server, "run/events/4");
    assert_eq!(event["names"], "Root/Scan");
    let value = json!({"number": 2, "type_name": "list", "view": [1, 2], "kept": "view"});
    assert_eq!(event["values"], json!([{"name": "a", "value": value}]));
    assert_eq!(get(&server, "run/values/2"), value);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let server = server(&[("run", RUN)]);
    let mut text = String::new();
    for path in [
        "nobody/events",
        "..%2F..%2Fetc/events",
        "run/events?count=0",
        "run/events?count=1001",
        "run/events?count=-1",
        "run/events?from=x",
        "run/events?kinds=entered,nothing",
        "run/events/13",
        "run/events/0",
        "run/log?level=loud",
        "run/moments/13",
        "run/moments/x",
        "run/values/0",
        "run/values/18446744073709551615",
        "run/machine",
        "run/machine?root=abc",
        "run/machine?root=aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa",
        "run/compare/nobody",
        "run/export",
        "run/export?format=xml",
    ] {
        text += &(said(&server, Role::Viewer, "GET", path) + " " + path + "\n");
    }
    expect![[r"
        404 no_such_run nobody/events
        404 no_such_run ..%2F..%2Fetc/events
        400 bad_count run/events?count=0
        400 bad_count run/events?count=1001
        400 bad_query run/events?count=-1
        400 bad_query run/events?from=x
        400 no_such_kind run/events?kinds=entered,nothing
        404 no_such_event run/events/13
        404 no_such_event run/events/0
        400 bad_query run/log?level=loud
        404 no_such_event run/moments/13
        400 bad_path run/moments/x
        404 no_such_value run/values/0
        404 no_such_value run/values/18446744073709551615
        404 no_such_machine run/machine
        400 bad_hash run/machine?root=abc
        404 no_such_machine run/machine?root=aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa
        404 no_such_run run/compare/nobody
        400 bad_query run/export
        400 bad_query run/export?format=xml
    "]]
    .assert_eq(&text);
}

#[test]
fn a_damaged_journal_is_said_to_be_and_the_others_are_read() {
    let place = tempfile::tempdir().unwrap();
    let runs = place.path().join("runs");
    for id in ["bad", "good"] {
        write(&runs, id, RUN).close().unwrap();
    }
    let file = runs.join("bad/journal.db");
    std::fs::write(&file, "no database at all, but long enough to be taken for one").unwrap();
    let server = TestServer::at(place, |_settings| {});
    let mut text = String::new();
    for what in ["events", "log", "moments", "statistics", "compare/good", "export?format=csv"] {
        text += &(said(&server, Role::Viewer, "GET", &format!("bad/{what}")) + " " + what + "\n");
    }
    expect![[r"
        422 journal_damaged events
        422 journal_damaged log
        422 journal_damaged moments
        422 journal_damaged statistics
        422 journal_damaged compare/good
        422 journal_damaged export?format=csv
    "]]
    .assert_eq(&text);
    assert_eq!(get(&server, "good/events")["last"], 12);
}

#[test]
fn a_run_that_goes_on_is_read_as_it_grows_and_after_its_runner_died() {
    let place = tempfile::tempdir().unwrap();
    let journal = write(&place.path().join("runs"), "run", RUN);
    let server = TestServer::at(place, |_settings| {});
    assert_eq!(get(&server, "run/events?from=12")["next"], 13);
    assert_eq!(get(&server, "run/statistics")["sequence"], 12);
    append(&journal, "enter R/A a=1");
    journal.commit().unwrap();
    assert_eq!(get(&server, "run/events?from=13")["events"][0]["event"]["path"], "R/A");
    append(&journal, "leave R/A lost");
    drop(journal);
    assert_eq!(get(&server, "run/events?from=14")["events"][0]["event"]["outcome"]["name"], "lost");
    let statistics = get(&server, "run/statistics");
    assert_eq!(statistics["sequence"], 14);
    assert_eq!(statistics["states"][0]["outcomes"][1]["outcome"]["name"], "lost");
}

#[derive(Debug, Clone)]
struct Asked {
    counts: Vec<usize>,
    from: u64,
    values: bool,
    state: Option<&'static str>,
    kinds: Vec<&'static str>,
    text: Option<&'static str>,
    times: (Option<u64>, Option<u64>),
}

fn asked() -> impl Strategy<Value = Asked> {
    let times = (prop::option::of(0..90_u64), prop::option::of(0..90_u64));
    let kinds = prop::sample::subsequence(vec!["entered", "left", "log", "scoped", "global"], 0..4);
    let state = prop::option::of(prop::sample::select(vec!["scan", "R/H", "*Look"]));
    let text = prop::option::of(prop::sample::select(vec!["room", "Search", "nowhere"]));
    let counts = prop::collection::vec(1..30_usize, 1..5);
    (counts, 0..90_u64, any::<bool>(), state, kinds, text, times).prop_map(
        |(counts, from, values, state, kinds, text, times)| Asked {
            counts,
            from,
            values,
            state,
            kinds,
            text,
            times,
        },
    )
}

impl Asked {
    fn query(&self, from: u64, count: usize) -> String {
        let mut query = format!("from={from}&count={count}&values={}", self.values);
        query += &self.state.map(|state| format!("&state={state}")).unwrap_or_default();
        query += &self.text.map(|text| format!("&text={text}")).unwrap_or_default();
        query += &self.times.0.map(|ms| format!("&since_ms={ms}")).unwrap_or_default();
        query += &self.times.1.map(|ms| format!("&until_ms={ms}")).unwrap_or_default();
        if self.kinds.is_empty() { query } else { query + "&kinds=" + &self.kinds.join(",") }
    }

    /// All matching events of the journal.
    fn whole(&self, reader: &mut Reader) -> Vec<Value> {
        let nanos = |ms: u64| ms * 1_000_000;
        let filter = Filter {
            state: self.state.map(str::to_owned),
            text: self.text.map(str::to_owned),
            kinds: self.kinds.iter().map(|kind| (*kind).to_owned()).collect(),
            from_ns: self.times.0.map(nanos),
            to_ns: self.times.1.map(nanos),
            ..Filter::default()
        };
        let search =
            Search { filter: &filter, from: self.from, look: u64::MAX, values: self.values };
        let mut whole = Vec::new();
        let show = |found: Found| -> Result<_, rafcon_storage::journal::JournalError> {
            let Found { sequence, t_ns, event, .. } = found;
            whole.push(serde_json::to_value(HistoryEntry { sequence, t_ns, event }).unwrap());
            Ok(ControlFlow::Continue(()))
        };
        reader.search(&search, show).unwrap();
        whole
    }

    /// The matching events over HTTP, in pages.
    fn paged(&self, server: &TestServer) -> Vec<Value> {
        let (mut from, mut events) = (self.from, Vec::new());
        for count in self.counts.iter().cycle() {
            let page = get(server, &format!("run/events?{}", self.query(from, *count)));
            let next = page["next"].as_u64().unwrap();
            events.extend(page["events"].as_array().unwrap().iter().cloned());
            if next > page["last"].as_u64().unwrap() {
                return events;
            }
            assert!(next > from, "{page}");
            from = next;
        }
        events
    }
}

#[test]
fn pages_of_any_size_and_filter_are_what_the_journal_says() {
    let server = server(&[("run", &RUN.repeat(7))]);
    let path = server.runs().join("run");
    TestRunner::new(ProptestConfig::with_cases(48))
        .run(&asked(), |asked| {
            let mut reader = Reader::open(&path).unwrap();
            prop_assert_eq!(asked.paged(&server), asked.whole(&mut reader));
            Ok(())
        })
        .unwrap();
}
