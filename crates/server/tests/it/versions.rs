//! What an open machine is compared with: its files, and its versions in git.

use crate::harness::{Answer, House};
use crate::machines::{MACHINE, get, open, post, write};
use rafcon_protocol::api::Role;
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;

fn git(folder: &Path, arguments: &[&str]) {
    let who = ["user.name=Ann", "user.email=ann@example.org", "commit.gpgSign=false"];
    let mut git = Command::new("git");
    git.current_dir(folder).args(who.iter().flat_map(|set| ["-c", set])).args(arguments);
    let git = git.env("GIT_CONFIG_NOSYSTEM", "1").env("GIT_CONFIG_GLOBAL", "/dev/null");
    let git = git.env("GIT_AUTHOR_DATE", "@1700000000 +0000");
    let said = git.output().unwrap();
    assert!(said.status.success(), "{said:?}");
}

fn commit(house: &House, message: &str) {
    git(&house.project(), &["add", "--all"]);
    git(&house.project(), &["commit", "--quiet", "--message", message]);
}

fn ask(house: &House, path: &str) -> Answer {
    house.call(Some(Role::Viewer), "GET", &format!("/api/v1/machines{path}"), None)
}

/// The name of the first child in a document.
fn name(document: &Value) -> &str {
    document["states"][1]["name"].as_str().unwrap()
}

/// A machine with two versions in git, and one on disk; its id.
fn committed() -> (House, String) {
    let house = House::new();
    write(&house, "in/one", MACHINE);
    write(&house, "two", MACHINE);
    git(&house.project(), &["init", "--quiet"]);
    commit(&house, "Two machines");
    let id = open(&house, "in/one");
    rename(&house, &id, "Second");
    assert_eq!(post(&house, Role::Engineer, &format!("/{id}/save"), &json!({})).status, 200);
    commit(&house, "Rename a state\n\nFor good.");
    (house, id)
}

fn rename(house: &House, id: &str, name: &str) {
    let edit = json!({ "edit": "set_name", "path": "ROOT/AAAAAA", "name": name });
    let edit = json!({ "id": name, "name": "Rename", "edit": edit });
    assert_eq!(post(house, Role::Engineer, &format!("/{id}/edits"), &edit).status, 200);
}

#[test]
fn an_open_machine_is_compared_with_its_files_and_its_versions() {
    let (house, id) = committed();
    rename(&house, &id, "Third");
    assert_eq!(name(&get(&house, &format!("/{id}/saved"))), "Second");
    let versions = get(&house, &format!("/{id}/versions"));
    let told = versions["versions"].as_array().unwrap();
    let told = told
        .iter()
        .map(|one| (one["author"].as_str(), one["subject"].as_str(), one["at_ms"].as_u64()));
    let at = Some(1_700_000_000_000);
    let (rename, add) = (Some("Rename a state"), Some("Two machines"));
    assert_eq!(told.collect::<Vec<_>>(), [(Some("Ann"), rename, at), (Some("Ann"), add, at)]);
    assert_eq!((&versions["is_git"], &versions["is_cut"]), (&json!(true), &json!(false)));
    let version = |index: usize| {
        let commit = versions["versions"][index]["commit"].as_str().unwrap();
        get(&house, &format!("/{id}/versions/{commit}"))
    };
    assert_eq!([name(&version(0)), name(&version(1))], ["Second", "AAAAAA"]);
    assert_eq!(version(0), get(&house, &format!("/{id}/saved")));
    let versions = house.state().join("versions");
    assert_eq!(std::fs::read_dir(&versions).unwrap().count(), 0);
    std::fs::create_dir(versions.join("left behind")).unwrap();
    let house = House::at(house.end(), |_settings| {});
    assert!(!house.state().join("versions").exists());
}

#[test]
fn a_repository_outside_the_project_is_not_asked() {
    let house = House::new();
    let outside = house.state().join("outside");
    std::fs::create_dir_all(outside.join("one")).unwrap();
    std::fs::write(outside.join("one/secret"), "secret").unwrap();
    git(&outside, &["init", "--quiet"]);
    git(&outside, &["add", "--all"]);
    git(&outside, &["commit", "--quiet", "--message", "A secret"]);
    let is_git = |name: &str| {
        write(&house, &format!("{name}/one"), MACHINE);
        let link = house.project().join(name).join(".git");
        match name {
            "file" => {
                let target = format!("gitdir: {}/.git\n", outside.display());
                std::fs::write(link, target).unwrap();
            }
            "link" => std::os::unix::fs::symlink(outside.join(".git"), link).unwrap(),
            "common" => {
                git(&house.project().join(name), &["init", "--quiet"]);
                let target = format!("{}/.git\n", outside.display());
                std::fs::write(link.join("commondir"), target).unwrap();
            }
            "borrowed" => {
                git(&house.project().join(name), &["init", "--quiet"]);
                let target = format!("{}/.git/objects\n", outside.display());
                std::fs::write(link.join("objects/info/alternates"), target).unwrap();
            }
            _ => {}
        }
        let id = open(&house, &format!("{name}/one"));
        get(&house, &format!("/{id}/versions"))["is_git"].clone()
    };
    for name in ["none", "file", "link", "common", "borrowed"] {
        assert_eq!(is_git(name), json!(false), "{name}");
    }
}

#[test]
fn what_is_no_version_is_refused() {
    let (house, id) = committed();
    let said = |commit: &str| ask(&house, &format!("/{id}/versions/{commit}")).said();
    assert_eq!(said("HEAD"), "400 bad_commit");
    assert_eq!(said("--output=x"), "400 bad_commit");
    assert_eq!(said(&"0".repeat(40)), "404 no_such_version");
    write(&house, "new", MACHINE);
    let new = open(&house, "new");
    let versions = get(&house, &format!("/{new}/versions"));
    assert_eq!((&versions["is_git"], &versions["versions"]), (&json!(true), &json!([])));
    let known = get(&house, &format!("/{id}/versions"))["versions"][0]["commit"].clone();
    let answer = ask(&house, &format!("/{new}/versions/{}", known.as_str().unwrap()));
    assert_eq!(answer.said(), "404 no_such_version");
    std::fs::remove_dir_all(house.project().join("new")).unwrap();
    assert_eq!(ask(&house, &format!("/{new}/saved")).said(), "409 machine_gone");
}

#[test]
fn without_git_there_are_no_versions() {
    let house = House::new();
    write(&house, "one", MACHINE);
    let id = open(&house, "one");
    let none = json!({ "is_git": false, "versions": [], "is_cut": false });
    assert_eq!(get(&house, &format!("/{id}/versions")), none);
}

/// Whoever writes into a repository names programs there that a checkout or a signed log would run.
#[test]
fn nothing_that_a_repository_names_is_run() {
    let (house, id) = committed();
    let ran = house.project().join("ran");
    let script = house.project().join("run.sh");
    std::fs::write(&script, format!("#!/bin/sh\ntouch {}\ncat\n", ran.display())).unwrap();
    std::fs::write(
        house.project().join(".gitattributes"),
        "* filter=evil diff=evil export-subst\n",
    )
    .unwrap();
    commit(&house, "Attributes");
    let command = format!("sh {}", script.display());
    for key in [
        "filter.evil.smudge",
        "filter.evil.clean",
        "diff.evil.textconv",
        "core.fsmonitor",
        "core.pager",
        "gpg.program",
        "core.sshCommand",
    ] {
        git(&house.project(), &["config", key, &command]);
    }
    git(&house.project(), &["config", "log.showSignature", "true"]);
    let versions = get(&house, &format!("/{id}/versions"));
    let commit = versions["versions"][0]["commit"].as_str().unwrap();
    assert_eq!(name(&get(&house, &format!("/{id}/versions/{commit}"))), "Second");
    assert!(!ran.exists());
    git(&house.project(), &["cat-file", "--filters", "HEAD:two/core_data.json"]);
    assert!(ran.exists(), "a git that may run it does");
}
