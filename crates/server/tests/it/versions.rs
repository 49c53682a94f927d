//! Versions for comparison with an open machine: its files, and git commits.

use crate::harness::{Answer, TestServer};
use crate::machines::{MACHINE, get, open, post, write};
use rafcon_protocol::api::Role;
use serde_json::{Value, json};
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

fn git(folder: &Path, arguments: &[&str]) {
    let who = ["user.name=Ann", "user.email=ann@example.org", "commit.gpgSign=false"];
    let mut git = Command::new("git");
    git.current_dir(folder).args(who.iter().flat_map(|set| ["-c", set])).args(arguments);
    let git = git.env("GIT_CONFIG_NOSYSTEM", "1").env("GIT_CONFIG_GLOBAL", "/dev/null");
    let git = git.env("GIT_AUTHOR_DATE", "@1700000000 +0000");
    let said = git.output().unwrap();
    assert!(said.status.success(), "{said:?}");
}

fn commit(server: &TestServer, message: &str) {
    git(&server.project(), &["add", "--all"]);
    git(&server.project(), &["commit", "--quiet", "--message", message]);
}

fn ask(server: &TestServer, path: &str) -> Answer {
    server.call(Some(Role::Viewer), "GET", &format!("/api/v1/machines{path}"), None)
}

/// The name of the first child in a document.
fn name(document: &Value) -> &str {
    document["states"][1]["name"].as_str().unwrap()
}

/// A machine with two versions in git and one on disk. Returns its id.
fn committed() -> (TestServer, String) {
    let server = TestServer::new();
    write(&server, "in/one", MACHINE);
    write(&server, "two", MACHINE);
    git(&server.project(), &["init", "--quiet"]);
    commit(&server, "Two machines");
    let id = open(&server, "in/one");
    rename(&server, &id, "Second");
    assert_eq!(post(&server, Role::Engineer, &format!("/{id}/save"), &json!({})).status, 200);
    commit(&server, "Rename a state\n\nFor good.");
    (server, id)
}

fn rename(server: &TestServer, id: &str, name: &str) {
    let edit = json!({ "edit": "set_name", "path": "ROOT/AAAAAA", "name": name });
    let edit = json!({ "id": name, "name": "Rename", "edit": edit });
    assert_eq!(post(server, Role::Engineer, &format!("/{id}/edits"), &edit).status, 200);
}

#[test]
fn an_open_machine_is_compared_with_its_files_and_its_versions() {
    let (server, id) = committed();
    rename(&server, &id, "Third");
    assert_eq!(name(&get(&server, &format!("/{id}/saved"))), "Second");
    let versions = get(&server, &format!("/{id}/versions"));
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
        get(&server, &format!("/{id}/versions/{commit}"))
    };
    assert_eq!([name(&version(0)), name(&version(1))], ["Second", "AAAAAA"]);
    assert_eq!(version(0), get(&server, &format!("/{id}/saved")));
    let versions = server.state().join("versions");
    assert_eq!(std::fs::read_dir(&versions).unwrap().count(), 0);
    std::fs::create_dir(versions.join("left behind")).unwrap();
    let server = TestServer::at(server.end(), |_settings| {});
    assert!(!server.state().join("versions").exists());
}

#[test]
fn a_repository_outside_the_project_is_not_asked() {
    let server = TestServer::new();
    let outside = server.state().join("outside");
    std::fs::create_dir_all(outside.join("one")).unwrap();
    std::fs::write(outside.join("one/secret"), "secret").unwrap();
    git(&outside, &["init", "--quiet"]);
    git(&outside, &["add", "--all"]);
    git(&outside, &["commit", "--quiet", "--message", "A secret"]);
    let is_git = |name: &str| {
        write(&server, &format!("{name}/one"), MACHINE);
        let link = server.project().join(name).join(".git");
        match name {
            "file" => {
                let target = format!("gitdir: {}/.git\n", outside.display());
                std::fs::write(link, target).unwrap();
            }
            "link" => std::os::unix::fs::symlink(outside.join(".git"), link).unwrap(),
            "common" => {
                git(&server.project().join(name), &["init", "--quiet"]);
                let target = format!("{}/.git\n", outside.display());
                std::fs::write(link.join("commondir"), target).unwrap();
            }
            "borrowed" => {
                git(&server.project().join(name), &["init", "--quiet"]);
                let target = format!("{}/.git/objects\n", outside.display());
                std::fs::write(link.join("objects/info/alternates"), target).unwrap();
            }
            _ => {}
        }
        let id = open(&server, &format!("{name}/one"));
        get(&server, &format!("/{id}/versions"))["is_git"].clone()
    };
    for name in ["none", "file", "link", "common", "borrowed"] {
        assert_eq!(is_git(name), json!(false), "{name}");
    }
}

/// Adds this number of commits that change the folder of the machine.
fn commit_often(server: &TestServer, commits: usize) {
    let one = |number: usize| {
        let second = 1_700_000_000 + number;
        format!(
            "commit refs/heads/many\ncommitter Ann <ann@example.org> {second} +0000\ndata 3\nabc\n\
             M 100644 inline in/one/note\ndata <<END\n{number}\nEND\n\n"
        )
    };
    let stream: String = (0..commits).map(one).collect();
    let mut git = Command::new("git");
    git.current_dir(server.project()).args(["fast-import", "--quiet"]).stdin(Stdio::piped());
    let mut git = git.env("GIT_CONFIG_NOSYSTEM", "1").spawn().unwrap();
    git.stdin.take().unwrap().write_all(stream.as_bytes()).unwrap();
    assert!(git.wait().unwrap().success());
}

#[test]
fn of_many_versions_the_newest_are_told() {
    let (server, id) = committed();
    git(&server.project(), &["symbolic-ref", "HEAD", "refs/heads/many"]);
    let told = || {
        let versions = get(&server, &format!("/{id}/versions"));
        let all = versions["versions"].as_array().unwrap();
        let newest = all[0]["at_ms"].as_u64().unwrap() / 1000 - 1_700_000_000;
        (all.len(), newest, versions["is_cut"].as_bool().unwrap())
    };
    commit_often(&server, 200);
    assert_eq!(told(), (200, 199, false));
    git(&server.project(), &["update-ref", "-d", "refs/heads/many"]);
    commit_often(&server, 201);
    assert_eq!(told(), (200, 200, true));
}

#[test]
fn what_is_no_version_is_refused() {
    let (server, id) = committed();
    let said = |commit: &str| ask(&server, &format!("/{id}/versions/{commit}")).said();
    assert_eq!(said("HEAD"), "400 bad_commit");
    assert_eq!(said("--output=x"), "400 bad_commit");
    assert_eq!(said(&"0".repeat(40)), "404 no_such_version");
    write(&server, "new", MACHINE);
    let new = open(&server, "new");
    let versions = get(&server, &format!("/{new}/versions"));
    assert_eq!((&versions["is_git"], &versions["versions"]), (&json!(true), &json!([])));
    let known = get(&server, &format!("/{id}/versions"))["versions"][0]["commit"].clone();
    let answer = ask(&server, &format!("/{new}/versions/{}", known.as_str().unwrap()));
    assert_eq!(answer.said(), "404 no_such_version");
    std::fs::remove_dir_all(server.project().join("new")).unwrap();
    assert_eq!(ask(&server, &format!("/{new}/saved")).said(), "409 machine_gone");
}

#[test]
fn without_git_there_are_no_versions() {
    let server = TestServer::new();
    write(&server, "one", MACHINE);
    let id = open(&server, "one");
    let none = json!({ "is_git": false, "versions": [], "is_cut": false });
    assert_eq!(get(&server, &format!("/{id}/versions")), none);
}

/// The authors of a repository can name programs that a checkout or a signed log would run.
#[test]
fn nothing_that_a_repository_names_is_run() {
    let (server, id) = committed();
    let ran = server.project().join("ran");
    let script = server.project().join("run.sh");
    std::fs::write(&script, format!("#!/bin/sh\ntouch {}\ncat\n", ran.display())).unwrap();
    std::fs::write(
        server.project().join(".gitattributes"),
        "* filter=evil diff=evil export-subst\n",
    )
    .unwrap();
    commit(&server, "Attributes");
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
        git(&server.project(), &["config", key, &command]);
    }
    git(&server.project(), &["config", "log.showSignature", "true"]);
    let versions = get(&server, &format!("/{id}/versions"));
    let commit = versions["versions"][0]["commit"].as_str().unwrap();
    assert_eq!(name(&get(&server, &format!("/{id}/versions/{commit}"))), "Second");
    assert!(!ran.exists());
    git(&server.project(), &["cat-file", "--filters", "HEAD:two/core_data.json"]);
    assert!(ran.exists(), "a git that may run it does");
}
