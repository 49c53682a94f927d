//! Subscriptions to runs over the WebSocket, and replies to arbitrary frames.

use crate::harness::TestServer;
use crate::socket_client::{Client, history};
use crate::socket_runs::{self, PER_ROUND};
use expect_test::{Expect, expect};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use rafcon_protocol::api::Role;
use serde_json::{Value, json};
use std::thread;
use tungstenite::Message;

/// A server with a run `r` of this many rounds.
fn server(rounds: usize) -> TestServer {
    let place = tempfile::tempdir().unwrap();
    socket_runs::make(&place.path().join("runs"), "r", rounds);
    TestServer::at(place, |_settings| {})
}

#[test]
fn a_history_is_told_whole_from_every_cursor() {
    let server = server(3);
    let mut client = Client::connect(&server, Role::Viewer);
    let last = 3 + 3 * PER_ROUND as u64;
    for from in 0..last + 3 {
        for values in [true, false] {
            client.subscribe(7, &history("r", from, values));
            let wanted = socket_runs::history(&server.runs(), "r", from, values);
            assert_eq!(client.events(), wanted, "from {from}");
        }
    }
}

#[test]
fn a_reader_that_breaks_off_again_and_again_loses_nothing() {
    let server = server(2000);
    let (mut told, mut next) = (Vec::new(), 0);
    loop {
        let mut client = Client::connect(&server, Role::Viewer);
        client.subscribe(1, &history("r", next, true));
        let frame = client.hear();
        let events = frame["events"].as_array().unwrap().clone();
        if events.is_empty() {
            break;
        }
        told.extend(events);
        next = frame["next"].as_u64().unwrap();
    }
    assert_eq!(told, socket_runs::history(&server.runs(), "r", 1, true));
}

#[test]
fn a_client_that_keeps_little_is_told_the_newest_and_what_was_active() {
    let server = server(3);
    let mut client = Client::connect(&server, Role::Viewer);
    let last = 3 + 3 * PER_ROUND as u64;
    for (from, most, newest) in [(1, last, 1), (1, last - 1, 4), (3, 5, 9), (last + 1, 1, 1)] {
        let topic = json!({ "topic": "run_newest", "run": "r", "from": from, "most": most, "newest": newest });
        client.subscribe(7, &topic);
        let frames = client.hear_until(|frame| frame["frame"] == "ended");
        let skipped = frames.iter().find(|frame| frame["frame"] == "skipped");
        let next = skipped.map_or(from, |it| it["before"]["sequence"].as_u64().unwrap() + 1);
        let is_much = (last + 1).saturating_sub(from) > most;
        assert_eq!(next, if is_much { last + 1 - newest.min(most) } else { from });
        if let Some(skipped) = skipped {
            assert_eq!(skipped["before"]["active"][0]["path"], "R", "{skipped}");
        }
        let told = frames.iter().filter(|frame| frame["frame"] == "events");
        let told: Vec<_> =
            told.flat_map(|frame| frame["events"].as_array().unwrap().clone()).collect();
        assert_eq!(told, socket_runs::history(&server.runs(), "r", next, false));
    }
}

#[test]
fn once_all_is_told_the_reader_knows() {
    let server = server(1);
    let mut client = Client::connect(&server, Role::Viewer);
    client.subscribe(3, &history("r", 7, false));
    expect![[r#"
        {"events":[{"event":{"globals":{},"outcome":{"id":0,"name":"done"},"outputs":{},"scoped_variables":{},"states_run":1,"type":"finished"},"sequence":7,"t_ns":4000000}],"frame":"events","next":8,"subscription":3}
        {"events":[],"frame":"events","next":8,"subscription":3}
        {"frame":"ended","refusal":null,"subscription":3}"#]].assert_eq(&frames(&client.hear_until(|frame| frame["frame"] == "ended")));
}

/// Frames as text, one per line.
fn frames(frames: &[Value]) -> String {
    let lines: Vec<String> = frames.iter().map(Value::to_string).collect();
    lines.join("\n")
}

/// Counts the events in the rest of a history, and checks their numbers.
fn count(client: &mut Client, mut wait: impl FnMut()) -> usize {
    let (mut count, mut next) = (0, 1);
    loop {
        let frame = client.hear();
        if frame["frame"] == "ended" {
            return count;
        }
        for event in frame["events"].as_array().unwrap() {
            assert_eq!(event["sequence"], next);
            next += 1;
            count += 1;
        }
        wait();
    }
}

#[test]
fn readers_wait_neither_for_a_slow_one_nor_for_one_that_never_reads() {
    const ROUNDS: usize = 1500;
    let server = server(ROUNDS);
    let follow = || {
        let mut client = Client::connect(&server, Role::Viewer);
        client.subscribe(1, &history("r", 1, true));
        client
    };
    let (_never, mut slow) = (follow(), follow());
    let all = ROUNDS * PER_ROUND + 3;
    thread::scope(|scope| {
        let readers: Vec<_> =
            (0..18).map(|_| scope.spawn(|| count(&mut follow(), || {}))).collect();
        for reader in readers {
            assert_eq!(reader.join().unwrap(), all);
        }
    });
    assert_eq!(count(&mut slow, thread::yield_now), all);
}

/// Resident memory of this process, in bytes.
fn resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches(" kB").parse::<u64>().unwrap() << 10
}

#[test]
fn clients_that_never_read_cost_little() {
    const CLIENTS: u64 = 50;
    let server = server(1000);
    let mut reader = Client::connect(&server, Role::Viewer);
    let before = resident();
    let never: Vec<Client> = (0..CLIENTS)
        .map(|_| {
            let mut client = Client::connect(&server, Role::Viewer);
            (0..8).for_each(|number| client.subscribe(number, &history("r", 1, true)));
            client
        })
        .collect();
    reader.subscribe(1, &history("r", 1, true));
    count(&mut reader, || {});
    let grown = resident().saturating_sub(before);
    assert!(grown < CLIENTS << 20, "{} KiB for each client", (grown / CLIENTS) >> 10);
    drop(never);
}

/// Replies to these frames, one per line.
fn answers(frames: &[&str]) -> String {
    let server = server(1);
    let mut client = Client::connect(&server, Role::Admin);
    for frame in frames {
        client.say_message(Message::text((*frame).to_owned()));
    }
    // Frames of several subscriptions arrive in any order.
    let mut answers: Vec<String> = frames.iter().map(|_| format!("{}\n", client.hear())).collect();
    answers.sort();
    answers.concat()
}

fn check(frames: &[&str], expect: &Expect) {
    expect.assert_eq(&answers(frames));
}

#[test]
fn what_cannot_be_followed_is_ended_with_the_reason() {
    check(
        &[
            r#"{"frame":"subscribe","subscription":1,"topic":{"topic":"run_history","run":"../r"}}"#,
            r#"{"frame":"subscribe","subscription":2,"topic":{"topic":"run_status","run":"none"}}"#,
            r#"{"frame":"subscribe","subscription":3,"topic":{"topic":"machine_status","machine":"m"}}"#,
            r#"{"frame":"subscribe","subscription":4,"topic":{"topic":"machine_history","machine":"m","from":1}}"#,
            r#"{"frame":"unsubscribe","subscription":5}"#,
        ],
        &expect![[r#"
            {"frame":"ended","refusal":null,"subscription":5}
            {"frame":"ended","refusal":{"code":"no_such_machine","message":"no machine `m` is open: POST /api/v1/machines/open opens one"},"subscription":3}
            {"frame":"ended","refusal":{"code":"no_such_machine","message":"no machine `m` is open: POST /api/v1/machines/open opens one"},"subscription":4}
            {"frame":"ended","refusal":{"code":"no_such_run","message":"the id of a run begins with `-` or `.`, or has a `/`"},"subscription":1}
            {"frame":"ended","refusal":{"code":"no_such_run","message":"there is no run `none`: GET /api/v1/runs lists them"},"subscription":2}
        "#]],
    );
}

#[test]
fn who_watches_too_much_is_told_so() {
    let server = server(1);
    let mut client = Client::connect(&server, Role::Viewer);
    let mut watch = |count: usize| {
        let target = json!({ "kind": "input", "path": "R/A", "name": "a", "priority": 0 });
        let topic = json!({ "topic": "run_watched", "run": "r", "targets": vec![target; count] });
        client.subscribe(1, &topic);
        let frame = client.hear();
        frame["refusal"]["code"]
            .as_str()
            .unwrap_or_else(|| frame["frame"].as_str().unwrap())
            .to_owned()
    };
    assert_eq!(watch(1_025), "too_many_watched");
    assert_eq!(watch(1_024), "run_watched");
}

#[test]
fn commands_and_edits_that_nobody_can_carry_out_are_refused() {
    check(
        &[
            r#"{"frame":"command","run":"none","envelope":{"id":"c1","command":{"type":"pause"}}}"#,
            r#"{"frame":"command","run":"r","envelope":{"id":"c2","command":{"type":"pause"}}}"#,
            r#"{"frame":"undo","machine":"m","undo":{"id":"u1"}}"#,
        ],
        &expect![[r#"
            {"frame":"refused","id":"c1","refusal":{"code":"no_such_run","message":"there is no run `none`: GET /api/v1/runs lists them"}}
            {"frame":"refused","id":"c2","refusal":{"code":"run_is_not_live","message":"the run has ended: see its history"}}
            {"frame":"refused","id":"u1","refusal":{"code":"no_such_machine","message":"no machine `m` is open: POST /api/v1/machines/open opens one"}}
        "#]],
    );
}

#[test]
fn a_frame_is_text_and_not_too_large() {
    let server = server(1);
    let mut client = Client::connect(&server, Role::Viewer);
    client.say_message(Message::binary(vec![1, 2, 3]));
    assert_eq!(client.hear()["refusal"]["code"], "binary_frame");
    client.say_message(Message::text("x".repeat((1 << 20) + 1)));
    assert_eq!(client.hear()["refusal"]["code"], "unreadable");
    assert_eq!(client.hear_or_end(), Err("1008 unreadable".to_owned()));
}

#[test]
fn the_server_is_told_at_once_and_when_a_run_appears() {
    let server = server(1);
    let mut client = Client::connect(&server, Role::Viewer);
    client.subscribe(1, &json!({ "topic": "server_status" }));
    assert_eq!(client.hear()["status"]["runs"], json!([]));
    let elsewhere = tempfile::tempdir_in(server.state()).unwrap();
    socket_runs::make(elsewhere.path(), "s", 1);
    std::fs::rename(elsewhere.path().join("s"), server.runs().join("s")).unwrap();
    let heard = client.hear_until(|frame| frame["status"]["runs"][0]["phase"] == "finished");
    assert_eq!(heard.last().unwrap()["status"]["runs"][0]["id"], "s");
}

#[test]
fn a_run_without_a_history_is_ended_with_the_reason() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("runs").join("r");
    socket_runs::make(&place.path().join("runs"), "r", 1);
    std::fs::write(folder.join("journal.db"), "no database").unwrap();
    let server = TestServer::at(place, |_settings| {});
    let mut client = Client::connect(&server, Role::Viewer);
    client.subscribe(1, &history("r", 1, true));
    let heard = client.hear_until(|frame| frame["frame"] == "ended");
    assert_eq!(heard.last().unwrap()["refusal"]["code"], "no_history");
}

#[test]
fn a_server_that_ends_says_so() {
    let server = server(1);
    let mut client = Client::connect(&server, Role::Viewer);
    let _place = server.end();
    assert_eq!(client.hear()["refusal"]["code"], "server_ends");
    assert_eq!(client.hear_or_end(), Err("1001 server_ends".to_owned()));
}

/// Texts that resemble frames, and others that do not.
fn anything() -> impl Strategy<Value = String> {
    let word = prop::sample::select(vec![
        r#""frame":"subscribe""#,
        r#""frame":"unsubscribe""#,
        r#""frame":"command""#,
        r#""frame":"edit""#,
        r#""frame":"presence""#,
        r#""subscription":3"#,
        r#""subscription":-1"#,
        r#""topic":{"topic":"run_history","run":"r","from":18446744073709551615}"#,
        r#""topic":{"topic":"run_status","run":"r"}"#,
        r#""topic":{"topic":"server_status"}"#,
        r#""run":"r""#,
        r#""envelope":{"id":"","command":{"type":"stop"}}"#,
        r#""envelope":{"id":"1","command":{"type":"kill"}}"#,
        r#""machine":"../..""#,
        r#""edit":{"id":"1","name":"","edit":[[[]]]}"#,
        r#""selection":["","/"]"#,
        "\u{0}",
        "{",
    ]);
    let words = prop::collection::vec(word, 0..5);
    prop_oneof![words.prop_map(|words| format!("{{{}}}", words.join(","))), any::<String>()]
}

#[test]
fn whatever_is_said_the_connection_stays_and_answers() {
    let server = server(1);
    let config = Config { cases: 200, failure_persistence: None, ..Config::default() };
    let said = prop::collection::vec(anything(), 1..8);
    TestRunner::new(config)
        .run(&said, |frames| {
            let mut client = Client::connect(&server, Role::Admin);
            for frame in frames {
                client.say_message(Message::text(frame));
            }
            client.say(&json!({ "frame": "ping", "id": 99 }));
            let heard = client.hear_until(|frame| frame["frame"] == "pong");
            prop_assert_eq!(&heard.last().unwrap()["id"], 99);
            Ok(())
        })
        .unwrap();
}
