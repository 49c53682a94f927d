//! The command list of a robot: access, replacement, release and refusals.

use crate::contacts::station;
use crate::harness::{Answer, TestServer};
use expect_test::{Expect, expect};
use rafcon_protocol::api::Role;
use serde_json::{Value, json};

const ROUTE: &str = "/api/v1/robots/scout/commands";

fn pause(run: &str) -> Value {
    json!({ "run": run, "command": { "type": "pause" } })
}

fn call(server: &TestServer, role: Role, method: &str, body: Option<&Value>) -> Answer {
    server.call(Some(role), method, ROUTE, body)
}

fn release(server: &TestServer, role: Role, revision: &str) -> Answer {
    let path = format!("{ROUTE}/release");
    server.call(Some(role), "POST", &path, Some(&json!({ "revision": revision })))
}

fn check(answer: &Answer, expect: &Expect) {
    let message = answer.json()["message"].as_str().unwrap().to_owned();
    expect.assert_eq(&format!("{}: {message}", answer.said()));
}

#[test]
fn operators_set_and_release_a_list_and_viewers_read_it() {
    let server = station(false);
    let list = json!([pause("a"), pause("b")]);
    let set = call(&server, Role::Operator, "PUT", Some(&list));
    assert_eq!((set.status, &set.json()["revision"]), (200, &json!("2")));
    for answer in
        [call(&server, Role::Viewer, "PUT", Some(&json!([]))), release(&server, Role::Viewer, "2")]
    {
        assert_eq!(answer.said(), "403 not_your_right");
    }
    check(
        &release(&server, Role::Operator, "1"),
        &expect![
            "409 command_list_changed: robot scout: the list was changed since it was reviewed: nothing was sent; review it again"
        ],
    );
    // Another user has replaced it meanwhile.
    let path = "/api/v1/robots/scout/commands?revision=1";
    check(
        &server.call(Some(Role::Operator), "PUT", path, Some(&json!([]))),
        &expect!["409 command_list_changed: robot scout: it was changed"],
    );
    assert!(call(&server, Role::Viewer, "GET", None).json()["released"].is_null());
    let released = release(&server, Role::Operator, "2");
    assert_eq!(released.status, 200);
    let list = call(&server, Role::Viewer, "GET", None).json();
    assert_eq!(list["lines"][1]["listed"], pause("b"));
    assert_eq!(list["released"], released.json()["released"]);
    // No reply to these commands exists, so their fate is unknown.
    assert_eq!(list["lines"][0]["fate"]["answer"]["answer"], "unknown");
}

#[test]
fn a_command_that_the_user_may_not_give_is_a_fault() {
    let server = station(false);
    let script = json!({ "type": "edit_script", "path": "R/A", "script": "" });
    let list = json!([pause("a"), { "run": "a", "command": script }]);
    assert_eq!(call(&server, Role::Operator, "PUT", Some(&list)).status, 200);
    check(
        &release(&server, Role::Operator, "2"),
        &expect![
            "409 command_list_faulty: robot scout: operator is operator here, and this needs the right to edit: ask an admin for another role"
        ],
    );
    // Viewers get no faults of their own rights.
    let shown = call(&server, Role::Viewer, "GET", None).json();
    assert!(shown["lines"][1]["fault"].is_null());
    assert_eq!(release(&server, Role::Engineer, "2").status, 200);
}

#[test]
fn what_is_no_list_changes_nothing() {
    let server = station(false);
    assert_eq!(call(&server, Role::Operator, "PUT", Some(&json!([pause("a")]))).status, 200);
    let set = |body: &Value| call(&server, Role::Operator, "PUT", Some(body));
    check(
        &set(&json!([pause("a"), { "run": "b" }])),
        &expect![
            "400 bad_command_list: line 2: missing field `command`; a line has run, command and, if you like, not_before and expiry"
        ],
    );
    check(
        &set(&Value::Array(vec![pause("a"); 101])),
        &expect![
            "400 bad_command_list: the list has 101 commands and the limit is 100: remove some of them"
        ],
    );
    assert_eq!(call(&server, Role::Viewer, "GET", None).json()["revision"], "1");
    let path = "/api/v1/robots/mule/commands";
    let mule = server.call(Some(Role::Operator), "PUT", path, Some(&json!([])));
    assert_eq!(mule.said(), "404 no_such_robot");
    let no_station = call(&TestServer::new(), Role::Viewer, "GET", None);
    assert_eq!(no_station.said(), "404 no_such_robot");
    let full = call(&station(true), Role::Operator, "PUT", Some(&json!([])));
    assert_eq!(full.said(), "503 command_list_unavailable");
}
