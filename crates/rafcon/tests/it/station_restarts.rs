//! A station of several robots that is killed at any moment: after each start it shows every run as it is at its robot.
//! `RAFCON_TEST_ROBOTS` and `RAFCON_TEST_RESTARTS` set how many; the seed is that of the date, or `RAFCON_TEST_SEED`.

use crate::harness::{Place, Run, ticks};
use crate::station::{Program, pair_of, robot_of, station};
use crate::torture::{Dice, first_seed, number};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::thread;

const ROBOTS: &str = "RAFCON_TEST_ROBOTS";
const RESTARTS: &str = "RAFCON_TEST_RESTARTS";

/// Each run at the station with its phase.
fn phases(ground: &Program) -> Vec<(String, String)> {
    let (_status, runs) = ground.door.answer("GET", "/api/v1/runs", None).unwrap();
    let runs: Vec<Value> = serde_json::from_str(&runs).unwrap();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    runs.iter().map(|run| (text(&run["id"]), text(&run["phase"]))).collect()
}

/// Asks for the phases until this many runs are live, and returns how many were shown as something else meanwhile.
#[expect(clippy::print_stderr, reason = "a failure names the runs")]
fn wrong_until(ground: &Program, live: usize) -> usize {
    let mut wrong = BTreeMap::new();
    loop {
        let phases = phases(ground);
        for (run, phase) in phases.iter().filter(|(_, phase)| phase != "live") {
            wrong.entry(run.clone()).or_insert_with(|| phase.clone());
        }
        if phases.iter().filter(|(_, phase)| phase == "live").count() >= live {
            break;
        }
        thread::yield_now();
    }
    if !wrong.is_empty() {
        eprintln!("shown as something else than live: {wrong:?}");
    }
    wrong.len()
}

#[test]
fn a_station_that_starts_again_never_shows_a_living_run_as_something_else() {
    let (robots, restarts) = (number(ROBOTS).unwrap_or(3), number(RESTARTS).unwrap_or(6));
    let place = Place::with(&ticks(100_000_000));
    let names: Vec<_> = (0..robots).map(|nth| format!("scout{nth}")).collect();
    for name in &names {
        pair_of(&place, name, name, "ground");
    }
    let (mut ground, address) = station(&place, "127.0.0.1:0");
    let _servers: Vec<_> = names.iter().map(|name| robot_of(&place, name, address)).collect();
    // They do not end.
    let begin = |name: &String| Run::start(&place, &format!("--runs {name}-runs"));
    let runs: Vec<_> = names.iter().map(begin).collect();
    wrong_until(&ground, runs.len());
    let (mut dice, mut wrong) = (Dice(first_seed()), 0);
    for _restart in 0..restarts {
        drop(ground);
        ground = station(&place, &address.to_string()).0;
        // Some of them are live again when the next one comes.
        let live = usize::try_from(dice.roll(robots + 1)).unwrap();
        wrong += wrong_until(&ground, live);
    }
    wrong += wrong_until(&ground, runs.len());
    println!("{}", json!({ "name": "station_restart_wrong_runs", "value": wrong, "unit": "runs" }));
    for name in &names {
        let folder = format!("{name}-runs");
        let id = std::fs::read_dir(place.path(&folder)).unwrap().next().unwrap().unwrap();
        let id = id.file_name().into_string().unwrap();
        // Commands reach each of them.
        for words in ["pause --runs ground-runs".to_owned(), format!("stop --runs {folder}")] {
            let told = place.call(&format!("tell {id} {words}"));
            assert_eq!((told.stderr.as_str(), told.stdout.as_str()), ("", "applied\n"), "{words}");
        }
    }
    for run in runs {
        drop(run.end());
    }
    assert_eq!(wrong, 0);
}
