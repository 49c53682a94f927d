//! Planned contacts of a station with its robot: set by a file or at the server, shown with the link, and counted in lifetimes.

use crate::harness::{Place, Run, ticks};
use crate::station::{Program, pair, robot, station, wait_at_station};
use expect_test::expect;
use serde_json::Value;
use std::fs;

const PLAN: &str = r#"[{"begin": "2126-11-28T14:00:00Z", "end": "2126-11-28T14:20:00Z", "profile": "deep", "note": "Kiruna"}]"#;
const OVERLAP: &str = r#"[{"begin": "2126-11-28T14:00:00Z", "end": "2126-11-28T14:20:00Z", "profile": "deep"},
    {"begin": "2126-11-28T14:10:00Z", "end": "2126-11-28T14:30:00Z", "profile": "deep"}]"#;

fn place() -> Place {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    fs::write(place.path("plan.json"), PLAN).unwrap();
    fs::write(place.path("overlap.json"), OVERLAP).unwrap();
    place
}

/// The windows that count, as the command prints them in JSON.
fn windows(place: &Place, more: &str) -> Value {
    let shown = place.call(&format!("contacts scout --format json --state ground {more}"));
    assert_eq!(shown.code, Some(0), "{}", shown.stderr);
    serde_json::from_str(&shown.stdout).unwrap()
}

/// Waits until the link is shown with these words.
fn wait_for_link(place: &Place, words: &str) -> String {
    loop {
        let shown = place.call("link --state ground").stdout;
        if shown.contains(words) {
            return shown;
        }
        std::thread::yield_now();
    }
}

/// Waits until the server knows the next contact of its only run: from then on, lifetimes that clients choose count from it.
fn wait_for_server(ground: &Program) {
    let ask = |path: &str| -> Value {
        let (_, answer) = ground.door.answer("GET", path, None).unwrap();
        serde_json::from_str(&answer).unwrap()
    };
    let runs = ask("/api/v1/runs");
    let path = format!("/api/v1/runs/{}", runs[0]["id"].as_str().unwrap());
    while ask(&path)["robot"]["contact"]["note"] != "Kiruna" {
        std::thread::yield_now();
    }
}

#[test]
fn contacts_are_set_by_a_file_and_at_the_server_and_a_bad_list_changes_nothing() {
    let place = place();
    let plan: Value = serde_json::from_str(PLAN).unwrap();
    let unknown = place.call("contacts mule --state ground");
    expect!["error: no robot `mule` is paired with this station: run `rafcon pair --paste` here, or name the server of the station with --server"]
        .assert_eq(unknown.stderr.trim_end());
    assert_eq!(place.call("contacts scout --state ground").stdout, "no contact planned\n");
    let set = place.call("contacts scout --set plan.json --state ground");
    assert!(set.stdout.starts_with("2126-11-28T14:00:00Z to 2126-11-28T14:20:00Z  deep  in "));
    let (ground, _) = station(&place, "127.0.0.1:0");
    let server = format!("--server {}", ground.url);
    assert_eq!([windows(&place, ""), windows(&place, &server)], [plan.clone(), plan.clone()]);
    for more in ["", &server] {
        let refused =
            place.call(&format!("contacts scout --set overlap.json --state ground {more}"));
        assert_eq!(refused.code, Some(1));
        expect![[r"
            error: overlap.json is not used
              because: window 2 (2126-11-28T14:10:00Z to 2126-11-28T14:30:00Z): it overlaps window 1 (2126-11-28T14:00:00Z to 2126-11-28T14:20:00Z): let it begin at 2126-11-28T14:20:00Z or later, or make one window of both
        "]]
        .assert_eq(&refused.stderr);
    }
    assert_eq!(windows(&place, &server), plan);
    assert_eq!(windows(&place, &format!("--clear {server}")), Value::Array(vec![]));
    assert_eq!(windows(&place, ""), Value::Array(vec![]));
    wait_for_link(&place, "no contact planned");
    // A running station reads a file that another program has changed.
    assert_eq!(windows(&place, "--set plan.json"), plan);
    let shown = wait_for_link(&place, "next contact in ");
    assert!(
        shown.contains(", 2126-11-28T14:00:00Z to 2126-11-28T14:20:00Z, profile deep (Kiruna)"),
        "{shown}"
    );
}

#[test]
fn a_command_before_a_contact_is_valid_until_after_its_begin() {
    let place = place();
    let (ground, address) = station(&place, "127.0.0.1:0");
    let _robot = robot(&place, address);
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Ticks  running");
    let server = format!("--server {} --state ground", ground.url);
    assert_eq!(
        windows(&place, &format!("--set plan.json --server {}", ground.url))
            .as_array()
            .map(Vec::len),
        Some(1)
    );
    wait_for_server(&ground);
    for at in ["--runs ground-runs", &server] {
        let refused = place.call(&format!("tell last pause --expires-in 60 {at}"));
        let said = (refused.code, refused.stderr.contains(", and the next contact begins at 2126-11-28T14:00:00Z: let it expire later than that, or change the contacts"));
        assert_eq!(said, (Some(1), true), "{}", refused.stderr);
    }
    // The plan informs: the station sends at once, and what arrives is carried out.
    assert_eq!(place.call("tell last pause --runs ground-runs").stdout, "applied\n");
    assert_eq!(place.call(&format!("tell last resume {server}")).stdout, "applied\n");
    assert_eq!(place.call("tell last stop --runs ground-runs").stdout, "applied\n");
    drop(run.end());
}
