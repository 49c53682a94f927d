//! Checks of scripts by Python's parser.

use crate::harness::TestServer;
use rafcon_protocol::api::Role;
use serde_json::{Value, json};

fn check(server: &TestServer, script: &str, expected: &str) {
    let wish = json!({ "script": script });
    let answer = server.call(Some(Role::Engineer), "POST", "/api/v1/python/check", Some(&wish));
    assert_eq!(answer.status, 200, "{answer:?}");
    let line = |problem: &Value| {
        let place = |name: &str| problem[name].as_u64().unwrap().to_string();
        let at = ["line", "column"].map(place).join(":");
        assert_ne!(problem["message"], "");
        format!("{at} {}", problem["severity"].as_str().unwrap())
    };
    let answer = answer.json();
    let said: Vec<_> = answer.as_array().unwrap().iter().map(line).collect();
    assert_eq!(said.join(", "), expected, "{answer}");
}

#[test]
fn errors_and_warnings_are_told_with_their_place() {
    let server = TestServer::new();
    check(&server, "def execute(self, inputs, outputs, gvm):\n    return 0\n", "");
    check(&server, "x = 1\nx y\n", "2:3 error");
    check(&server, "x = '\u{1f916}é' 1", "1:11 error");
    check(&server, "x = 1\r\ny = x is 1\r\n", "2:1 warning");
    check(&server, "return 1", "1:1 error");
    check(&server, "x = \"\0\"", "1:1 error");
}

#[test]
fn nothing_of_a_script_runs() {
    let server = TestServer::new();
    let file = server.project().join("ran");
    let script = format!("import pathlib\npathlib.Path({file:?}).touch()\nraise SystemExit(3)");
    check(&server, &script, "");
    assert!(!file.exists());
}

#[test]
fn of_very_many_problems_the_first_ones_are_told() {
    let server = TestServer::new();
    let wish = json!({ "script": "1 is x\n".repeat(50_000) });
    let answer = server.call(Some(Role::Engineer), "POST", "/api/v1/python/check", Some(&wish));
    assert_eq!(answer.said(), "200");
    let problems = answer.json();
    let lines = problems.as_array().unwrap().iter().map(|problem| problem["line"].as_u64());
    assert!(lines.eq((1..=1000).map(Some)), "{problems}");
}

#[test]
fn what_cannot_be_looked_at_is_refused() {
    let ask = |server: &TestServer, script: &str| {
        let wish = json!({ "script": script });
        server.call(Some(Role::Engineer), "POST", "/api/v1/python/check", Some(&wish)).said()
    };
    assert_eq!(ask(&TestServer::new(), &"#".repeat((1 << 20) + 1)), "413 too_large");
    let server = TestServer::with(|settings| settings.python = Some("/nowhere/python".into()));
    assert_eq!(ask(&server, "x = 1"), "422 not_checked");
    let server = TestServer::with(|settings| settings.python = Some("/bin/false".into()));
    assert_eq!(ask(&server, "x = 1"), "422 not_checked");
}

#[test]
fn problems_of_a_machine_are_those_of_its_scripts_too() {
    let server = TestServer::new();
    let machine = "execution ROOT\n  outcome done\n  script |\n    def execute(self, inputs, outputs, gvm):\n        return \"nope\"";
    crate::machines::write(&server, "one", machine);
    let id = crate::machines::open(&server, "one");
    let found = crate::machines::get(&server, &format!("/{id}/problems"));
    let [problem] = &found.as_array().unwrap()[..] else { panic!("{found}") };
    assert_eq!(problem["rule"], "ScriptOutcome");
    assert_eq!((problem["line"].as_u64(), &problem["severity"]), (Some(2), &json!("error")));
    assert_eq!(problem["repairs"][0]["name"], "Add the outcome \"nope\"");
    let state = json!({ "machine": id, "path": "ROOT" });
    let check = |script: &str| {
        let body = json!({ "script": script, "state": state });
        server.call(Some(Role::Engineer), "POST", "/api/v1/python/check", Some(&body)).json()
    };
    let draft = check("def execute(self, inputs, outputs, gvm):\n    return inputs[\"x\"]");
    assert_eq!(draft[0]["repairs"][0]["name"], "Add the input \"x\"", "{draft}");
    assert_eq!(check("def execute(self, inputs, outputs, gvm):\n    return \"done\""), json!([]));
}
