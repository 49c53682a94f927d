//! Open machines over HTTP: edited by two users, saved, reloaded, closed, and recovered by the next server.

use crate::harness::{Answer, TestServer};
use crate::socket_client::Client;
use expect_test::{Expect, expect};
use rafcon_protocol::api::Role;
use rafcon_storage::config::Naming;
use rafcon_storage::{Libraries, load, save};
use rafcon_testkit::notation;
use serde_json::{Value, json};
use std::path::Path;

pub(crate) const MACHINE: &str = "
    hierarchy ROOT
      outcome success
      start -> AAAAAA
      AAAAAA.success -> .success
      execution AAAAAA
        outcome success
        script \"x = 1\"
      execution BBBBBB
        outcome success
";

/// Writes a machine in the notation to a folder of the project.
pub(crate) fn write(server: &TestServer, path: &str, text: &str) {
    let machine = notation::parse(text).unwrap();
    save(&machine, &server.project().join(path), None, Naming::default()).unwrap();
}

/// The machine in a folder, in the notation.
fn read(folder: &Path) -> String {
    notation::print(&load(folder, &Libraries::default()).unwrap().machine)
}

fn file(path: &str) -> Value {
    json!({ "file": { "project": "project", "path": path } })
}

pub(crate) fn post(server: &TestServer, role: Role, path: &str, body: &Value) -> Answer {
    server.call(Some(role), "POST", &format!("/api/v1/machines{path}"), Some(body))
}

pub(crate) fn get(server: &TestServer, path: &str) -> Value {
    server.call(Some(Role::Viewer), "GET", &format!("/api/v1/machines{path}"), None).json()
}

/// Opens a machine and returns its id.
pub(crate) fn open(server: &TestServer, path: &str) -> String {
    let opened = post(server, Role::Viewer, "/open", &file(path));
    opened.json()["id"].as_str().unwrap_or_else(|| panic!("{opened:?}")).to_owned()
}

/// Renames a state.
fn rename(server: &TestServer, role: Role, machine: &str, id: &str, name: &str) -> String {
    let edit = json!({ "edit": "set_name", "path": "ROOT/AAAAAA", "name": name });
    let edit = json!({ "id": id, "name": format!("Rename to {name}"), "edit": edit });
    deed(server, role, machine, "edits", &edit)
}

fn deed(server: &TestServer, role: Role, machine: &str, deed: &str, body: &Value) -> String {
    let answer = post(server, role, &format!("/{machine}/{deed}"), body);
    format!("{deed}: {}\n", answer.said())
}

/// The status of an open machine. Revisions are counted from its opening.
fn stands(server: &TestServer, machine: &str, first: u64) -> String {
    let status = get(server, &format!("/{machine}"));
    let summary = &status["summary"];
    let step = |name: &str| summary[name].as_u64().unwrap().saturating_sub(first);
    let flag = |name: &'static str| {
        if summary[name] == true { name.trim_start_matches("is_") } else { "" }
    };
    let name =
        get(server, &format!("/{machine}/document"))["document"]["states"][1]["name"].clone();
    let (now, saved) = (step("revision"), step("saved_revision"));
    let (changed, recovered) = (flag("is_changed"), flag("is_recovered"));
    let line = format!("{now} saved {saved} disk {} {changed} {recovered}", summary["disk"]);
    format!("  {name} {}\n", line.trim_end())
}

fn revision(server: &TestServer, machine: &str) -> u64 {
    get(server, &format!("/{machine}"))["summary"]["revision"].as_u64().unwrap()
}

#[test]
fn a_machine_is_opened_edited_saved_and_closed() {
    let server = TestServer::new();
    write(&server, "one", MACHINE);
    let id = open(&server, "one");
    assert_eq!(open(&server, "one"), id);
    let first = revision(&server, &id);
    let (ann, bob) = (Role::Engineer, Role::Admin);
    let none = json!({});
    let mut said = vec![stands(&server, &id, first)];
    said.push(rename(&server, ann, &id, "a1", "Ann's"));
    said.push(rename(&server, ann, &id, "a1", "Never"));
    said.push(stands(&server, &id, first));
    said.push(rename(&server, bob, &id, "b1", "Bob's"));
    said.push(deed(&server, ann, &id, "undo", &json!({ "id": "a2" })));
    said.push(deed(&server, bob, &id, "undo", &json!({ "id": "b2" })));
    said.push(deed(&server, bob, &id, "redo", &json!({ "id": "b3" })));
    said.push(deed(&server, bob, &id, "close", &none));
    said.push(deed(&server, bob, &id, "save", &none));
    said.push(stands(&server, &id, first));
    said.push(deed(&server, bob, &id, "undo", &json!({ "id": "b4" })));
    said.push(stands(&server, &id, first));
    said.push(deed(&server, bob, &id, "close", &json!({ "discard": true })));
    said.push(deed(&server, bob, &id, "save", &none));
    expect![[r#"
          "AAAAAA" 0 saved 0 disk "same"
        edits: 200
        edits: 200
          "Ann's" 1 saved 0 disk "same" changed
        edits: 200
        undo: 409 built_upon
        undo: 200
        redo: 200
        close: 409 unsaved
        save: 200
          "Bob's" 4 saved 4 disk "same"
        undo: 200
          "Ann's" 5 saved 4 disk "same" changed
        close: 200
        save: 404 no_such_machine
    "#]]
    .assert_eq(&said.concat());
    assert!(read(&server.project().join("one")).contains("Bob's"));
    assert_eq!(std::fs::read_dir(server.state().join("drafts")).unwrap().count(), 0);
}

#[test]
fn what_cannot_be_done_is_refused_with_a_reason() {
    let server = TestServer::new();
    write(&server, "one", MACHINE);
    write(&server, "two", MACHINE);
    let id = open(&server, "one");
    open(&server, "two");
    let ann = Role::Engineer;
    let say = |answer: Answer| {
        let message = answer.json()["message"].as_str().unwrap_or_default().to_owned();
        let message = message.replace(&*server.project().to_string_lossy(), "…");
        format!("{}: {message}\n", answer.said())
    };
    let edit = |edit: &Value| {
        let edit = json!({ "id": "x", "name": "x", "edit": edit });
        say(post(&server, ann, &format!("/{id}/edits"), &edit))
    };
    let save_as = |path: &str| say(post(&server, ann, &format!("/{id}/save"), &file(path)));
    let said = [
        say(post(&server, ann, "/open", &file("none"))),
        say(post(&server, ann, "/open", &file("../other"))),
        say(post(&server, ann, "/nobody/undo", &json!({ "id": "x" }))),
        say(post(&server, ann, &format!("/{id}/undo"), &json!({ "id": "x" }))),
        edit(&json!({ "edit": "set_name", "path": "ROOT/GONE", "name": "x" })),
        edit(&json!({ "edit": "set_name", "path": "ROOT", "name": "" })),
        edit(&json!({ "edit": "add_state", "path": "ROOT", "states": [] })),
        edit(&json!({ "edit": "explode" })),
        save_as("two"),
        say(post(
            &server,
            ann,
            "",
            &json!({ "name": "x", "file": { "project": "project", "path": "one" } }),
        )),
        say(post(
            &server,
            ann,
            "",
            &json!({ "name": "", "file": { "project": "project", "path": "new" } }),
        )),
        say(post(&server, Role::Operator, &format!("/{id}/save"), &json!({}))),
    ];
    expect![[r"
        404 no_such_file: there is no machine in `none` of the project project: /api/v1/projects/project/tree lists them
        400 bad_path: `../other` is not a path in a project: names joined by `/`, none of them hidden (with a dot in front), no `/` at the beginning, 4096 bytes at most
        404 no_such_machine: no machine `nobody` is open: POST /api/v1/machines/open opens one
        409 nothing_to_do: there is no step of yours to be taken back
        409 edit_refused: ROOT/GONE, state: there is no such state; check the machine again: it may have changed
        422 edit_refused: ROOT, state: the name is empty; give the state a name
        400 bad_edit: `states` of the edit: an empty list, path: expected one state and its descendants, each after its parent
        400 bad_body: the body does not fit: Failed to deserialize the JSON body into the target type: edit.edit: unknown variant `explode`, expected one of `set_name`, `set_id`, `set_description`, `set_semantic_data`, `set_script`, `set_kind`, `add_outcome`, `rename_outcome`, `remove_outcome`, `add_port`, `rename_port`, `set_port_type`, `set_port_default`, `remove_port`, `add_transition`, `set_transition_origin`, `set_transition_target`, `remove_transition`, `add_data_flow`, `set_data_flow_source`, `set_data_flow_target`, `remove_data_flow`, `set_runtime_value`, `use_runtime_value`, `remove_runtime_value`, `set_position`, `set_size`, `set_waypoints`, `set_layout`, `add_state`, `remove_state`, `set_start`, `group`, `ungroup`, `substitute_state`, `move_states`, `paste`, `set_version`, `set_machine_layout`, `set_header`, `batch` at line 1 column 25
        409 is_open: two is open: close it first
        409 folder_exists: one exists: choose another folder
        400 bad_name: the name is empty or has a `/` in it: give the machine another one
        403 not_your_right: operator is operator here, and this needs the right to edit: ask an admin for another role
    "]].assert_eq(&said.concat());
}

#[test]
fn a_new_machine_is_saved_and_a_copy_lies_elsewhere() {
    let server = TestServer::new();
    let new = json!({ "name": "Mission", "file": { "project": "project", "path": "new/mission" } });
    let made = post(&server, Role::Engineer, "", &new).json();
    let id = made["id"].as_str().unwrap();
    let edit = json!({ "edit": "set_version", "version": "2" });
    let edit = json!({ "id": "1", "name": "Version", "edit": edit });
    assert_eq!(post(&server, Role::Engineer, &format!("/{id}/edits"), &edit).status, 200);
    assert_eq!(post(&server, Role::Engineer, &format!("/{id}/save"), &file("copy")).status, 200);
    let summary = get(&server, &format!("/{id}"))["summary"].clone();
    assert_eq!(summary["file"]["path"], "copy");
    assert_eq!(summary["is_changed"], false);
    let version = |path: &str| {
        load(&server.project().join(path), &Libraries::default()).unwrap().machine.header.version
    };
    assert_eq!((version("new/mission"), version("copy")), (None, Some("2".into())));
    assert_ne!(open(&server, "new/mission"), id);
    assert_eq!(open(&server, "copy"), id);
}

#[test]
fn what_is_copied_can_be_pasted_elsewhere() {
    let server = TestServer::new();
    write(&server, "one", MACHINE);
    write(&server, "two", "hierarchy OTHERR\n  outcome success");
    let (one, two) = (open(&server, "one"), open(&server, "two"));
    let wish = json!({ "path": "ROOT", "states": ["AAAAAA", "BBBBBB"] });
    let selection = post(&server, Role::Viewer, &format!("/{one}/copy"), &wish).json();
    let paste = json!({ "edit": "paste", "path": "OTHERR", "selection": selection });
    let paste = json!({ "id": "1", "name": "Paste", "edit": paste });
    assert_eq!(post(&server, Role::Engineer, &format!("/{two}/edits"), &paste).status, 200);
    let document = get(&server, &format!("/{two}/document"));
    let states = document["document"]["states"].as_array().unwrap();
    let paths: Vec<_> = states.iter().map(|state| state["path"].as_str().unwrap()).collect();
    assert_eq!(paths, ["OTHERR", "OTHERR/AAAAAA", "OTHERR/BBBBBB"]);
}

/// Replies and status of the machine, before and after another server takes over.
fn check_taken_over(between: impl FnOnce(&Path), expect: &Expect) {
    let server = TestServer::new();
    write(&server, "one", MACHINE);
    let id = open(&server, "one");
    let first = revision(&server, &id);
    let (ann, bob) = (Role::Engineer, Role::Admin);
    let mut said = vec![rename(&server, ann, &id, "a1", "Saved")];
    said.push(deed(&server, ann, &id, "save", &json!({})));
    said.push(rename(&server, ann, &id, "a2", "Ann's"));
    said.push(rename(&server, bob, &id, "b1", "Bob's"));
    said.push(deed(&server, bob, &id, "undo", &json!({ "id": "b2" })));
    said.push(stands(&server, &id, first));
    let project = server.project();
    let place = server.end();
    between(&project);
    let server = TestServer::at(place, |_settings| {});
    assert_eq!(open(&server, "one"), id);
    said.push(stands(&server, &id, first));
    said.push(rename(&server, ann, &id, "a2", "Never"));
    said.push(deed(&server, bob, &id, "redo", &json!({ "id": "b3" })));
    said.push(deed(&server, bob, &id, "undo", &json!({ "id": "b4" })));
    said.push(deed(&server, ann, &id, "undo", &json!({ "id": "a3" })));
    said.push(deed(&server, ann, &id, "undo", &json!({ "id": "a4" })));
    said.push(stands(&server, &id, first));
    said.push(deed(&server, ann, &id, "save", &json!({})));
    said.push(deed(&server, ann, &id, "save", &json!({ "overwrite": true })));
    said.push(stands(&server, &id, first));
    expect.assert_eq(&said.concat());
}

#[test]
fn the_tree_of_steps_outlives_the_server() {
    let server = TestServer::new();
    write(&server, "one", MACHINE);
    let id = open(&server, "one");
    let first = revision(&server, &id);
    let (ann, bob) = (Role::Engineer, Role::Admin);
    let jump = |server: &TestServer, role: Role, id_of_jump: &str, to: u64, over_others: bool| {
        let wish = json!({ "id": id_of_jump, "revision": first + to, "over_others": over_others });
        deed(server, role, &id, "jump", &wish)
    };
    let steps = |server: &TestServer| get(server, &format!("/{id}/steps"));
    let mut said = vec![rename(&server, ann, &id, "a1", "Ann's")];
    said.push(rename(&server, bob, &id, "b1", "Bob's"));
    said.push(jump(&server, ann, "a2", 1, false));
    said.push(jump(&server, ann, "a3", 1, true));
    said.push(jump(&server, ann, "a3", 0, true));
    said.push(stands(&server, &id, first));
    let before = steps(&server);
    assert_eq!(before["start"], first);
    let same: Vec<_> =
        before["steps"].as_array().unwrap().iter().map(|step| &step["same_as"]).collect();
    assert_eq!(same, [&Value::Null, &Value::Null, &json!(first + 1)]);
    let server = TestServer::at(server.end(), |_settings| {});
    assert_eq!(open(&server, "one"), id);
    assert_eq!(steps(&server), before);
    said.push(jump(&server, bob, "b2", 2, false));
    said.push(stands(&server, &id, first));
    said.push(deed(&server, bob, &id, "undo", &json!({ "id": "b3" })));
    said.push(jump(&server, bob, "b4", 77, false));
    said.push(jump(&server, bob, "b5", 1, false));
    said.push(stands(&server, &id, first));
    expect![[r#"
        edits: 200
        edits: 200
        jump: 409 others_edits
        jump: 200
        jump: 200
          "Ann's" 3 saved 0 disk "same" changed
        jump: 200
          "Bob's" 4 saved 0 disk "same" changed recovered
        undo: 200
        jump: 409 not_kept
        jump: 409 nothing_to_do
          "Ann's" 5 saved 0 disk "same" changed recovered
    "#]]
    .assert_eq(&said.concat());
}

#[test]
fn what_was_done_and_saved_is_not_done_again_however_often_the_server_is_started() {
    let mut server = TestServer::new();
    write(&server, "one", MACHINE);
    let id = open(&server, "one");
    rename(&server, Role::Engineer, &id, "a1", "Ann's");
    deed(&server, Role::Engineer, &id, "save", &json!({}));
    let name = |server: &TestServer| {
        get(server, &format!("/{id}/document"))["document"]["states"][1]["name"].clone()
    };
    for _ in 0..3 {
        server = TestServer::at(server.end(), |_settings| {});
        assert_eq!(open(&server, "one"), id);
        assert_eq!(rename(&server, Role::Engineer, &id, "a1", "Never"), "edits: 200\n");
        assert_eq!(name(&server), "Ann's");
    }
    rename(&server, Role::Engineer, &id, "a2", "Later");
    server = TestServer::at(server.end(), |_settings| {});
    open(&server, "one");
    rename(&server, Role::Engineer, &id, "a1", "Never");
    assert_eq!(name(&server), "Later");
}

#[test]
fn ids_and_names_have_bounds() {
    let server = TestServer::new();
    write(&server, "one", MACHINE);
    let id = open(&server, "one");
    let long = "x".repeat(129);
    for way in ["undo", "redo", "reload"] {
        let said = deed(&server, Role::Engineer, &id, way, &json!({ "id": long }));
        assert_eq!(said, format!("{way}: 400 bad_id\n"));
    }
    assert_eq!(rename(&server, Role::Engineer, &id, "", "New"), "edits: 400 bad_id\n");
    let long = "ä".repeat(191);
    assert_eq!(rename(&server, Role::Engineer, &id, "1", &long), "edits: 400 bad_name\n");
}

/// A user who may only observe does not set edits of others aside.
#[test]
fn a_draft_that_no_longer_fits_is_left_alone_by_who_may_not_edit() {
    let server = TestServer::new();
    write(&server, "one", MACHINE);
    let id = open(&server, "one");
    rename(&server, Role::Engineer, &id, "a1", "Ann's");
    let place = server.end();
    let draft = place.path().join("state/drafts").join(&id);
    let unfit = r#"{"line":"done","author":"x","id":"1","at_ms":0,"what":{"what":"undo"}}"#;
    let lines = draft.join("operations.jsonl");
    let text = std::fs::read_to_string(&lines).unwrap();
    std::fs::write(&lines, format!("{text}{unfit}\n")).unwrap();
    let server = TestServer::at(place, |_settings| {});
    let opens = |role| post(&server, role, "/open", &file("one")).said();
    assert_eq!(opens(Role::Viewer), "422 unfit_draft");
    assert!(draft.exists());
    assert_eq!(opens(Role::Engineer), "200");
    assert!(!draft.exists());
}

#[test]
fn machines_that_nobody_follows_make_room_and_others_stay() {
    let server = TestServer::new();
    let path = |number: usize| format!("m{number}");
    (0..66).for_each(|number| write(&server, &path(number), MACHINE));
    let changed = open(&server, &path(0));
    rename(&server, Role::Engineer, &changed, "a1", "Ann's");
    let followed = open(&server, &path(1));
    let mut client = Client::connect(&server, Role::Viewer);
    client.subscribe(1, &json!({ "topic": "machine_status", "machine": followed }));
    client.hear_until(|frame| frame["status"]["summary"]["id"] == *followed);
    let gone = open(&server, &path(2));
    (3..66).for_each(|number| drop(open(&server, &path(number))));
    let status = |id: &str| {
        server.call(Some(Role::Viewer), "GET", &format!("/api/v1/machines/{id}"), None).status
    };
    assert_eq!([status(&changed), status(&followed), status(&gone)], [200, 200, 404]);
    assert_eq!(get(&server, "").as_array().unwrap().len(), 64);
}

#[test]
fn a_machine_is_refused_where_all_open_ones_are_unsaved() {
    let server = TestServer::new();
    let path = |number: usize| format!("m{number}");
    (0..65).for_each(|number| write(&server, &path(number), MACHINE));
    let ids: Vec<_> = (0..64).map(|number| open(&server, &path(number))).collect();
    for id in &ids {
        rename(&server, Role::Engineer, id, "a1", "Ann's");
    }
    let last = || post(&server, Role::Engineer, "/open", &file(&path(64))).said();
    assert_eq!(last(), "429 too_many_machines");
    deed(&server, Role::Engineer, &ids[0], "save", &json!({}));
    assert_eq!(last(), "200");
}

#[test]
fn edits_that_were_answered_outlive_the_server() {
    check_taken_over(
        |_project| {},
        &expect![[r#"
            edits: 200
            save: 200
            edits: 200
            edits: 200
            undo: 200
              "Ann's" 4 saved 1 disk "same" changed
              "Ann's" 4 saved 1 disk "same" changed recovered
            edits: 200
            redo: 200
            undo: 200
            undo: 200
            undo: 200
              "AAAAAA" 8 saved 1 disk "same" changed
            save: 200
            save: 200
              "AAAAAA" 8 saved 8 disk "same"
        "#]],
    );
}

#[test]
fn edits_that_were_answered_outlive_the_server_though_the_files_changed() {
    let change = |project: &Path| {
        let theirs = MACHINE.replace("execution AAAAAA", "execution AAAAAA \"Theirs\"");
        let theirs = notation::parse(&theirs).unwrap();
        save(&theirs, &project.join("one"), None, Naming::default()).unwrap();
    };
    check_taken_over(
        change,
        &expect![[r#"
            edits: 200
            save: 200
            edits: 200
            edits: 200
            undo: 200
              "Ann's" 4 saved 1 disk "same" changed
              "Ann's" 4 saved 1 disk "changed" changed recovered
            edits: 200
            redo: 200
            undo: 200
            undo: 200
            undo: 200
              "AAAAAA" 8 saved 1 disk "changed" changed recovered
            save: 409 changed_on_disk
            save: 200
              "AAAAAA" 8 saved 8 disk "same"
        "#]],
    );
}

#[test]
fn a_change_by_another_program_is_told_and_loses_nothing() {
    let server = TestServer::new();
    write(&server, "one", MACHINE);
    let id = open(&server, "one");
    let first = revision(&server, &id);
    let ann = Role::Engineer;
    let mut client = Client::connect(&server, Role::Viewer);
    client.subscribe(1, &json!({ "topic": "machine_status", "machine": id }));
    let mut said = vec![rename(&server, ann, &id, "a1", "Ann's")];
    write(&server, "one", &MACHINE.replace("execution AAAAAA", "execution AAAAAA \"Theirs\""));
    client.hear_until(|frame| frame["status"]["summary"]["disk"] == "changed");
    said.push(stands(&server, &id, first));
    said.push(deed(&server, ann, &id, "save", &json!({})));
    said.push(deed(&server, ann, &id, "reload", &json!({ "id": "a2" })));
    said.push(stands(&server, &id, first));
    said.push(deed(&server, ann, &id, "undo", &json!({ "id": "a3" })));
    said.push(stands(&server, &id, first));
    said.push(deed(&server, ann, &id, "save", &json!({})));
    std::fs::remove_dir_all(server.project().join("one")).unwrap();
    client.hear_until(|frame| frame["status"]["summary"]["disk"] == "missing");
    said.push(deed(&server, ann, &id, "save", &json!({})));
    said.push(stands(&server, &id, first));
    expect![[r#"
        edits: 200
          "Ann's" 1 saved 0 disk "changed" changed
        save: 409 changed_on_disk
        reload: 200
          "Theirs" 2 saved 2 disk "same"
        undo: 200
          "Ann's" 3 saved 2 disk "same" changed
        save: 200
        save: 200
          "Ann's" 3 saved 3 disk "same"
    "#]]
    .assert_eq(&said.concat());
    assert!(read(&server.project().join("one")).contains("Ann's"));
}

#[test]
fn problems_are_told_with_the_way_out() {
    let server = TestServer::new();
    write(
        &server,
        "one",
        "hierarchy ROOT\n  outcome success\n  AAAAAA.success -> GONE\n  execution AAAAAA\n    outcome success",
    );
    let id = open(&server, "one");
    let problems = get(&server, &format!("/{id}/problems"));
    let lines = problems.as_array().unwrap().iter().map(|problem| problem.to_string() + "\n");
    expect![[r#"
        {"message":"ROOT, state: no child is where it starts; connect the income with a child","part":"state","path":"ROOT","rule":"StartMissing","severity":"error"}
        {"message":"ROOT, transition 1: it leads to GONE, which does not exist; connect the end with a child or an outcome of the container, or remove the transition","part":"transition 1","path":"ROOT","repairs":[{"edit":{"edit":"remove_transition","path":"ROOT","transition":1},"name":"Remove the transition"}],"rule":"TargetState","severity":"error"}
        {"message":"ROOT/AAAAAA, state: there is no script; write a script","part":"state","path":"ROOT/AAAAAA","rule":"ScriptMissing","severity":"note"}
    "#]].assert_eq(&lines.collect::<String>());
}

#[test]
fn revisions_come_in_pages_from_a_cursor() {
    let server = TestServer::new();
    write(&server, "one", MACHINE);
    let id = open(&server, "one");
    let first = revision(&server, &id);
    for number in 0..3 {
        let name = format!("Name {number}");
        rename(&server, Role::Engineer, &id, &number.to_string(), &name);
    }
    let page = |from: u64| {
        let page = get(&server, &format!("/{id}/revisions?from={from}"));
        let ids = page["revisions"].as_array().unwrap().iter().map(|revision| &revision["id"]);
        let ids: Vec<_> = ids.collect();
        format!("{} {ids:?} next {}\n", page["is_reset"], page["next"].as_u64().unwrap() - first)
    };
    let pages = [page(first + 1), page(first + 3), page(first + 4), page(first + 5), page(0)];
    expect![[r#"
        false [String("0"), String("1"), String("2")] next 4
        false [String("2")] next 4
        false [] next 4
        true [] next 4
        true [] next 4
    "#]]
    .assert_eq(&pages.concat());
}
