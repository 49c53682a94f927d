//! Machines whose files are links, as `colcon build --symlink-install` installs them. They open if the links stay inside, and a save
//! never replaces the links.

use crate::harness::{Answer, TestServer};
use crate::machines::{MACHINE, get, post};
use expect_test::expect;
use rafcon_protocol::api::Role;
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use serde_json::{Value, json};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

/// Install folder of a package in its workspace.
const SHARE: &str = "install/p/share/p";

/// A workspace `ws` with the machine `hello` in its sources, and links to its files in the install folder.
fn workspace(place: &Path) -> PathBuf {
    let ws = place.join("ws");
    let machine = notation::parse(MACHINE).unwrap();
    save(&machine, &ws.join("src/p/hello"), None, Naming::default()).unwrap();
    link_files(&ws.join("src/p/hello"), &ws.join(SHARE).join("hello"));
    ws
}

/// Adds the marks of colcon.
fn build(ws: &Path) {
    fs::create_dir_all(ws.join("build")).unwrap();
    fs::write(ws.join("build/.built_by"), "colcon\n").unwrap();
    fs::write(ws.join("install/.colcon_install_layout"), "isolated\n").unwrap();
}

fn link_files(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let (path, to) = (entry.as_ref().unwrap().path(), to.join(entry.unwrap().file_name()));
        if path.is_dir() { link_files(&path, &to) } else { symlink(path, to).unwrap() }
    }
}

/// The file of this name in a state of a machine.
fn in_state(machine: &Path, name: &str) -> PathBuf {
    let inside = fs::read_dir(machine).unwrap().map(|entry| entry.unwrap().path().join(name));
    inside.into_iter().find(|path| path.exists() && path.parent() != Some(machine)).unwrap()
}

fn serve(place: tempfile::TempDir, project: &str) -> TestServer {
    let project = place.path().join("ws").join(project);
    TestServer::at(place, |settings| settings.projects = vec![project])
}

fn open(server: &TestServer, project: &str, path: &str) -> Answer {
    let file = json!({ "file": { "project": project, "path": path } });
    post(server, Role::Engineer, "/open", &file)
}

fn rename_and_save(server: &TestServer, id: &str, save: &Value) -> String {
    let edit = json!({ "edit": "set_name", "path": "ROOT/AAAAAA", "name": "New" });
    let edit = json!({ "id": "1", "name": "Rename", "edit": edit });
    assert_eq!(post(server, Role::Engineer, &format!("/{id}/edits"), &edit).status, 200);
    let saved = post(server, Role::Engineer, &format!("/{id}/save"), save);
    let message = saved.json()["message"].as_str().unwrap_or_default().to_owned();
    format!("{} {message}", saved.said())
}

#[test]
fn an_installed_machine_is_opened_and_its_links_are_not_replaced() {
    let place = tempfile::tempdir().unwrap();
    let root = place.path().canonicalize().unwrap().to_string_lossy().into_owned();
    let ws = workspace(place.path());
    build(&ws);
    let server = serve(place, SHARE);
    let tree = server.call(Some(Role::Viewer), "GET", "/api/v1/projects/p/tree", None).json();
    assert_eq!(tree["children"][0]["kind"], "machine");
    let opened = open(&server, "p", "hello");
    assert_eq!(opened.said(), "200");
    let id = opened.json()["id"].as_str().unwrap().to_owned();
    let script = &get(&server, &format!("/{id}/document"))["document"]["states"][1]["script"];
    assert_eq!(script, "x = 1");
    let said = rename_and_save(&server, &id, &json!({})).replace(&root, "…");
    expect![[r"409 linked_files …/ws/install/p/share/p/hello/AAAAAA_AAAAAA/core_data.json is a link to …/ws/src/p/hello/AAAAAA_AAAAAA/core_data.json, which a save would replace by a file: save the machine where its files really lie, or in another folder"]].assert_eq(&said);
    let elsewhere = json!({ "file": { "project": "p", "path": "copy" } });
    assert_eq!(rename_and_save(&server, &id, &elsewhere), "200 ");
    let script = in_state(&ws.join(SHARE).join("hello"), "script.py");
    assert!(script.is_symlink());
    assert!(!in_state(&ws.join(SHARE).join("copy"), "script.py").is_symlink());
}

#[test]
fn links_lead_to_other_projects_and_to_the_workspace_only() {
    let place = tempfile::tempdir().unwrap();
    let ws = workspace(place.path());
    let server = serve(place, SHARE);
    assert_eq!(open(&server, "p", "hello").said(), "403 outside_project");
    build(&ws);
    let server = serve(server.end(), SHARE);
    assert_eq!(open(&server, "p", "hello").said(), "200");
    let secret = ws.join("secret.py");
    fs::write(&secret, "secret = 1").unwrap();
    let script = in_state(&ws.join("src/p/hello"), "script.py");
    fs::remove_file(&script).unwrap();
    symlink(&secret, &script).unwrap();
    let server = serve(server.end(), SHARE);
    assert_eq!(open(&server, "p", "hello").said(), "403 outside_project");
    let server = serve(server.end(), "");
    assert_eq!(open(&server, "ws", "install/p/share/p/hello").said(), "200");
}
