//! Runs that users of a station start on a robot far away.

use crate::harness::Place;
use crate::station::{Program, pair_with, robot_with, station, wait_at_station};
use expect_test::expect;
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::process::Stdio;
use std::thread;

const WAITS: &str = r#"
hierarchy WAITSS "Waits"
  outcome success
  in rounds: int = "1"
  start -> WAITXX
  WAITXX.success -> .success
  flow .rounds -> WAITXX.rounds
  execution WAITXX "Wait"
    outcome success
    in rounds: int = "1"
    script |
      def execute(self, inputs, outputs, gvm):
          print("rounds", inputs["rounds"])
          self.preemptive_wait()
          return "success"
"#;

/// A robot that has a project `missions` with the machine `waits`.
fn robot(place: &Place, station: SocketAddr) -> Program {
    let missions = place.path("missions");
    robot_with(place, &format!("--station udp://{station} {}", missions.display()))
}

fn place(rights: &str) -> Place {
    let place = Place::with(WAITS);
    std::fs::create_dir(place.path("missions")).unwrap();
    std::fs::rename(place.machine(), place.path("missions/waits")).unwrap();
    pair_with(&place, &format!("scout --rights {rights}"), "ground");
    place
}

/// Asks the station to have its robot start a machine.
fn start(ground: &Program, id: &str, path: &str) -> (u16, Value) {
    let body = json!({ "id": id, "machine": { "project": "missions", "path": path }, "inputs": { "rounds": 7 } });
    ask(ground, "/api/v1/robots/scout/runs", &body)
}

/// Asks until the machine is started; returns the id of the request with its answer.
fn start_until_known(ground: &Program) -> (String, Value) {
    let mut nth = 1;
    loop {
        let id = format!("request-{nth}");
        let (status, answer) = start(ground, &id, "waits");
        match answer["code"].as_str() {
            None if status == 200 => return (id, answer),
            // It was for the start of the robot before, which has not received it.
            Some("expired") => nth += 1,
            Some("fate_unknown" | "not_finished") => {}
            _ => panic!("{status} {answer}"),
        }
    }
}

fn ask(ground: &Program, path: &str, body: &Value) -> (u16, Value) {
    let (status, answer) = ground.door.answer("POST", path, Some(body)).unwrap();
    (status, serde_json::from_str(&answer).unwrap())
}

fn runs_of_robot(place: &Place) -> usize {
    std::fs::read_dir(place.path("robot-runs")).map_or(0, Iterator::count)
}

fn wait_for_log(place: &Place, words: &str) {
    while !place.call("log last --runs ground-runs").stdout.contains(words) {
        thread::yield_now();
    }
}

#[test]
fn a_run_is_started_from_the_station_once_for_each_request_and_started_again() {
    let place = place("command");
    let (ground, address) = station(&place, "127.0.0.1:0");
    let _robot = robot(&place, address);
    let (status, first) = start(&ground, "one", "waits");
    assert_eq!((status, &first["robot"]), (200, &json!("scout")), "{first}");
    wait_at_station(&place, "Waits  running at scout, newest event arrived ");
    wait_for_log(&place, "rounds 7");
    // An answer that was lost is asked for again.
    assert_eq!(start(&ground, "one", "waits"), (200, first.clone()));
    assert_eq!(runs_of_robot(&place), 1);
    let run = first["run"].as_str().unwrap();
    assert_eq!(place.call(&format!("tell {run} stop --runs ground-runs")).stdout, "applied\n");
    wait_at_station(&place, "Waits  ended with");
    let again = place.call(&format!("again {run} --server {} --state ground", ground.url));
    assert_eq!(again.code, Some(0), "{}", again.stderr);
    assert!(again.stderr.contains("robot scout has started "), "{}", again.stderr);
    let second = again.stdout.trim().to_owned();
    assert_ne!(second, run);
    // The request from above, whose answer was lost: nothing begins.
    let words = format!("again {run} --request one --output json --server {}", ground.url);
    let [once, twice] = [(); 2].map(|()| place.call(&format!("{words} --state ground")).stdout);
    assert_eq!((&once, once.contains(&format!(r#""run":"{run}""#))), (&twice, true));
    wait_at_station(&place, "Waits  running");
    wait_for_log(&place, "rounds 7");
    assert_eq!(runs_of_robot(&place), 2);
    drop(place.call("tell last stop --runs ground-runs"));
    wait_at_station(&place, "Waits  ended with");
    let words = format!("run missions/waits --robot scout --server {} --state ground", ground.url);
    let third = place.call(&format!("{words} --input rounds=9"));
    assert_eq!(third.code, Some(0), "{}", third.stderr);
    wait_for_log(&place, "rounds 9");
    drop(place.call("tell last stop --runs ground-runs"));
    wait_at_station(&place, "Waits  ended with");
}

/// Waits until the command prints other machines than these; returns the lines after the age.
fn other_machines(place: &Place, more: &str, before: &str) -> String {
    loop {
        let shown = place.call(&format!("machines scout --state ground {more}"));
        let lines = match shown.stdout.split_once('\n') {
            Some((age, lines)) => {
                assert!(age.ends_with("Z by the robot's calendar"), "{age}");
                lines.to_owned()
            }
            None => shown.stderr,
        };
        if lines != before {
            return lines;
        }
        thread::yield_now();
    }
}

#[test]
fn the_station_lists_the_machines_of_its_robot_after_each_change() {
    let place = place("observe");
    let nobody = place.call("machines mule --state ground");
    expect!["error: no robot `mule` is paired with this station: run `rafcon pair --paste` here, or name the server of the station with --server"]
        .assert_eq(nobody.stderr.trim_end());
    let (ground, address) = station(&place, "127.0.0.1:0");
    let at_server = format!("--server {}", ground.url);
    let unknown = "error: robot scout: no list of its machines has arrived yet: repeat this once there is a signal of the robot, or start a machine by its path\n";
    for more in ["", &at_server] {
        assert_eq!(other_machines(&place, more, ""), unknown);
    }
    let robot = robot(&place, address);
    assert_eq!(other_machines(&place, &at_server, unknown), "missions/waits\n");
    assert_eq!(other_machines(&place, "", unknown), "missions/waits\n");
    std::fs::rename(place.path("missions/waits"), place.path("missions/other")).unwrap();
    assert_eq!(other_machines(&place, &at_server, "missions/waits\n"), "missions/other\n");
    // A station that starts again has the list, whether there is a signal or not.
    drop((robot, ground));
    let (ground, _) = station(&place, "127.0.0.1:0");
    let at_server = format!("--server {}", ground.url);
    assert_eq!(other_machines(&place, &at_server, ""), "missions/other\n");
    let json = place.call(&format!("machines scout --format json --state ground {at_server}"));
    let list: Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(list["machines"], json!([{ "project": "missions", "path": "other" }]));
    assert_eq!(list["more"], 0);
}

#[test]
fn what_a_robot_does_not_start_is_refused_with_the_reason() {
    let mut said = Vec::new();
    let mut note = |what: &str, (status, answer): (u16, Value)| {
        let message = answer["message"].as_str().unwrap();
        let message = message.split_once("/missions/").map_or(message, |(_, words)| words);
        said.push(format!("{what}: {status} {} {message}\n", answer["code"]));
    };
    for rights in ["observe", "command"] {
        let place = place(rights);
        let (ground, address) = station(&place, "127.0.0.1:0");
        let robot = robot(&place, address);
        note(rights, start(&ground, "one", if rights == "observe" { "waits" } else { "gone" }));
        if rights == "command" {
            let machine = json!({ "project": "missions", "path": "../outside" });
            let body = json!({ "id": "two", "machine": machine });
            note("outside", ask(&ground, "/api/v1/robots/scout/runs", &body));
            note("nobody", ask(&ground, "/api/v1/robots/rover/runs", &body));
            let machine = json!({ "project": "missions", "path": "waits" });
            let breakpoint = json!({ "id": 1, "path": "WAITSS", "condition": "True" });
            let body = json!({ "id": "three", "machine": machine, "breakpoints": [breakpoint] });
            note("condition", ask(&ground, "/api/v1/robots/scout/runs", &body));
        }
        assert_eq!(runs_of_robot(&place), 0);
        if rights == "command" {
            let mut run = place.command("run missions/waits --runs robot-runs --timeout 600");
            let mut run = run.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
            wait_at_station(&place, "Waits  running");
            let id = std::fs::read_dir(place.path("robot-runs")).unwrap().next().unwrap().unwrap();
            let again = format!("/api/v1/runs/{}/again", id.file_name().display());
            note("by hand", ask(&ground, &again, &json!({ "id": "four" })));
            drop(place.call("tell last stop --runs ground-runs"));
            run.wait().unwrap();
        }
        drop(robot);
    }
    expect![[r#"
        observe: 409 "refused_by_robot" scout: the pairing of this station allows `observe`, and this needs `command`: pair again with `rafcon pair NAME --rights command` on the robot
        command: 409 "refused_by_robot" gone does not exist; give the folder of a state machine or a file in it
        outside: 409 "refused_by_robot" scout: `../outside` is not a path in a project: names joined by `/`, none of them hidden (with a dot in front), no `/` at the beginning, 4096 bytes at most
        nobody: 404 "no_such_robot" robot rover: this server does not receive the robot now: run it as its station (`rafcon station`)
        condition: 409 "refused_by_robot" scout: the pairing of this station allows `command`, and this needs `change`: pair again with `rafcon pair NAME --rights change` on the robot
        by hand: 409 "refused_by_robot" scout: the run was started without the server, which does not know its inputs: start the machine missions/waits
    "#]].assert_eq(&said.concat());
}

#[test]
fn a_start_that_the_robot_hears_after_a_restart_is_carried_out_once() {
    let place = place("command");
    let (ground, address) = station(&place, "127.0.0.1:0");
    drop(robot(&place, address));
    let (id, answer) = thread::scope(|scope| {
        let asked = scope.spawn(|| start_until_known(&ground));
        let robot = robot(&place, address);
        let answer = asked.join().unwrap();
        drop(robot);
        answer
    });
    let _robot = robot(&place, address);
    wait_at_station(&place, "Waits  running");
    assert_eq!(start(&ground, &id, "waits"), (200, answer));
    assert_eq!(runs_of_robot(&place), 1);
    drop(place.call("tell last stop --runs ground-runs"));
    wait_at_station(&place, "Waits  ended with");
}
