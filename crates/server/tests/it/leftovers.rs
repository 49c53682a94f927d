//! Data derived from whole runs: machines, figures, comparisons and exports; and the deletion of runs.

use crate::harness::TestServer;
use crate::past::{END, RUN, get, said, server, write};
use expect_test::expect;
use rafcon_protocol::api::Role;
use rafcon_storage::journal::{About, Journal, Options};
use rafcon_storage::{Libraries, Loaded, Packer, Root, load};
use rafcon_testkit::journal_notation;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::Read as _;
use std::path::Path;

#[test]
fn states_are_counted_and_two_runs_compared() {
    let lost = RUN.replace("leave R/A ok", "leave R/A lost");
    let server = server(&[("one", &format!("{RUN}{END}")), ("other", &lost)]);
    let mut text = String::new();
    for state in get(&server, "one/statistics")["states"].as_array().unwrap() {
        writeln!(text, "{state}").unwrap();
    }
    let compared = get(&server, "one/compare/other");
    writeln!(text, "{} alike, {}", compared["alike"], compared["parted"]).unwrap();
    expect![[r#"
        {"count":1,"max_ns":13000000,"median_ns":13000000,"min_ns":13000000,"names":"Root","outcomes":[{"count":1,"outcome":{"id":0,"name":"done"}}],"p95_ns":13000000,"path":"R","total_ns":13000000}
        {"count":1,"max_ns":3000000,"median_ns":3000000,"min_ns":3000000,"names":"Root/Scan","outcomes":[{"count":1,"outcome":{"id":0,"name":"ok"}}],"p95_ns":3000000,"path":"R/A","total_ns":3000000}
        {"count":1,"max_ns":4000000,"median_ns":4000000,"min_ns":4000000,"names":"Root/Search","outcomes":[{"count":1,"outcome":{"id":0,"name":"ok"}}],"p95_ns":4000000,"path":"R/H","total_ns":4000000}
        {"count":1,"max_ns":2000000,"median_ns":2000000,"min_ns":2000000,"names":"Root/Search/Look","outcomes":[{"count":1,"outcome":{"id":0,"name":"ok"}}],"p95_ns":2000000,"path":"R/H/X","total_ns":2000000}
        2 alike, [{"branch":"R","names":"Root","one":{"backwards":false,"names":"Root/Scan","outcome":{"id":0,"name":"ok"},"path":"R/A","sequence":7,"t_ns":7000000},"other":{"backwards":false,"names":"Root/Scan","outcome":{"id":1,"name":"lost"},"path":"R/A","sequence":7,"t_ns":7000000}}]
    "#]]
    .assert_eq(&text);
    assert_eq!(get(&server, "one/compare/one")["parted"], json!([]));
}

#[test]
fn a_long_run_is_asked_for_by_the_part_that_is_looked_at() {
    let server = server(&[("one", &format!("{RUN}{END}"))]);
    let whole = get(&server, "one/events");
    let window = get(&server, "one/window?from=4&count=3");
    let events = whole["events"].as_array().unwrap();
    let wanted = |event: &&Value| (4..7).contains(&event["sequence"].as_u64().unwrap());
    assert_eq!(
        *window["events"].as_array().unwrap(),
        events.iter().filter(wanted).cloned().collect::<Vec<_>>()
    );
    let path = |state: &Value| state["path"].as_str().unwrap().to_owned();
    let before: Vec<String> =
        window["before"]["active"].as_array().unwrap().iter().map(path).collect();
    let moment = get(&server, "one/moments/3");
    assert_eq!(before, moment["active"].as_array().unwrap().iter().map(path).collect::<Vec<_>>());
    assert_eq!(window["next"], 7);
    let counted = get(&server, "one/statistics");
    let last = counted["sequence"].as_u64().unwrap();
    assert_eq!(get(&server, &format!("one/statistics?until={last}")), counted);
    assert_eq!(get(&server, "one/statistics?until=1")["states"], json!([]));
    let earlier = get(&server, &format!("one/earlier/{last}"));
    for state in counted["states"].as_array().unwrap() {
        let states = earlier["states"].as_array().unwrap();
        let known = states.iter().find(|it| it["path"] == state["path"]).unwrap();
        assert_eq!((&known["ends"], &known["total_ns"]), (&state["count"], &state["total_ns"]));
    }
    let overview = get(&server, "one/overview?pixels=1000");
    assert_eq!(overview["sequence"], last);
    let found = get(&server, "one/hits?text=SCAN");
    assert_eq!(found["events"][0]["event"]["path"], "R/A", "{found}");
}

#[test]
fn a_part_of_a_run_that_is_asked_for_has_bounds() {
    let server = server(&[("one", &format!("{RUN}{END}"))]);
    let said = |path: &str| said(&server, Role::Viewer, "GET", &format!("one/{path}"));
    for (path, most) in
        [("window?count", 20_000), ("overview?pixels", 10_000), ("hits?text=a&count", 1_000)]
    {
        assert_eq!(said(&format!("{path}={most}")), "200", "{path}");
        assert_eq!(said(&format!("{path}={}", most + 1)), "400 bad_count", "{path}");
        assert_eq!(said(&format!("{path}=0")), "400 bad_count", "{path}");
    }
}

/// A run with two machines: one that uses a library, and a later small one.
fn with_machines(run: &Path) -> Vec<String> {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let dir = examples.join("libraries");
    let libraries = Libraries::new(vec![Root { name: "examples".into(), dir }]);
    let journal = Journal::create(run, &About::default(), &Options::default()).unwrap();
    let mut text = "place R \"Root\" outcome done\nenter R\n".to_owned();
    let mut hashes = Vec::new();
    for name in ["library_reuse", "global_variables"] {
        let Loaded { machine, saved, .. } = load(&examples.join(name), &libraries).unwrap();
        let pack = Packer::default().pack(&machine, Some(&saved), &libraries);
        let hash = journal.keep_root(&pack).unwrap().to_string();
        writeln!(text, "told {}", json!({"type": "root", "hash": hash, "change": name})).unwrap();
        hashes.push(hash);
    }
    journal.append(&journal_notation::batch(&text, 0).unwrap()).unwrap();
    journal.close().unwrap();
    hashes
}

#[test]
fn the_machines_that_a_run_went_by_are_told() {
    let place = tempfile::tempdir().unwrap();
    let hashes = with_machines(&place.path().join("runs/run"));
    let server = TestServer::at(place, |_settings| {});
    let first = get(&server, "run/machine");
    assert!(first["states"].as_array().unwrap().len() > 1, "{first}");
    assert_eq!(get(&server, &format!("run/machine?root={}", hashes[0])), first);
    assert_eq!(get(&server, "run/machine"), first);
    let later = get(&server, &format!("run/machine?root={}", hashes[1]));
    assert_ne!(later, first);
    let state =
        first["states"].as_array().unwrap().iter().find(|state| state["library"] != Value::Null);
    let library = &state.unwrap()["library"];
    let path =
        format!("{}/{}", library["path"].as_str().unwrap(), library["name"].as_str().unwrap());
    let inside = get(&server, &format!("run/machine?library={path}"));
    assert!(!inside["states"].as_array().unwrap().is_empty(), "{inside}");
    for nothing in ["nowhere", "nowhere/at_all", "examples/../../../run", "/etc/passwd"] {
        let path = format!("run/machine?library={nothing}");
        assert_eq!(said(&server, Role::Viewer, "GET", &path), "404 no_such_library");
    }
    let left = std::fs::read_dir(server.state()).unwrap().flatten();
    let names: Vec<_> = left.map(|entry| entry.file_name()).collect();
    assert!(!names.iter().any(|name| name.to_string_lossy().starts_with("machine-")), "{names:?}");
}

/// Content and headers of a file.
fn file(server: &TestServer, path: &str) -> (Vec<u8>, [String; 2]) {
    let url = format!("{}/api/v1/runs/{path}", server.url());
    let token = format!("Bearer {}", server.token(Role::Viewer));
    let answer = ureq::get(url).header("Authorization", token).call().unwrap();
    let header = |name| answer.headers()[name].to_str().unwrap().to_owned();
    let headers = ["content-type", "content-disposition"].map(header);
    let mut bytes = Vec::new();
    answer.into_body().into_reader().read_to_end(&mut bytes).unwrap();
    (bytes, headers)
}

#[test]
fn a_run_is_exported_as_a_file_with_a_name() {
    let server = server(&[("run", &RUN.repeat(400))]);
    let (lines, headers) = file(&server, "run/export?format=jsonl");
    assert_eq!(headers, ["application/jsonl", "attachment; filename=\"run.jsonl\""]);
    let lines = String::from_utf8(lines).unwrap();
    let last: Value = serde_json::from_str(lines.lines().last().unwrap()).unwrap();
    assert_eq!((lines.lines().count(), &last["sequence"]), (4800, &json!(4800)));
    assert_eq!(last["utc"], "2026-11-21T19:40:05.800Z");
    let (table, headers) = file(&server, "run/export?format=csv");
    assert_eq!(headers, ["text/csv; charset=utf-8", "attachment; filename=\"run.csv\""]);
    assert!(table.starts_with(b"sequence,time_s,utc,kind,path"));
    let (recording, headers) = file(&server, "run/export?format=mcap");
    assert_eq!(headers[1], "attachment; filename=\"run.mcap\"");
    let magic = b"\x89MCAP0\r\n";
    assert!(recording.starts_with(magic) && recording.ends_with(magic));
}

#[test]
fn a_run_is_deleted_once_it_is_over() {
    let place = tempfile::tempdir().unwrap();
    let runs = place.path().join("runs");
    write(&runs, "over", RUN).close().unwrap();
    let journal = write(&runs, "alive", RUN);
    let server = TestServer::at(place, |_settings| {});
    get(&server, "over/events");
    assert_eq!(said(&server, Role::Engineer, "DELETE", "over"), "403 not_your_right");
    assert_eq!(said(&server, Role::Admin, "DELETE", "alive"), "409 run_goes_on");
    assert_eq!(said(&server, Role::Admin, "DELETE", "over"), "200");
    assert_eq!(said(&server, Role::Admin, "DELETE", "over"), "404 no_such_run");
    assert_eq!(said(&server, Role::Viewer, "GET", "over/events"), "404 no_such_run");
    assert!(!server.runs().join("over").exists());
    assert!(server.runs().join("alive").exists());
    drop(journal);
}

#[test]
fn old_runs_are_pruned_but_the_newest_stay() {
    let place = tempfile::tempdir().unwrap();
    for number in 10..23 {
        write(&place.path().join("runs"), &number.to_string(), RUN).close().unwrap();
    }
    let server = TestServer::at(place, |_settings| {});
    let prune = |role, body| server.call(Some(role), "POST", "/api/v1/runs/prune", Some(&body));
    assert_eq!(prune(Role::Engineer, json!({"count": 1})).said(), "403 not_your_right");
    assert_eq!(prune(Role::Admin, json!({})).json(), json!([]));
    assert_eq!(prune(Role::Admin, json!({"count": -1})).said(), "400 bad_body");
    let pruned = prune(Role::Admin, json!({"count": 1})).json();
    let ids: Vec<_> = pruned.as_array().unwrap().iter().map(|run| run["id"].clone()).collect();
    assert_eq!(ids, ["10", "11", "12"]);
    let left = server.call(Some(Role::Viewer), "GET", "/api/v1/runs", None).json();
    assert_eq!(left.as_array().map(Vec::len), Some(10));
}

#[test]
fn a_damaged_journal_is_said_to_be_by_every_answer() {
    let place = tempfile::tempdir().unwrap();
    write(&place.path().join("runs"), "run", &format!("{RUN}{END}")).close().unwrap();
    let database = place.path().join("runs/run/journal.db");
    let mut bytes = std::fs::read(&database).unwrap();
    let at = bytes.windows(8).position(|part| part == b"scanning").unwrap();
    bytes[at] ^= 1;
    std::fs::write(&database, bytes).unwrap();
    let server = TestServer::at(place, |_settings| {});
    let events = get(&server, "run/events?values=true");
    let damaged = json!([{
        "sequence": 15, "t_ns": 0, "event": {
            "type": "damaged", "first": 1, "last": 15,
            "what": "journal.db: events 1 to 15 cannot be read",
        },
    }]);
    assert_eq!((&events["events"], &events["last"]), (&damaged, &json!(15)));
    let log = get(&server, "run/log");
    assert_eq!(log["lines"][0]["level"], "error");
    let refused = "422 journal_damaged";
    for path in ["moments", "moments/4", "moments?t_ms=3", "events/4", "statistics", "compare/run"]
    {
        let path = format!("run/{path}");
        assert_eq!(said(&server, Role::Viewer, "GET", &path), refused, "{path}");
    }
    let url = format!("{}/api/v1/runs/run/export?format=jsonl", server.url());
    let token = format!("Bearer {}", server.token(Role::Viewer));
    // The connection breaks: within the body, or before the head if the body is short.
    let read = match ureq::get(url).header("Authorization", token).call() {
        Ok(answer) => answer.into_body().into_reader().read_to_end(&mut Vec::new()),
        Err(ureq::Error::Io(error)) => Err(error),
        Err(other) => panic!("{other}"),
    };
    assert!(read.is_err(), "a whole answer of {read:?} bytes");
}
