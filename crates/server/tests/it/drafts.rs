//! Recovery by a server after a crash of the previous one: edits despite changed files, interrupted saves, edits that cancel out,
//! and edits that no longer fit.

use crate::harness::TestServer;
use crate::machines::{MACHINE, get, post, write};
use expect_test::{Expect, expect};
use rafcon_protocol::api::Role;
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;

const THEIRS: (&str, &str) = ("execution BBBBBB", "execution BBBBBB \"Theirs\"");

/// A server with the open machine `one`, and the number of requests.
struct Site {
    server: TestServer,
    id: String,
    asked: usize,
}

/// Opens the machine `one` as a user who may edit it.
fn open(server: &TestServer) -> String {
    let file = json!({ "file": { "project": "project", "path": "one" } });
    let opened = post(server, Role::Engineer, "/open", &file);
    assert_eq!(opened.said(), "200");
    opened.json()["id"].as_str().unwrap().to_owned()
}

impl Site {
    fn new() -> Self {
        let server = TestServer::new();
        write(&server, "one", MACHINE);
        let id = open(&server);
        Self { server, id, asked: 0 }
    }

    fn ask(&mut self, what: &str, mut body: Value) {
        self.asked += 1;
        body["id"] = json!(format!("request {}", self.asked));
        let answer = post(&self.server, Role::Engineer, &format!("/{}/{what}", self.id), &body);
        assert_eq!(answer.said(), "200", "{what}");
    }

    fn rename(&mut self, name: &str) {
        let edit = json!({ "edit": "set_name", "path": "ROOT/AAAAAA", "name": name });
        self.ask("edits", json!({ "name": "Rename", "edit": edit }));
    }

    fn write_as_another_program(&self) {
        write(&self.server, "one", &MACHINE.replace(THEIRS.0, THEIRS.1));
    }

    fn draft(&self) -> PathBuf {
        self.server.state().join("drafts").join(&self.id)
    }

    /// Changes the lines of the draft, starts another server, and opens the machine.
    fn take_over(self, change: impl Fn(&str) -> Option<String>) -> Self {
        let (lines, asked) = (self.draft().join("operations.jsonl"), self.asked);
        let place = self.server.end();
        if let Ok(text) = fs::read_to_string(&lines) {
            let text: String = text.lines().filter_map(|line| Some(change(line)? + "\n")).collect();
            fs::write(&lines, text).unwrap();
        }
        let server = TestServer::at(place, |_settings| {});
        let id = open(&server);
        Self { server, id, asked }
    }

    /// Compares the names of two states and the status of the machine.
    fn check(&self, expect: &Expect) {
        let summary = get(&self.server, &format!("/{}", self.id))["summary"].clone();
        let document = get(&self.server, &format!("/{}/document", self.id));
        let name = |at: usize| document["document"]["states"][at]["name"].as_str().unwrap();
        let flags = ["is_changed", "is_recovered"].into_iter().filter(|flag| summary[flag] == true);
        let flags = flags.map(|flag| flag.trim_start_matches("is_")).collect::<Vec<_>>().join(" ");
        let line = format!("{} {} {} {flags}", name(1), name(2), summary["disk"]);
        expect.assert_eq(line.trim_end());
    }

    fn set_aside(&self) -> Value {
        get(&self.server, &format!("/{}/set_aside", self.id))
    }
}

#[expect(clippy::unnecessary_wraps, reason = "one of several changes of a line")]
fn all(line: &str) -> Option<String> {
    Some(line.to_owned())
}

/// As if the server had crashed before it recorded a save or a load.
fn unnoted(line: &str) -> Option<String> {
    (!line.contains(r#""line":"saved""#)).then(|| line.to_owned())
}

#[test]
fn what_the_edits_began_with_lies_on_disk_before_the_first_answer() {
    let mut site = Site::new();
    site.rename("Ann's");
    let documents = fs::read_dir(site.draft()).unwrap().map(|entry| entry.unwrap().path());
    let documents: Vec<_> = documents.filter(|path| path.extension().unwrap() == "json").collect();
    let [document] = &documents[..] else { panic!("{documents:?}") };
    let hash = blake3::hash(&fs::read(document).unwrap()).to_hex().to_string();
    assert_eq!(document.file_stem().unwrap().to_str(), Some(hash.as_str()));
    site.write_as_another_program();
    let site = site.take_over(all);
    site.check(&expect![[r#"Ann's BBBBBB "changed" changed recovered"#]]);
    let site = site.take_over(all);
    site.check(&expect![[r#"Ann's BBBBBB "changed" changed recovered"#]]);
}

#[test]
fn a_save_that_the_server_did_not_live_to_note_is_no_change_by_another_program() {
    let mut site = Site::new();
    site.rename("Saved");
    site.ask("save", json!({}));
    let mut site = site.take_over(unnoted);
    site.check(&expect![[r#"Saved BBBBBB "same""#]]);
    site.rename("Saved too");
    site.ask("save", json!({}));
    site.rename("Later");
    let mut site = site.take_over(unnoted);
    site.check(&expect![[r#"Later BBBBBB "same" changed recovered"#]]);
    site.ask("undo", json!({}));
    site.check(&expect![[r#"Saved too BBBBBB "same""#]]);
    site.ask("save", json!({}));
    site.rename("Last");
    site.write_as_another_program();
    let site = site.take_over(unnoted);
    site.check(&expect![[r#"Last BBBBBB "changed" changed recovered"#]]);
}

#[test]
fn files_that_the_server_did_not_live_to_note_as_read_are_no_change() {
    let mut site = Site::new();
    site.rename("Ann's");
    site.write_as_another_program();
    site.ask("reload", json!({}));
    let site = site.take_over(unnoted);
    site.check(&expect![[r#"AAAAAA Theirs "same""#]]);
}

#[test]
fn edits_that_cancel_out_are_not_reported_and_can_be_made_again() {
    let mut site = Site::new();
    site.rename("Ann's");
    site.ask("undo", json!({}));
    let site = site.take_over(all);
    site.check(&expect![[r#"AAAAAA BBBBBB "same""#]]);
    let mut site = site.take_over(all);
    site.ask("redo", json!({}));
    site.check(&expect![[r#"Ann's BBBBBB "same" changed"#]]);
    site.ask("undo", json!({}));
    site.write_as_another_program();
    let site = site.take_over(all);
    site.check(&expect![[r#"AAAAAA BBBBBB "changed" changed"#]]);
}

#[test]
fn edits_after_recovered_ones_were_taken_back_are_not_recovered() {
    let mut site = Site::new();
    site.rename("Ann's");
    let mut site = site.take_over(all);
    site.check(&expect![[r#"Ann's BBBBBB "same" changed recovered"#]]);
    site.ask("undo", json!({}));
    site.rename("New");
    site.check(&expect![[r#"New BBBBBB "same" changed"#]]);
}

/// Changes the first edit, so that it names a state that does not exist.
#[expect(clippy::unnecessary_wraps, reason = "one of several changes of a line")]
fn unfit(line: &str) -> Option<String> {
    Some(line.replace("ROOT/AAAAAA", "ROOT/GONEXX"))
}

#[test]
fn edits_that_no_longer_fit_are_listed_exported_and_discarded() {
    let mut site = Site::new();
    site.rename("Saved");
    site.ask("save", json!({}));
    site.rename("Ann's");
    let site = site.take_over(unfit);
    site.check(&expect![[r#"Saved BBBBBB "same""#]]);
    let site = site.take_over(all);
    let drafts = site.set_aside();
    let draft = &drafts[0];
    let reason = draft["reason"].as_str().unwrap();
    let reason = reason.replace(&*site.server.project().to_string_lossy(), "…");
    let edits = draft["edits"].as_array().unwrap();
    let edits =
        edits.iter().map(|edit| format!("{} {} {}", edit["author"], edit["name"], edit["what"]));
    expect![[r#"
        unsaved edits of …/one cannot be applied: ROOT/GONEXX, state: there is no such state; check the machine again: it may have changed
        "engineer" "Rename" "set name ROOT/GONEXX: name \"Ann's\""
    "#]]
    .assert_eq(&format!("{reason}\n{}\n", edits.collect::<Vec<_>>().join("\n")));
    let summary = get(&site.server, &format!("/{}", site.id))["summary"].clone();
    assert_eq!((&summary["set_aside"], &draft["count"]), (&json!(1), &json!(1)));
    let path = format!("/{}/set_aside/{}", site.id, draft["id"].as_str().unwrap());
    let exported = get(&site.server, &path);
    assert_eq!(exported["lines"].as_array().unwrap().len(), 5);
    let base = exported["lines"][0]["base"].as_str().unwrap();
    assert_eq!(exported["documents"][base]["states"][1]["name"], "AAAAAA");
    let discard = |role, path: &str| {
        let path = format!("/api/v1/machines{path}");
        site.server.call(Some(role), "DELETE", &path, None).said()
    };
    assert_eq!(discard(Role::Operator, &path), "403 not_your_right");
    assert_eq!(discard(Role::Engineer, &path), "200");
    assert_eq!(discard(Role::Engineer, &path), "404 no_such_draft");
    let outside = format!("/{}/set_aside/..%2f..", site.id);
    assert_eq!(discard(Role::Engineer, &outside), "404 no_such_draft");
    let summary = get(&site.server, &format!("/{}", site.id))["summary"].clone();
    assert_eq!((&summary["set_aside"], site.set_aside()), (&json!(0), json!([])));
}
