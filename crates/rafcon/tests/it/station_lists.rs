//! Lists of timed commands for a robot: set, reviewed and released as one at its station, and carried out once by the robot.

use crate::harness::{Place, Run, ticks};
use crate::station::{
    Program, history, pair_with, robot, station, wait_at_station, wait_for_control,
};
use expect_test::expect;
use rafcon_protocol::calendar::utc_text;
use rafcon_supervisor::clock;
use serde_json::{Value, json};
use std::fs;
use std::net::SocketAddr;
use std::thread;

const ROUTE: &str = "/api/v1/robots/scout/commands";

fn place(rights: &str) -> Place {
    let place = Place::with(&ticks(1_000_000));
    pair_with(&place, &format!("scout --rights {rights}"), "ground");
    place
}

/// A station and its robot with a run, and the id of the run. The station knows the delay.
fn flight(place: &Place) -> (Program, SocketAddr, Program, Run, String) {
    let (ground, address) = station(place, "127.0.0.1:0");
    let robot = robot(place, address);
    let run = Run::start(place, "--runs robot-runs");
    wait_at_station(place, "Ticks  running");
    while !place.call("link --state ground").stdout.contains("the round trip takes") {
        thread::yield_now();
    }
    let replica = fs::read_dir(place.path("ground-runs")).unwrap().next().unwrap().unwrap();
    (ground, address, robot, run, replica.file_name().into_string().unwrap())
}

/// The list. A station that has just started receives its robot a moment later.
fn get(ground: &Program) -> Value {
    loop {
        let (status, answer) = ground.door.answer("GET", ROUTE, None).unwrap();
        match status {
            404 => thread::yield_now(),
            _ => return serde_json::from_str(&answer).unwrap(),
        }
    }
}

/// Sets the list; answers its revision.
fn set(ground: &Program, list: &Value) -> String {
    let list = ground.door.ask("PUT", ROUTE, Some(list)).unwrap();
    list["revision"].as_str().unwrap().to_owned()
}

fn release(ground: &Program, revision: &str) -> (u16, Value) {
    let (path, body) = (format!("{ROUTE}/release"), json!({ "revision": revision }));
    let (status, answer) = ground.door.answer("POST", &path, Some(&body)).unwrap();
    (status, serde_json::from_str(&answer).unwrap())
}

fn refused((status, answer): &(u16, Value), run: &str) -> String {
    let message = answer["message"].as_str().unwrap().replace(run, "RUN");
    format!("{status} {} {message}\n", answer["code"])
}

/// The fates of a list: the answer, or the stage of a command without one.
fn fates(list: &Value) -> Vec<String> {
    let lines = list["lines"].as_array().unwrap();
    let fate = |line: &Value| {
        let fate = &line["fate"];
        let known = fate["answer"]["answer"].as_str().or(fate["stage"].as_str());
        known.unwrap_or("none").to_owned()
    };
    lines.iter().map(fate).collect()
}

fn wait_for_fates(ground: &Program, wanted: &[&str]) -> Value {
    loop {
        let list = get(ground);
        if fates(&list) == wanted {
            return list;
        }
        thread::yield_now();
    }
}

/// Ids and types of the listed commands in the record of the robot's run, in the order in which they were carried out.
fn carried_out(place: &Place) -> Vec<(String, String)> {
    let events = history(place, "robot-runs");
    let events = events.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let listed = |event: Value| {
        let envelope = &event["event"]["envelope"];
        let id = envelope["id"].as_str()?.strip_prefix("//list/")?.to_owned();
        Some((id, envelope["command"]["type"].as_str()?.to_owned()))
    };
    events.filter_map(listed).collect()
}

#[test]
fn a_list_is_set_by_a_file_and_at_the_server_and_a_bad_one_changes_nothing() {
    let place = place("command");
    assert_eq!(place.call("commands scout --state ground").stdout, "no commands listed\n");
    let list = json!([
        { "run": "gone", "command": { "type": "pause" }, "not_before": "2126-11-28T14:05:00Z" },
        { "run": "gone", "command": { "type": "step_mode" }, "not_before": { "contact": "2126-11-28T15:00:00Z", "after_s": 30 } },
    ]);
    fs::write(place.path("list.json"), list.to_string()).unwrap();
    let set = place.call("commands scout --set list.json --format json --state ground");
    assert_eq!(serde_json::from_str::<Value>(&set.stdout).unwrap(), list);
    expect!["1 line with a fault: none of the commands is sent before it is corrected"]
        .assert_eq(set.stderr.trim_end());
    let offline = place.call("commands scout --release --state ground");
    assert_eq!(offline.code, Some(2), "{}", offline.stderr);
    let (ground, _) = station(&place, "127.0.0.1:0");
    assert_eq!(get(&ground)["lines"].as_array().map(Vec::len), Some(2));
    let server = format!("--server {} --state ground", ground.url);
    let shown = |more: &str| place.call(&format!("commands scout --format json {more}")).stdout;
    assert_eq!([shown(&server), shown("--state ground")], [(); 2].map(|()| set.stdout.clone()));
    fs::write(
        place.path("bad.json"),
        r#"[{"run": "a", "command": {"type": "pause"}, "expiry": "noon"}]"#,
    )
    .unwrap();
    for more in ["--state ground", &server] {
        let bad = place.call(&format!("commands scout --set bad.json {more}"));
        assert_eq!(bad.code, Some(1));
        expect![[r#"
            error: bad.json is not used
              because: line 1: expiry: "noon" is no time in UTC: write it like 2026-11-28T14:00:00Z
        "#]]
        .assert_eq(&bad.stderr);
    }
    let many = Value::Array(vec![list[0].clone(); 101]);
    let answer = ground.door.answer("PUT", ROUTE, Some(&many)).unwrap();
    assert_eq!((answer.0, answer.1.contains("the limit is 100")), (400, true), "{}", answer.1);
    assert_eq!(shown(&server), set.stdout);
    // Nothing is known of the run, and no contact is planned: nothing is sent.
    let revision = get(&ground)["revision"].as_str().unwrap().to_owned();
    let faults = refused(&release(&ground, &revision), "no run");
    expect![[r#"
        409 "command_list_faulty" robot scout: nothing was sent, because of these faults:
        line 1 (pause of run gone): the station has no open run of this robot with this id: write an id of `rafcon runs`
        line 2 (step_mode of run gone): no planned contact begins at 2126-11-28T15:00:00Z: choose a contact of `rafcon contacts`
    "#]].assert_eq(&faults);
    let clear = place.call(&format!("commands scout --clear {server}"));
    assert_eq!((clear.code, clear.stdout.as_str()), (Some(0), "no commands listed\n"));
    assert_eq!(refused(&release(&ground, &revision), "no run").split(' ').next(), Some("409"));
}

#[test]
fn a_released_list_is_carried_out_once_and_not_before_its_times() {
    let place = place("command");
    let (ground, _, _robot, run, id) = flight(&place);
    let begin_ms = clock::since_1970_ms() + 8_000;
    let list = json!([
        { "run": id, "command": { "type": "pause" } },
        { "run": id, "command": { "type": "resume" }, "not_before": utc_text(begin_ms) },
    ]);
    let before = set(&ground, &json!([{ "run": id, "command": { "type": "stop" } }]));
    let revision = set(&ground, &list);
    // The list that was reviewed is another one: nothing is sent.
    let stale = refused(&release(&ground, &before), &id);
    expect![[r#"
        409 "command_list_changed" robot scout: the list was changed since it was reviewed: nothing was sent; review it again
    "#]].assert_eq(&stale);
    assert_eq!(carried_out(&place), []);
    let shown = get(&ground);
    assert!(shown["lines"][1]["effect_ms"].as_u64() >= Some(begin_ms), "{shown}");
    let released = place.call(&format!(
        "commands scout --release={revision} --server {} --state ground",
        ground.url
    ));
    assert_eq!(released.code, Some(0), "{}", released.stderr);
    assert!(released.stdout.starts_with(&format!("list {revision}, released by owner at ")));
    // The second one waits at the robot for its time.
    wait_for_fates(&ground, &["applied", "received"]);
    assert_eq!(release(&ground, &revision).0, 200);
    wait_for_fates(&ground, &["applied", "applied"]);
    assert!(clock::since_1970_ms() >= begin_ms);
    assert_eq!(release(&ground, &revision).0, 200);
    let once = [("1", "pause"), ("2", "resume")]
        .map(|(line, kind)| (format!("{revision}/{line}"), kind.to_owned()));
    assert_eq!(carried_out(&place), once);
    // The fates stay until another list is set.
    let again = set(&ground, &list);
    assert_ne!(again, revision);
    assert!(get(&ground)["released"].is_null());
    let stop = set(&ground, &json!([{ "run": id, "command": { "type": "stop" } }]));
    assert_eq!(release(&ground, &stop).0, 200);
    drop(run.end());
    wait_for_fates(&ground, &["applied"]);
}

#[test]
fn a_station_that_is_killed_during_a_release_sends_each_command_once() {
    let place = place("command");
    let (ground, address, _robot, run, id) = flight(&place);
    let now_ms = clock::since_1970_ms();
    let expiry = utc_text(now_ms + 3_600_000);
    let revision = set(
        &ground,
        &json!([
            { "run": id, "command": { "type": "pause" }, "expiry": expiry },
            { "run": id, "command": { "type": "step_mode" }, "not_before": utc_text(now_ms + 8_000), "expiry": expiry },
        ]),
    );
    let file = place.path("ground/link/station/scout/commands.json");
    let (door, wanted) = (ground.door.clone(), revision.clone());
    let asked = thread::Builder::new().spawn(move || {
        let body = json!({ "revision": wanted });
        drop(door.answer("POST", &format!("{ROUTE}/release"), Some(&body)));
    });
    while !fs::read_to_string(&file).unwrap().contains("\"released\"") {
        thread::yield_now();
    }
    drop(ground);
    asked.unwrap().join().unwrap();
    let (ground, _) = station(&place, &address.to_string());
    let list = get(&ground);
    assert_eq!(
        (list["revision"].as_str(), list["released"]["user"].as_str()),
        (Some(&*revision), Some("owner"))
    );
    // Until the robot is heard again nothing can be sent, and the refusal says so.
    while release(&ground, &revision).0 != 200 {
        thread::yield_now();
    }
    wait_for_fates(&ground, &["applied", "applied"]);
    assert_eq!(release(&ground, &revision).0, 200);
    let once = [("1", "pause"), ("2", "step_mode")]
        .map(|(line, kind)| (format!("{revision}/{line}"), kind.to_owned()));
    assert_eq!(carried_out(&place), once);
    drop(place.call("tell last stop --runs robot-runs"));
    drop(run.end());
    wait_at_station(&place, "Ticks  ended with");
    // After another restart, the record of the run has the fates.
    drop(ground);
    let (ground, _) = station(&place, &address.to_string());
    wait_for_fates(&ground, &["applied", "applied"]);
}

/// Writes the mark of a release into the file of the list, as a station that is killed before it sends anything leaves it.
fn mark_as_released(place: &Place, revision: &str) {
    let file = place.path("ground/link/station/scout/commands.json");
    let mut list: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    let now_ms = clock::since_1970_ms();
    let times = json!([{ "expiry_ms": now_ms + 3_600_000 }]);
    list["released"] =
        json!({ "revision": revision, "at_ms": now_ms, "user": "ana", "times": times });
    fs::write(file, list.to_string()).unwrap();
}

#[test]
fn a_release_that_was_cut_before_it_sent_anything_is_completed_by_the_next_one() {
    let place = place("command");
    let (ground, address, _robot, run, id) = flight(&place);
    let pause = json!([{ "run": id, "command": { "type": "pause" } }]);
    let revision = set(&ground, &pause);
    drop(ground);
    mark_as_released(&place, &revision);
    let (ground, _) = station(&place, &address.to_string());
    let list = get(&ground);
    assert_eq!(
        (&list["released"]["user"], fates(&list)),
        (&json!("ana"), vec!["unknown".to_owned()])
    );
    while release(&ground, &revision).0 != 200 {
        thread::yield_now();
    }
    wait_for_fates(&ground, &["applied"]);
    let once = [(format!("{revision}/1"), "pause".to_owned())];
    assert_eq!(carried_out(&place), once);
    // Once the run is over there is nothing to send, and the fate stays unknown.
    let late = set(&ground, &pause);
    drop(place.call("tell last stop --runs robot-runs"));
    drop(run.end());
    wait_at_station(&place, "Ticks  ended with");
    drop(ground);
    mark_as_released(&place, &late);
    let (ground, _) = station(&place, &address.to_string());
    while !get(&ground).to_string().contains("the run is over, and its record has no answer") {
        thread::yield_now();
    }
    assert_eq!(release(&ground, &late).0, 200);
    assert_eq!(fates(&get(&ground)), ["unknown"]);
    assert_eq!(carried_out(&place), once);
}

#[test]
fn a_list_with_a_fault_sends_nothing_and_names_all_faults() {
    let place = place("command");
    let (ground, _, robot, run, id) = flight(&place);
    let take = format!("control last take-over --server {} --state robot", robot.url);
    drop(place.call(&take));
    drop(place.call(&format!("tell last resume --server {} --state robot", robot.url)));
    wait_for_control(&place, "ground", &ground.url, "owner@robot is in control");
    let pass_ms = clock::since_1970_ms() / 1_000 * 1_000 + 86_400_000;
    let [pass, late, early] =
        [0, 60_000, -3_600_000_i64].map(|ms| utc_text(pass_ms.saturating_add_signed(ms)));
    fs::write(
        place.path("plan.json"),
        json!([{ "begin": pass, "end": late, "profile": "deep" }]).to_string(),
    )
    .unwrap();
    let contacts = format!("contacts scout --set plan.json --server {} --state ground", ground.url);
    assert_eq!(place.call(&contacts).code, Some(0));
    let at = |after_s: u64| json!({ "contact": pass, "after_s": after_s });
    let script = json!({ "type": "edit_script", "path": "ROOT/TICKXX", "script": "" });
    let revision = set(
        &ground,
        &json!([
            { "run": id, "command": { "type": "pause" }, "not_before": at(1) },
            { "run": id, "command": { "type": "resume" }, "not_before": at(2) },
            { "run": id, "command": script, "not_before": at(3) },
            { "run": id, "command": { "type": "pause" }, "not_before": at(3) },
            { "run": id, "command": { "type": "pause" }, "not_before": at(9), "expiry": at(8) },
            { "run": id, "command": { "type": "pause" }, "not_before": "2020-01-01T00:00:00Z" },
            { "run": "gone", "command": { "type": "pause" }, "expiry": early },
            { "run": "mule", "command": { "type": "pause" } },
            { "run": id, "command": { "type": "pause" }, "not_before": { "contact": late, "after_s": 1 } },
            { "run": id, "command": { "type": "control" }, "not_before": at(20) },
        ]),
    );
    let mut faults = refused(&release(&ground, &revision), &id);
    let times = [(0, "PASS"), (8, "PASS+8"), (9, "PASS+9"), (60, "PASS+60")];
    for (after_s, name) in times {
        faults = faults.replace(&utc_text(pass_ms + after_s * 1_000), name);
    }
    let faults = faults.replace(&early, "EARLY");
    expect![[r#"
        409 "command_list_faulty" robot scout: nothing was sent, because of these faults:
        line 2 (resume of run RUN): owner@robot holds control of the run: request control, then release the list
        line 3 (edit_script of run RUN): the pairing of this station allows `command`, and this needs `change`: pair again with `rafcon pair NAME --rights change` on the robot
        line 4 (pause of run RUN): it has no later time than line 3 of this run: give it a later not_before, or move it up
        line 5 (pause of run RUN): it expires at PASS+8 and takes effect at PASS+9 at the earliest: correct one of the times
        line 6 (pause of run RUN): its time 2020-01-01T00:00:00Z is past: choose a later one
        line 7 (pause of run gone): the command would expire at EARLY, and the next contact begins at PASS: let it expire later than that, or change the contacts
        line 8 (pause of run mule): the station has no open run of this robot with this id: write an id of `rafcon runs`
        line 9 (pause of run RUN): no planned contact begins at PASS+60: choose a contact of `rafcon contacts`
        line 10 (control of run RUN): control is requested, handed over and released, not set
    "#]].assert_eq(&faults);
    assert!(get(&ground)["released"].is_null());
    let stop = set(&ground, &json!([{ "run": id, "command": { "type": "stop" } }]));
    // A stop needs no control, and outside of contacts it is sent at once.
    assert_eq!(release(&ground, &stop).0, 200);
    wait_for_fates(&ground, &["applied"]);
    drop(run.end());
    assert_eq!(carried_out(&place), [(format!("{stop}/1"), "stop".to_owned())]);
}

#[test]
fn a_pairing_that_lets_a_station_only_observe_releases_nothing() {
    let place = place("observe");
    let (ground, _, _robot, run, id) = flight(&place);
    let revision = set(&ground, &json!([{ "run": id, "command": { "type": "stop" } }]));
    let faults = refused(&release(&ground, &revision), &id);
    expect![[r#"
        409 "command_list_faulty" robot scout: nothing was sent, because of these faults:
        line 1 (stop of run RUN): the pairing of this station allows `observe`, and this needs `command`: pair again with `rafcon pair NAME --rights command` on the robot
    "#]].assert_eq(&faults);
    assert_eq!(carried_out(&place), []);
    drop(place.call("tell last stop --runs robot-runs"));
    drop(run.end());
}
