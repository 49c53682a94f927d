//! Machines and states that are saved in other folders.

use crate::harness::{Answer, TestServer};
use crate::machines::{MACHINE, get, open, post, write};
use expect_test::expect;
use rafcon_model::Header;
use rafcon_protocol::api::Role;
use rafcon_storage::{Libraries, load};
use rafcon_testkit::notation;
use serde_json::{Value, json};

const NESTED: &str = "
    hierarchy ROOT
      hierarchy INNER \"Search\"
        outcome found
        in where: str = \"here\"
        start -> STEPPP
        STEPPP.success -> .found
        execution STEPPP
          outcome success
          script \"x = 1\"
      barrier BBBBBB
        decider unique_decider_state_id
";

fn file(path: &str) -> Value {
    json!({ "project": "project", "path": path })
}

/// The machine on disk, without its header, which has times and versions.
fn shown(server: &TestServer, path: &str) -> String {
    let mut machine = load(&server.project().join(path), &Libraries::default()).unwrap().machine;
    machine.header = Header::default();
    notation::print(&machine)
}

/// Status, code and message, without the test's folder.
fn said(server: &TestServer, answer: &Answer) -> String {
    let message = answer.json()["message"].as_str().unwrap_or_default().to_owned();
    let message = message.replace(&*server.project().to_string_lossy(), "…");
    format!("{}: {message}\n", answer.said())
}

#[test]
fn a_state_is_saved_as_a_machine_and_as_a_library() {
    let server = TestServer::with(|settings| {
        settings.libraries = vec![("skills".into(), settings.projects[0].join("skills"))];
        std::fs::create_dir_all(settings.projects[0].join("skills")).unwrap();
    });
    write(&server, "one", NESTED);
    let id = open(&server, "one");
    let save = |to: &str| {
        let wish = json!({ "path": "ROOT/INNER", "file": file(to) });
        post(&server, Role::Engineer, &format!("/{id}/save_state"), &wish).json()
    };
    assert_eq!(save("search"), json!({ "file": file("search"), "library": null }));
    let library = json!({ "path": "skills/arm", "name": "search" });
    assert_eq!(save("skills/arm/search")["library"], library);
    assert_eq!(shown(&server, "search"), shown(&server, "skills/arm/search"));
    expect![[r#"
        hierarchy INNER "Search"
          outcome found
          in where: str = "here"
          start -> STEPPP
          STEPPP.success -> .found
          execution STEPPP
            outcome success
            script "x = 1"
    "#]]
    .assert_eq(&shown(&server, "search"));
    let answer =
        server.call(Some(Role::Viewer), "GET", "/api/v1/libraries/skills/arm/search", None);
    assert_eq!(answer.json()["states"][0]["name"], "Search");
}

#[test]
fn nothing_is_written_where_something_else_lies() {
    let server = TestServer::new();
    write(&server, "one", NESTED);
    write(&server, "two", MACHINE);
    write(&server, "open", MACHINE);
    std::fs::create_dir_all(server.project().join("full/of/things")).unwrap();
    let id = open(&server, "one");
    open(&server, "open");
    let save = |path: &str, to: &str, overwrite: bool| {
        let wish = json!({ "path": path, "file": file(to), "overwrite": overwrite });
        said(&server, &post(&server, Role::Engineer, &format!("/{id}/save_state"), &wish))
    };
    let copy =
        |body: &Value| said(&server, &post(&server, Role::Engineer, &format!("/{id}/save"), body));
    let told = [
        save("ROOT/INNER", "two", false),
        save("ROOT/INNER", "two", true),
        save("ROOT/INNER", "two/inside", true),
        save("ROOT/INNER", "one/deep/inside", true),
        save("ROOT/INNER", "open", true),
        save("ROOT/INNER", "full", true),
        save("ROOT/INNER", "../out", true),
        save("ROOT/GONE", "new", false),
        save("ROOT/BBBBBB/unique_decider_state_id", "new", false),
        copy(&json!({ "file": file("two/inside") })),
        copy(&json!({ "copy": true })),
        copy(&json!({ "copy": true, "file": file("one") })),
        said(
            &server,
            &post(&server, Role::Engineer, "", &json!({ "name": "x", "file": file("two/inside") })),
        ),
    ];
    expect![[r"
        409 folder_exists: two exists: choose another folder, or save with `overwrite`
        200: 
        409 inside_a_machine: two/inside lies in the machine …/two: choose a folder outside of it
        409 inside_a_machine: one/deep/inside lies in the machine …/one: choose a folder outside of it
        409 is_open: open is open: close it first
        409 not_a_machine: full is no machine, and not empty: choose another folder
        400 bad_path: `../out` is not a path in a project: names joined by `/`, none of them hidden (with a dot in front), no `/` at the beginning, 4096 bytes at most
        404 no_such_state: there is no state ROOT/GONE: it may have changed
        422 no_machine: unique_decider_state_id is the decider of its barrier, and belongs there: save the barrier
        409 inside_a_machine: two/inside lies in the machine …/two: choose a folder outside of it
        400 no_place_for_a_copy: a copy needs a folder of its own: name one in `file`
        400 no_place_for_a_copy: a copy needs a folder of its own: name one in `file`
        409 inside_a_machine: two/inside lies in the machine …/two: choose a folder outside of it
    "]].assert_eq(&told.concat());
    let two = shown(&server, "two");
    assert!(two.starts_with("hierarchy INNER"), "{two}");
    assert!(!server.project().join("two/inside").exists());
}

#[test]
fn a_copy_is_written_and_the_machine_stays_where_it_lies() {
    let server = TestServer::new();
    write(&server, "one", MACHINE);
    let id = open(&server, "one");
    let edit = json!({ "edit": "set_name", "path": "ROOT/AAAAAA", "name": "Changed" });
    let edit = json!({ "id": "1", "name": "Rename", "edit": edit });
    post(&server, Role::Engineer, &format!("/{id}/edits"), &edit);
    let wish = json!({ "copy": true, "file": file("copies/first") });
    assert_eq!(post(&server, Role::Engineer, &format!("/{id}/save"), &wish).status, 200);
    let summary = get(&server, &format!("/{id}"))["summary"].clone();
    assert_eq!((&summary["file"], &summary["is_changed"]), (&file("one"), &json!(true)));
    assert!(shown(&server, "copies/first").contains("Changed"));
    assert!(!shown(&server, "one").contains("Changed"));
}
