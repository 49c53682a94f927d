//! The tables of rights: every role, and no user, against every route and every command.

use crate::harness::TestServer;
use expect_test::expect;
use rafcon_protocol::Command;
use rafcon_protocol::api::{Right, Role, StartRun};
use rafcon_server::access::{ROUTES, of_command, of_start};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use utoipa::PartialSchema as _;

/// Routes in the table that are not in the API description, because they are for browsers only.
const NOT_DESCRIBED: [(&str, &str); 4] =
    [("GET", "/"), ("GET", "/popout.html"), ("GET", "/icon.svg"), ("GET", "/assets/{file}")];

/// A URL of a route with ids that do not exist.
fn address(path: &str) -> String {
    let part = |part: &str| if part.starts_with('{') { "none".to_owned() } else { part.to_owned() };
    path.split('/').map(part).collect::<Vec<_>>().join("/")
}

#[test]
fn every_route_is_open_to_who_has_its_right_and_to_nobody_else() {
    let server = TestServer::new();
    let everybody = [None].into_iter().chain(Role::ALL.map(Some)).collect::<Vec<_>>();
    for (method, path, right) in ROUTES {
        let body = (method.as_str() != "GET").then(|| json!({}));
        for role in &everybody {
            let answer = server.call(*role, method.as_str(), &address(path), body.as_ref());
            let said = answer.said();
            let is_refused = ["401 not_logged_in", "403 not_your_right"].contains(&said.as_str());
            let may = *right == Right::Anyone || role.is_some_and(|role| role.grants(*right));
            assert_eq!(is_refused, !may, "{method} {path} as {role:?}: {said}");
            assert!(answer.status < 500, "{method} {path} as {role:?}: {answer:?}");
            assert_ne!(said, "404 no_such_route", "{method} {path}: a row without a route");
        }
    }
}

#[test]
fn the_table_and_the_description_have_the_same_routes() {
    let document: Value = serde_json::to_value(rafcon_server::openapi()).unwrap();
    let verbs = ["get", "post", "put", "patch", "delete"];
    let paths = document["paths"].as_object().unwrap().iter();
    let described = paths.flat_map(|(path, item)| {
        let verbs = verbs.iter().filter(|verb| item.get(**verb).is_some());
        verbs.map(move |verb| (verb.to_uppercase(), path.clone()))
    });
    let row = |(method, path): (&str, &str)| (method.to_owned(), path.replace("{*", "{"));
    let table = ROUTES.iter().map(|row| (row.0.as_str(), row.1));
    let table = table.filter(|route| !NOT_DESCRIBED.contains(route)).map(row);
    let (described, table) = (described.collect::<BTreeSet<_>>(), table.collect::<BTreeSet<_>>());
    let missing = |these: &BTreeSet<_>, those: &BTreeSet<_>| -> Vec<(String, String)> {
        these.difference(those).cloned().collect()
    };
    assert_eq!(missing(&described, &table), [], "routes without a row in the table of rights");
    assert_eq!(missing(&table, &described), [], "rows without a route");
}

/// One command of each kind, and variants whose right depends on their content.
fn commands() -> Vec<(String, Command)> {
    let fields = json!({
        "path": "A", "outcome": 0, "id": 1, "question": 1, "value": 0, "sequence": 1, "script": "",
        "policy": "abort",
    });
    let plain = json!({"id": 1, "path": "A"});
    let conditional = json!({"id": 1, "path": "A", "condition": "True"});
    let mut all = Vec::new();
    for tag in tags() {
        let mut words = fields.clone();
        words["type"] = json!(tag);
        words["breakpoint"] = plain.clone();
        all.push((tag.clone(), serde_json::from_value(words.clone()).unwrap()));
        if tag == "set_breakpoint" {
            words["breakpoint"] = conditional.clone();
            let name = format!("{tag} with a condition");
            all.push((name, serde_json::from_value(words).unwrap()));
        }
    }
    all
}

#[test]
fn a_command_knows_the_name_of_its_type() {
    for (name, command) in commands() {
        assert_eq!(json!(command)["type"], command.type_name(), "{name}");
    }
}

/// The names of all commands, from their schema.
fn tags() -> Vec<String> {
    let schema = serde_json::to_value(Command::schema()).unwrap();
    let kinds = schema["oneOf"].as_array().unwrap().iter();
    let tag = |kind: &Value| kind["properties"]["type"]["enum"][0].as_str().unwrap().to_owned();
    kinds.map(tag).collect()
}

fn table() -> String {
    let head =
        "| command | viewer | operator | engineer | admin |\n| --- | --- | --- | --- | --- |\n";
    let word = |role: Role, right| if role.grants(right) { "yes" } else { "no" };
    let row = |(name, right): (String, Right)| {
        let words = Role::ALL.map(|role| word(role, right)).join(" | ");
        format!("| {name} | {words} |\n")
    };
    let commands = commands().into_iter().map(|(name, command)| (name, of_command(&command)));
    head.to_owned() + &starts().into_iter().chain(commands).map(row).collect::<String>()
}

/// Starts of a run whose right depends on their content.
fn starts() -> [(String, Right); 2] {
    let right = |points| of_start(&serde_json::from_value::<StartRun>(start(&points)).unwrap());
    let (plain, conditional) = (json!([]), json!([{"id": 1, "path": "A", "condition": "True"}]));
    [
        ("a new run".to_owned(), right(plain)),
        ("a new run, a breakpoint with a condition".to_owned(), right(conditional)),
    ]
}

fn start(breakpoints: &Value) -> Value {
    json!({"id": "1", "machine": {"project": "none", "path": "none"}, "breakpoints": breakpoints})
}

#[test]
fn who_may_not_edit_starts_no_run_with_python_text_in_it() {
    let server = TestServer::new();
    let begin = |role, points: Value| {
        server.call(Some(role), "POST", "/api/v1/runs", Some(&start(&points))).said()
    };
    let conditional = json!([{"id": 1, "path": "A", "condition": "True"}]);
    assert_eq!(begin(Role::Operator, json!([])), "404 no_such_project");
    assert_eq!(begin(Role::Operator, conditional.clone()), "403 not_your_right");
    assert_eq!(begin(Role::Engineer, conditional), "404 no_such_project");
}

#[test]
fn every_command_is_for_who_may_and_the_handbook_says_so() {
    expect![[r"
        | command | viewer | operator | engineer | admin |
        | --- | --- | --- | --- | --- |
        | a new run | no | yes | yes | yes |
        | a new run, a breakpoint with a condition | no | no | yes | yes |
        | start | no | yes | yes | yes |
        | pause | no | yes | yes | yes |
        | resume | no | yes | yes | yes |
        | stop | no | yes | yes | yes |
        | kill | no | yes | yes | yes |
        | step_mode | no | yes | yes | yes |
        | step_into | no | yes | yes | yes |
        | step_over | no | yes | yes | yes |
        | step_out | no | yes | yes | yes |
        | step_back | no | yes | yes | yes |
        | run_to | no | yes | yes | yes |
        | run_selected | no | yes | yes | yes |
        | run_only_selected | no | yes | yes | yes |
        | start_from_history | no | yes | yes | yes |
        | force_outcome | no | yes | yes | yes |
        | preempt | no | yes | yes | yes |
        | set_breakpoint | no | yes | yes | yes |
        | set_breakpoint with a condition | no | no | yes | yes |
        | remove_breakpoint | no | yes | yes | yes |
        | answer_question | no | yes | yes | yes |
        | recover | no | yes | yes | yes |
        | reload | no | no | yes | yes |
        | edit_script | no | no | yes | yes |
        | control | no | yes | yes | yes |
    "]]
    .assert_eq(&table());
    let handbook = include_str!("../../../../docs/operations.md");
    assert!(handbook.contains(&table()), "docs/operations.md has another table of commands");
}
