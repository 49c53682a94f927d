//! Usages of libraries in machines and files.

use crate::harness::TestServer;
use crate::machines::{get, open, post, write};
use rafcon_protocol::api::Role;
use rafcon_server::Settings;
use rafcon_storage::config::Naming;
use rafcon_storage::{Libraries, load, save};
use serde_json::{Value, json};
use std::path::PathBuf;

const LIBRARY: &str = "
    hierarchy GRIPPP \"Grip\"
      outcome held
      in force: float = 1.5
      out width: float
";

/// A server with the library root `skills` outside of its project, and the library `skills/arm/grip`.
pub(crate) fn with_library(library: &str) -> TestServer {
    let server = TestServer::with(use_skills);
    write_library(&server, "arm/grip", library);
    server
}

fn use_skills(settings: &mut Settings) {
    let skills = settings.projects[0].with_file_name("skills");
    std::fs::create_dir_all(&skills).unwrap();
    settings.libraries = vec![("skills".into(), skills)];
}

pub(crate) fn skills(server: &TestServer) -> PathBuf {
    server.project().with_file_name("skills")
}

pub(crate) fn write_library(server: &TestServer, path: &str, text: &str) {
    let machine = rafcon_testkit::notation::parse(text).unwrap();
    let folder = skills(server).join(path);
    save(&machine, &folder, None, Naming::default()).unwrap();
}

/// Adds the library to a machine, below `path`.
pub(crate) fn add(server: &TestServer, machine: &str, path: &str, id: &str) {
    let library = json!({ "path": "skills/arm", "name": "grip" });
    let state =
        json!({ "path": id, "name": format!("Grip {id}"), "kind": "library", "library": library });
    let edit = json!({ "edit": "add_state", "path": path, "states": [state] });
    let edit = json!({ "id": id, "name": "Add", "edit": edit });
    let answer = post(server, Role::Engineer, &format!("/{machine}/edits"), &edit);
    assert_eq!(answer.status, 200, "{answer:?}");
}

fn usages(server: &TestServer, query: &str) -> Value {
    let path = format!("/api/v1/libraries/usages?{query}");
    server.call(Some(Role::Viewer), "GET", &path, None).json()
}

#[test]
fn a_library_is_found_where_it_is_used() {
    let server = with_library(LIBRARY);
    let around = "hierarchy ROOT \"Mission\"\n  hierarchy INNERR \"Search\"\n    execution STEPPP\n      script \"library_name grip\"";
    write(&server, "saved/one", around);
    write(&server, "open", around);
    for path in ["saved/one", "open"] {
        let id = open(&server, path);
        add(&server, &id, "ROOT/INNERR", "GRIPAA");
        if path == "saved/one" {
            post(&server, Role::Engineer, &format!("/{id}/save"), &json!({}));
            post(&server, Role::Engineer, &format!("/{id}/close"), &json!({}));
        }
    }
    let saved = load(&server.project().join("saved/one"), &Libraries::default()).unwrap().machine;
    save(&saved, &skills(&server).join("user"), None, Naming::default()).unwrap();
    let found = usages(&server, "path=skills/arm&name=grip");
    let id = get(&server, "")[0]["id"].clone();
    let (path, names) = ("ROOT/INNERR/GRIPAA", json!(["Mission", "Search", "Grip GRIPAA"]));
    let file = |path: &str| json!({ "project": "project", "path": path });
    let usage = |machine: Value, file: Value, library: Value| json!({ "machine": machine, "file": file, "library": library, "path": path, "names": names });
    let in_library = json!({ "path": "skills", "name": "user" });
    let wanted = json!([
        usage(id, file("open"), Value::Null),
        usage(Value::Null, file("saved/one"), Value::Null),
        usage(Value::Null, Value::Null, in_library),
    ]);
    assert_eq!(found, json!({ "usages": wanted, "is_cut": false }));
    let none = json!({ "usages": [], "is_cut": false });
    assert_eq!(usages(&server, "path=skills/arm&name=gripper"), none);
    assert_eq!(usages(&server, "path=nowhere&name=grip"), none);
}

/// A machine gets a library with its outcomes and ports. The library's content is available with its layout.
#[test]
fn a_library_brings_its_outcomes_and_ports_along() {
    let server = with_library(
        "hierarchy GRIPPP
           outcome held
           in force: float = 1.5
           out width: float
           execution CLOSEE
             layout {\"gui\":{\"editor_gaphas\":{\"rel_pos\":[1.0,2.0]}}}",
    );
    write(&server, "one", "hierarchy ROOT");
    let id = open(&server, "one");
    add(&server, &id, "ROOT", "GRIPAA");
    let document = get(&server, &format!("/{id}/document"))["document"].clone();
    let state = document["states"].as_array().unwrap().iter();
    let state = state.into_iter().find(|state| state["path"] == "ROOT/GRIPAA").unwrap().clone();
    let names = |list: &str| {
        let list = state[list].as_array().unwrap().iter();
        list.map(|one| one["name"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names("outcomes"), ["preempted", "aborted", "held"]);
    assert_eq!(
        (names("inputs"), names("outputs")),
        (vec!["force".to_owned()], vec!["width".to_owned()])
    );
    let path = "/api/v1/libraries/skills/arm/grip";
    let answer = server.call(Some(Role::Viewer), "GET", path, None);
    let library = answer.json();
    let bearer = format!("Bearer {}", server.token(Role::Viewer));
    let tag = answer.header("etag").unwrap();
    let asked = |known: &str| {
        let head = [("Authorization", &*bearer), ("If-None-Match", known)];
        server.send("GET", path, &head, None)
    };
    let again = asked(tag);
    assert_eq!((again.status, &*again.text), (304, ""));
    assert_eq!(again.header("etag"), Some(tag));
    assert_eq!(asked(&format!("\"other\", W/{tag}")).status, 304);
    assert_eq!(asked("\"other\"").status, 200);
    let inside = &library["states"][1];
    assert_eq!(inside["path"], "GRIPPP/CLOSEE");
    assert!(!inside["layout"].is_null(), "{inside}");
}

/// The changed library: another version, a replaced input, and an additional outcome.
const CHANGED: &str = "
    hierarchy GRIPPP \"Grip\"
      outcome dropped
      outcome held
      in 7 speed: float = 1.5
      out 8 width: float
";

#[test]
fn a_library_that_changed_is_told_and_taken_over() {
    let server = with_library(LIBRARY);
    write(
        &server,
        "one",
        "hierarchy ROOT
           outcome success
           in 20 force: float = 1.5
           var 21 width: float",
    );
    let id = open(&server, "one");
    add(&server, &id, "ROOT", "GRIPAA");
    let document = || get(&server, &format!("/{id}/document"))["document"].clone();
    let library = |document: &Value| {
        let states = document["states"].as_array().unwrap().clone();
        states.into_iter().find(|state| state["path"] == "ROOT/GRIPAA").unwrap()
    };
    let state = library(&document());
    let port = |list: &str| state[list][0]["id"].clone();
    let flow = |number: i64, from: Value, to: Value| json!({ "edit": "add_data_flow", "path": "ROOT", "data_flow": number, "from": from, "to": to });
    let batch = json!({ "edit": "batch", "edits": [
        { "edit": "add_transition", "path": "ROOT", "transition": 1, "from": { "state": "GRIPAA", "outcome": 0 }, "to": { "outcome": 0 } },
        flow(1, json!({ "state": "ROOT", "port": 20 }), json!({ "state": "GRIPAA", "port": port("inputs") })),
        flow(2, json!({ "state": "GRIPAA", "port": port("outputs") }), json!({ "state": "ROOT", "port": 21 })),
    ] });
    let send = |id_of_edit: &str, edit: &Value| {
        let edit = json!({ "id": id_of_edit, "name": "x", "edit": edit });
        let answer = post(&server, Role::Engineer, &format!("/{id}/edits"), &edit);
        assert_eq!(answer.status, 200, "{answer:?}");
    };
    send("connect", &batch);
    let changed = || {
        let problems = get(&server, &format!("/{id}/problems"));
        let problems = problems.as_array().unwrap().clone();
        problems.into_iter().find(|problem| problem["rule"] == "library_changed")
    };
    assert_eq!(changed(), None);
    std::fs::remove_dir_all(skills(&server).join("arm/grip")).unwrap();
    write_library(&server, "arm/grip", CHANGED);
    let told = std::iter::from_fn(|| Some(changed())).find_map(|told| told).unwrap();
    assert_eq!(
        told["message"],
        "ROOT/GRIPAA, state: its library skills/arm/grip has changed: the outcome `dropped` is new, \
         the input `force: float` is gone, the input `speed: float` is new; take it over as it is now, \
         or leave the state as it is until the machine is read again"
    );
    send("repair", &told["repairs"][0]["edit"]);
    assert_eq!(changed(), None);
    let now = document();
    assert_eq!(library(&now)["inputs"][0]["name"], "speed");
    let root = &now["states"][0];
    assert_eq!(root["transitions"][0]["from_outcome"], 1);
    assert_eq!(root["data_flows"].as_array().unwrap().len(), 1);
    assert_eq!(root["data_flows"][0]["from_port"], 8);
}

/// A library is adopted, a jump reverts that, and the server restarts: the replay of both steps changes nothing, and later edits survive.
#[test]
fn a_library_that_changed_keeps_no_edit_from_being_made_again() {
    let server = with_library(LIBRARY);
    write(&server, "one", "hierarchy ROOT");
    let id = open(&server, "one");
    add(&server, &id, "ROOT", "GRIPAA");
    let ask = |server: &TestServer, what: &str, wish: &Value| {
        let answer = post(server, Role::Engineer, &format!("/{id}/{what}"), wish);
        assert_eq!(answer.status, 200, "{answer:?}");
    };
    ask(&server, "save", &json!({}));
    ask(&server, "close", &json!({}));
    assert_eq!(open(&server, "one"), id);
    write_library(&server, "arm/grip", CHANGED);
    let problems = || get(&server, &format!("/{id}/problems")).as_array().unwrap().clone();
    let told = std::iter::from_fn(|| Some(problems())).flatten();
    let told = told.into_iter().find(|problem| problem["rule"] == "library_changed").unwrap();
    let edit = &told["repairs"][0]["edit"];
    ask(&server, "edits", &json!({ "id": "1", "name": "Take over", "edit": edit }));
    let start = get(&server, &format!("/{id}/steps"))["start"].clone();
    ask(&server, "jump", &json!({ "id": "2", "revision": start }));
    let edit = json!({ "edit": "set_name", "path": "ROOT", "name": "Renamed" });
    ask(&server, "edits", &json!({ "id": "3", "name": "Rename", "edit": edit }));
    let server = TestServer::at(server.end(), use_skills);
    assert_eq!(open(&server, "one"), id);
    let document = get(&server, &format!("/{id}/document"))["document"].clone();
    assert_eq!(document["states"][0]["name"], "Renamed");
    let kinds = get(&server, &format!("/{id}/steps"))["steps"].clone();
    let kinds: Vec<_> = kinds.as_array().unwrap().iter().map(|step| step["kind"].clone()).collect();
    assert_eq!(kinds, ["edit", "jump", "edit"]);
}

#[test]
fn of_very_many_usages_some_are_told_and_that_there_may_be_more() {
    let server = with_library(LIBRARY);
    let machine = |uses: usize| {
        let one = |number: usize| {
            format!("  library USE{number:03} from \"skills/arm/grip\"\n    missing \"\"\n")
        };
        let libraries: String = (0..uses).map(one).collect();
        format!("hierarchy ROOT \"Mission\"\n{libraries}")
    };
    let told = || {
        let found = usages(&server, "path=skills/arm&name=grip");
        (found["usages"].as_array().unwrap().len(), found["is_cut"].as_bool().unwrap())
    };
    write(&server, "many", &machine(999));
    assert_eq!(told(), (999, false));
    // Usages in open machines come first, and count towards the limit.
    write(&server, "few", &machine(2));
    open(&server, "few");
    assert_eq!(told(), (1000, true));
    open(&server, "many");
    assert_eq!(told(), (1000, true));
}
