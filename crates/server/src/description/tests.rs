//! The description is complete: it contains every route with its rights, and all examples are valid.

use super::*;
use crate::access::ROUTES;
use rafcon_protocol::{Envelope, api};
use serde::de::DeserializeOwned;
use std::collections::BTreeSet;

fn described() -> OpenApi {
    crate::openapi()
}

#[test]
fn every_route_with_a_right_is_described_and_no_other() {
    let mut paths = described().paths.paths;
    let described = paths.iter_mut().flat_map(|(path, item)| {
        operations(item).map(|(method, _operation)| format!("{method} {path}")).collect::<Vec<_>>()
    });
    let rows = ROUTES
        .iter()
        .filter(|row| row.1.starts_with("/api/"))
        .map(|(method, path, _)| format!("{method} {}", path.replace("{*", "{")));
    assert_eq!(described.collect::<BTreeSet<_>>(), rows.collect::<BTreeSet<_>>());
}

#[test]
fn every_word_that_is_named_is_described() {
    let api = serde_json::to_value(described()).unwrap();
    let mut open = vec![&api];
    let mut missing = BTreeSet::new();
    while let Some(value) = open.pop() {
        let named =
            value.get("$ref").and_then(Value::as_str).and_then(|name| name.strip_prefix('#'));
        missing.extend(named.filter(|name| api.pointer(name).is_none()));
        match value {
            Value::Array(items) => open.extend(items),
            Value::Object(members) => open.extend(members.values()),
            _other => {}
        }
    }
    assert_eq!(missing, BTreeSet::new());
}

#[test]
fn the_limits_of_texts_are_described() {
    let api = serde_json::to_value(described()).unwrap();
    let limits = |schema: &str, member: &str| {
        let member = &api["components"]["schemas"][schema]["properties"][member];
        ["minLength", "maxLength", "pattern"].map(|limit| member[limit].clone())
    };
    // In a reply, the user's name precedes the id.
    assert_eq!(limits("Envelope", "id"), [json!(1), json!(193), Value::Null]);
    for schema in ["StartRun", "ResumeRun", "EditMachine", "Undo", "ReloadMachine"] {
        assert_eq!(limits(schema, "id"), [json!(1), json!(128), Value::Null], "{schema}");
    }
    let password = [json!(10), json!(1024), Value::Null];
    for (schema, member) in
        [("NewUser", "password"), ("ChangeUser", "password"), ("ChangePassword", "new_password")]
    {
        assert_eq!(limits(schema, member), password, "{schema}");
    }
    assert_eq!(limits("Login", "password")[1], 1024);
    assert_eq!(limits("NewUser", "name")[2], "^[A-Za-z0-9._-]{1,64}$");
    assert_eq!(limits("NewToken", "name"), [json!(1), json!(100), Value::Null]);
}

#[test]
fn every_route_has_a_tag_a_summary_and_refusals_with_a_reason() {
    let mut api = described();
    for (path, item) in &mut api.paths.paths {
        for (method, operation) in operations(item) {
            assert!(operation.tags.is_some() && operation.summary.is_some(), "{method} {path}");
            for (status, response) in &operation.responses.responses {
                let RefOr::T(response) = response else { continue };
                let is_said = !response.description.is_empty();
                let is_reasoned =
                    !status.starts_with('4') || response.content.contains_key("application/json");
                assert!(is_said && is_reasoned, "{method} {path} {status}");
            }
        }
    }
}

#[test]
fn examples_are_what_they_should_be() {
    fn read<T: DeserializeOwned>(value: &Value) -> Option<String> {
        serde_json::from_value::<T>(value.clone()).err().map(|error| error.to_string())
    }
    for (name, example) in examples() {
        let wrong = match name {
            "Login" => read::<api::Login>(&example),
            "NewToken" => read::<api::NewToken>(&example),
            "MachineAt" => read::<api::MachineAt>(&example),
            "NewMachine" => read::<api::NewMachine>(&example),
            "EditMachine" => read::<api::EditMachine>(&example),
            "Undo" => read::<api::Undo>(&example),
            "StartRun" => read::<api::StartRun>(&example),
            "Envelope" => read::<Envelope>(&example),
            "ControlMove" => read::<api::ControlMove>(&example),
            "Retention" => read::<api::Retention>(&example),
            _other => Some("nobody knows its type".to_owned()),
        };
        assert_eq!(wrong, None, "{name}");
    }
}
