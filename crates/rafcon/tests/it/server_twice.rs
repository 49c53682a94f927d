//! What is asked of runs twice, by two, or in vain: ids are their author's own, and what came to nothing leaves nothing. With
//! the real server and real runners.

use crate::served::Door;
use crate::server_runs::{Site, WAITS, check, command, control, is_running, said};
use expect_test::expect;
use rafcon_protocol::api::{Role, RunPhase};
use serde_json::{Value, json};
use std::path::PathBuf;

fn begun(site: &Site) -> String {
    let run = site.start("r1", &json!({}))["id"].as_str().unwrap().to_owned();
    site.until(&run, is_running);
    run
}

/// A run whose runner was killed, and the folder of it.
fn crashed(site: &Site) -> (String, PathBuf) {
    let run = begun(site);
    site.kill_runner(&run);
    site.until(&run, |now| now.run.phase == RunPhase::Crashed);
    let folder = site.place.path("runs").join(&run);
    (run, folder)
}

fn resume(site: &Site, run: &str, body: &Value) -> String {
    said(site.door(), "POST", &format!("/api/v1/runs/{run}/resume"), Some(body))
}

#[test]
fn an_id_is_its_author_s_own_and_stands_for_one_command() {
    let site = Site::new(WAITS);
    let run = begun(&site);
    let (ana, bob) = (site.door_of("ana", Role::Operator), site.door_of("bob", Role::Operator));
    let (wait, stop) = (json!({ "type": "pause" }), json!({ "type": "stop" }));
    let mut answers = vec![
        command(&ana, &run, "1", &wait),
        command(&ana, &run, "1", &wait),
        command(&ana, &run, "1", &stop),
        command(&bob, &run, "1", &stop),
    ];
    site.until(&run, |now| matches!(now.run.phase, RunPhase::Finished { .. }));
    answers.extend([
        command(&ana, &run, "1", &wait),
        command(&bob, &run, "1", &stop),
        command(&bob, &run, "2", &stop),
    ]);
    check(
        &answers,
        &expect![[r"
        200 applied
        200 applied
        200 refused
        200 applied
        200 applied
        200 applied
        409 run_is_not_live"]],
    );
    let start = json!({ "id": "r1", "machine": { "project": "project", "path": "machine" } });
    let another = ana.ask("POST", "/api/v1/runs", Some(&start)).unwrap();
    assert_ne!(another["id"], run.as_str());
    assert_eq!(site.start("r1", &json!({}))["id"], run.as_str());
}

#[test]
fn control_is_handed_over_to_nobody_who_could_not_command() {
    let site = Site::new(WAITS);
    let run = begun(&site);
    let ana = site.door_of("ana", Role::Operator);
    site.door_of("vera", Role::Viewer);
    let to = |user: &str| control(&ana, &run, &json!({ "move": "hand_over", "to": user }));
    let answers =
        [control(&ana, &run, &json!({ "move": "request" })), to("vera"), to("nobody"), to("owner")];
    check(
        &answers,
        &expect![[r"
        200 ana
        409 not_in_control
        409 not_in_control
        200 ana"]],
    );
}

#[test]
fn control_is_offered_and_accepted_and_an_admin_takes_it_from_anybody() {
    let site = Site::new(WAITS);
    let run = begun(&site);
    let door = |user: &str, role| site.door_of(user, role);
    let (ana, bob) = (door("ana", Role::Operator), door("bob", Role::Operator));
    let adam = door("adam", Role::Admin);
    let moves = |door: &Door, word: &str| control(door, &run, &json!({ "move": word }));
    let offers = || control(&ana, &run, &json!({ "move": "hand_over", "to": "bob" }));
    let answers = [
        moves(&ana, "request"),
        moves(&bob, "accept"),
        offers(),
        moves(&bob, "decline"),
        offers(),
        moves(&bob, "accept"),
        moves(&ana, "override"),
        moves(&adam, "take_over"),
        moves(&adam, "override"),
    ];
    check(
        &answers,
        &expect![[r"
        200 ana
        409 not_in_control
        200 ana
        200 ana
        200 ana
        200 bob
        403 not_your_right
        409 not_in_control
        200 adam"]],
    );
    command(&adam, &run, "stop", &json!({ "type": "stop" }));
    site.until(&run, |now| matches!(now.run.phase, RunPhase::Finished { .. }));
    let journal = site.journal(&run);
    assert!(journal.contains(&"control to adam by adam: Applied".to_owned()), "{journal:?}");
}

#[test]
fn a_resume_that_its_server_did_not_get_to_begin_is_begun_when_it_is_asked_for_again() {
    let mut site = Site::new(WAITS);
    let (run, folder) = crashed(&site);
    site.served = None;
    let file = folder.join("request.json");
    let mut request: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    request["resuming"] = json!("owner/u1");
    std::fs::write(&file, request.to_string()).unwrap();
    site.serve();
    let asked = json!({ "id": "u1", "policy": "abort" });
    let answers = [resume(&site, &run, &asked), resume(&site, &run, &asked)];
    check(
        &answers,
        &expect![[r"
        200 -
        200 -"]],
    );
    site.until(&run, |now| matches!(now.run.phase, RunPhase::Finished { .. }));
    check(
        &site.journal(&run),
        &expect![[r"
        life 2 Abort
        finished done"]],
    );
}

#[test]
fn a_resume_in_vain_leaves_a_run_as_it_was() {
    let mut site = Site::new(WAITS);
    let (run, folder) = crashed(&site);
    site.served = None;
    std::fs::remove_file(folder.join("request.json")).unwrap();
    site.serve();
    let nowhere = json!({ "id": "u1", "policy": "abort", "from": 99_999 });
    let refused = resume(&site, &run, &nowhere);
    assert!(!folder.join("request.json").exists());
    site.until(&run, |now| now.run.phase == RunPhase::Crashed);
    let answers = [refused, resume(&site, &run, &json!({ "id": "u1", "policy": "abort" }))];
    check(
        &answers,
        &expect![[r"
        422 load_failed
        200 -"]],
    );
    site.until(&run, |now| matches!(now.run.phase, RunPhase::Finished { .. }));
}
