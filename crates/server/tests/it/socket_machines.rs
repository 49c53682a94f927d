//! Open machines over the WebSocket: edits, revisions, presence, and lost rights.

use crate::harness::TestServer;
use crate::socket_client::Client;
use expect_test::{Expect, expect};
use rafcon_protocol::api::Role;
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use serde_json::{Value, json};

const MACHINE: &str = r#"
hierarchy ROOT "Root"
  outcome success
  start -> ONEXXX
  ONEXXX.success -> .success
  execution ONEXXX "One"
    outcome success
    script |
      def execute(self, inputs, outputs, gvm):
          return 0
"#;

/// A server with one open machine, its id and its revision.
fn open() -> (TestServer, String, u64) {
    let server = TestServer::new();
    let machine = notation::parse(MACHINE).unwrap();
    save(&machine, &server.project().join("pick"), None, Naming::default()).unwrap();
    let file = json!({ "file": { "project": "project", "path": "pick" } });
    let answer = server.call(Some(Role::Engineer), "POST", "/api/v1/machines/open", Some(&file));
    let opened = answer.json();
    let id = opened["id"].as_str().unwrap().to_owned();
    (server, id, opened["revision"].as_u64().unwrap())
}

fn rename(machine: &str, id: &str, name: &str) -> Value {
    let edit = json!({ "edit": "set_name", "path": "ROOT/ONEXXX", "name": name });
    let edit = json!({ "id": id, "name": "Rename", "edit": edit });
    json!({ "frame": "edit", "machine": machine, "edit": edit })
}

fn history(machine: &str, from: u64) -> Value {
    json!({ "topic": "machine_history", "machine": machine, "from": from })
}

/// A revision, counted from the opening of the machine.
fn count(revision: &Value, opened: u64) -> u64 {
    revision.as_u64().unwrap() - opened
}

/// The next `lines` replies, revisions and other frames, as text.
fn heard(client: &mut Client, opened: u64, lines: usize) -> String {
    let mut heard = Vec::new();
    while heard.len() < lines {
        let frame = client.hear();
        match frame["frame"].as_str().unwrap() {
            "edited" => {
                heard.push(format!("{} made {}", frame["id"], count(&frame["revision"], opened)));
            }
            "reset" => heard.push(format!("reset to {}", count(&frame["revision"], opened))),
            "refused" => {
                heard.push(format!("{} refused: {}", frame["id"], frame["refusal"]["code"]));
            }
            "revisions" => {
                for told in frame["revisions"].as_array().unwrap() {
                    let number = count(&told["revision"], opened);
                    let changes = told["changes"].as_array().unwrap().len();
                    let (author, name) = (&told["author"], &told["name"]);
                    heard.push(format!(
                        "{number} {} {author} {name}: {changes} changes",
                        told["id"]
                    ));
                }
            }
            other => heard.push(format!("{other} {}", frame["refusal"])),
        }
    }
    heard.join("\n") + "\n"
}

fn check(client: &mut Client, opened: u64, lines: usize, expect: &Expect) {
    expect.assert_eq(&heard(client, opened, lines));
}

#[test]
fn what_one_edits_the_other_is_told() {
    let (server, machine, opened) = open();
    let mut anna = Client::connect(&server, Role::Engineer);
    let mut bert = Client::connect(&server, Role::Viewer);
    bert.subscribe(1, &history(&machine, opened + 1));
    anna.say(&rename(&machine, "e1", "Scan"));
    anna.say(&rename(&machine, "e2", "Look"));
    anna.say(&json!({ "frame": "undo", "machine": machine, "undo": { "id": "u1" } }));
    anna.say(&json!({ "frame": "redo", "machine": machine, "redo": { "id": "r1" } }));
    anna.say(&rename(&machine, "e3", ""));
    check(
        &mut anna,
        opened,
        5,
        &expect![[r#"
        "e1" made 1
        "e2" made 2
        "u1" made 3
        "r1" made 4
        "e3" refused: "edit_refused"
    "#]],
    );
    check(
        &mut bert,
        opened,
        4,
        &expect![[r#"
        1 "e1" "engineer" "Rename": 1 changes
        2 "e2" "engineer" "Rename": 1 changes
        3 "u1" "engineer" "Rename": 1 changes
        4 "r1" "engineer" "Rename": 1 changes
    "#]],
    );
}

#[test]
fn edits_of_one_client_are_made_in_their_order() {
    let (server, machine, opened) = open();
    let mut client = Client::connect(&server, Role::Engineer);
    let names: Vec<String> = (1..=100).map(|number| format!("N{number}")).collect();
    for name in &names {
        client.say(&rename(&machine, name, name));
    }
    for (revision, name) in (opened + 1..).zip(&names) {
        let wanted = json!({ "frame": "edited", "id": name, "revision": revision });
        assert_eq!(client.hear(), wanted);
    }
}

#[test]
fn revisions_that_never_were_are_a_reason_to_begin_again() {
    let (server, machine, opened) = open();
    let mut client = Client::connect(&server, Role::Viewer);
    client.subscribe(1, &history(&machine, opened + 9));
    check(
        &mut client,
        opened,
        1,
        &expect![["
        reset to 0
    "]],
    );
    // The number is free again. A reply proves that all earlier frames were processed.
    client.subscribe(1, &history(&machine, opened + 1));
    client.say(&rename(&machine, "e1", "Scan"));
    check(
        &mut client,
        opened,
        1,
        &expect![[r#"
        "e1" refused: "not_your_right"
    "#]],
    );
    let close = format!("/api/v1/machines/{machine}/close");
    server.call(Some(Role::Engineer), "POST", &close, Some(&json!({ "discard": true })));
    check(
        &mut client,
        opened,
        1,
        &expect![["
        ended null
    "]],
    );
}

#[test]
fn who_looks_at_a_machine_is_told_to_others_until_they_go() {
    let (server, machine, _opened) = open();
    let mut anna = Client::connect(&server, Role::Viewer);
    anna.subscribe(1, &json!({ "topic": "machine_status", "machine": machine }));
    assert_eq!(anna.hear()["status"]["people"], json!([]));
    let mut bert = Client::connect(&server, Role::Viewer);
    bert.say(&json!({ "frame": "presence", "machine": machine, "selection": ["ROOT/ONEXXX"] }));
    let people = |frame: &Value| frame["status"]["people"].as_array().unwrap().len();
    let heard = anna.hear_until(|frame| people(frame) == 1);
    assert_eq!(heard.last().unwrap()["status"]["people"][0]["selection"], json!(["ROOT/ONEXXX"]));
    drop(bert);
    anna.hear_until(|frame| people(frame) == 0);
}

#[test]
fn who_gets_another_role_or_is_removed_is_sent_away() {
    let server = TestServer::new();
    let mut client = Client::connect(&server, Role::Operator);
    client.subscribe(1, &json!({ "topic": "server_status" }));
    client.hear();
    let role = json!({ "role": "viewer" });
    server.call(Some(Role::Admin), "PATCH", "/api/v1/users/operator", Some(&role));
    assert_eq!(client.hear()["refusal"]["code"], "other_role");
    assert_eq!(client.hear_or_end(), Err("1008 other_role".to_owned()));
    let mut client = Client::connect(&server, Role::Operator);
    server.call(Some(Role::Admin), "DELETE", "/api/v1/users/operator", None);
    assert_eq!(client.hear()["refusal"]["code"], "not_known_any_more");
}
