//! Plans over HTTP. A shell script replaces the default engine.

use crate::harness::TestServer;
use crate::raw::Raw;
use rafcon_protocol::api::Role;
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use serde_json::{Value, json};
use std::fs::{self, File};
use std::io::Read as _;
use std::os::unix::fs::PermissionsExt as _;
use std::process::Command;
use std::thread;

const GO: &str = r#"
execution GOGOGO "Go"
  outcome success
  in to: str
  script "def execute(self, inputs, outputs, gvm):\n    return 0"
  semantic {"RAFCONTPP": {"PDDL_ACTION": {"pddl_action": "(:action go :parameters (?from ?to - place) :precondition (at ?from) :effect (and (not (at ?from)) (at ?to)))", "pddl_predicates": "", "pddl_types": "", "requirements": [], "description": "Goes."}}}
"#;
const PLAN: &str = r#"echo '{"temporal":false,"cost":1,"steps":[{"action":"(go a b)"}]}'"#;

fn server(folder: &tempfile::TempDir, engine: &str) -> TestServer {
    let pool = folder.path().join("pool");
    save(&notation::parse(GO).unwrap(), &pool.join("go"), None, Naming::default()).unwrap();
    let program = folder.path().join("kairos");
    fs::write(&program, format!("#!/bin/sh\ncd {}\n{engine}\n", folder.path().display())).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    TestServer::with(|settings| {
        settings.libraries.push(("pool".to_owned(), pool));
        settings.python = Some(folder.path().join("python3"));
    })
}

fn request() -> Value {
    let facts =
        "(define (problem walk) (:domain d) (:objects a b - place) (:init (at a)) (:goal (at b)))";
    json!({ "pool": { "libraries": ["pool"] }, "facts": facts })
}

#[test]
fn a_plan_is_told_with_its_machine() {
    let folder = tempfile::tempdir().unwrap();
    let server = server(&folder, PLAN);
    let answer = server.call(Some(Role::Engineer), "POST", "/api/v1/plans", Some(&request()));
    assert_eq!(answer.header("content-type"), Some("application/jsonl"));
    let events: Vec<Value> =
        answer.text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let [found, done] = &events[..] else { panic!("{answer:?}") };
    assert_eq!((&found["event"], &done["event"]), (&json!("found"), &json!("done")));
    assert_eq!(found["steps"][0]["title"], "Go a b");
    let [root, step] = &found["machine"]["states"].as_array().unwrap()[..] else {
        panic!("{found}")
    };
    assert_eq!((&root["kind"], &step["kind"]), (&json!("hierarchy"), &json!("library")));
    assert_eq!(found["steps"][0]["path"], step["path"]);
    let refused = server.call(Some(Role::Viewer), "POST", "/api/v1/plans", Some(&request()));
    assert_eq!(refused.status, 403);
}

#[test]
fn a_packed_answer_has_an_end() {
    let folder = tempfile::tempdir().unwrap();
    let server = server(&folder, PLAN);
    let body = request().to_string();
    let mut browser = Raw::to(&server);
    browser.say(format!(
        "POST /api/v1/plans HTTP/1.1\r\nHost: {}\r\nAuthorization: Bearer {}\r\nContent-Type: application/json\r\n\
         Accept-Encoding: gzip\r\nConnection: close\r\nContent-Length: {}\r\n\r\n{body}",
        server.address(),
        server.token(Role::Engineer),
        body.len()
    ));
    assert!(browser.rest().ends_with("\r\n0\r\n\r\n"));
}

#[test]
fn skills_add_up_to_a_domain() {
    let folder = tempfile::tempdir().unwrap();
    let server = server(&folder, PLAN);
    let pool = json!({ "libraries": ["pool"] });
    let domain =
        server.call(Some(Role::Viewer), "POST", "/api/v1/plans/domain", Some(&pool)).json();
    assert_eq!(
        domain["skills"][0]["parameters"][1],
        json!({ "name": "to", "types": ["place"], "port": "to" })
    );
    assert_eq!(domain["predicates"][0]["name"], "at");
    let pool = json!({ "libraries": ["nowhere"] });
    let domain =
        server.call(Some(Role::Viewer), "POST", "/api/v1/plans/domain", Some(&pool)).json();
    assert_eq!(domain["findings"][0]["is_error"], true);
}

#[test]
fn an_engine_ends_when_its_client_goes_away() {
    let folder = tempfile::tempdir().unwrap();
    let server = server(&folder, "exec 3>alive; exec tail -f /dev/null");
    let alive = folder.path().join("alive");
    assert!(Command::new("mkfifo").arg(&alive).status().unwrap().success());
    let body = request().to_string();
    let mut client = Raw::to(&server);
    client.say(format!(
        "POST /api/v1/plans HTTP/1.1\r\nHost: {}\r\nAuthorization: Bearer {}\r\nContent-Type: application/json\r\n\
         Content-Length: {}\r\n\r\n{body}",
        server.address(),
        server.token(Role::Engineer),
        body.len()
    ));
    assert!(client.head().starts_with("HTTP/1.1 200"));
    // The engine runs once its pipe can be opened, and has ended when the pipe is closed.
    let mut engine = File::open(&alive).unwrap();
    let ended = thread::scope(|scope| {
        let ended = scope.spawn(move || engine.read_to_end(&mut Vec::new()));
        drop(client);
        ended.join().unwrap()
    });
    assert_eq!(ended.unwrap(), 0);
}
