//! A process that saves repeatedly is killed at arbitrary moments. The disk then has one of its machines.

use crate::folders::read;
use rafcon_model::Machine;
use rafcon_storage::{Libraries, Naming, save};
use rafcon_testkit::notation;
use std::env;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};

/// Variable with the folder for the child process. Not set in a normal test run.
const FOLDER: &str = "RAFCON_TEST_SAVE_UNTIL_KILLED";
/// Variable with the number of kills. The default is 12.
const KILLS: &str = "RAFCON_TEST_KILLS";

/// Two machines that differ in many files.
fn machines() -> [Machine; 2] {
    [("one", 40), ("other", 60)].map(|(name, count)| {
        let state = |n: i32| format!("  execution S{n} \"{name} {n}\"\n    script \"{name}\\n\"\n");
        let states = (0..count).map(state).collect::<Vec<_>>().concat();
        let head = "machine\n  created \"now\"\n  writer \"2.2.0\"\n";
        notation::parse(&format!("{head}hierarchy ROOTID \"{name}\"\n{states}")).unwrap()
    })
}

/// The child process. Has no effect in a normal test run.
#[test]
fn saves_until_it_is_killed() {
    let Some(dir) = env::var_os(FOLDER) else { return };
    let mut saved = None;
    for machine in machines().iter().cycle() {
        saved = Some(save(machine, Path::new(&dir), saved.as_ref(), Naming::default()).unwrap());
        let mut out = std::io::stdout();
        out.write_all(b"saved\n").and_then(|()| out.flush()).unwrap();
    }
}

#[test]
fn a_killed_process_leaves_one_of_its_machines() {
    let machines = machines();
    let kills =
        env::var_os(KILLS).map_or(12, |kills| kills.to_str().unwrap().parse::<usize>().unwrap());
    for round in 0..kills {
        let dir = tempfile::tempdir().unwrap();
        let mut child = Command::new(env::current_exe().unwrap())
            .args(["--exact", "kill::saves_until_it_is_killed", "--nocapture"])
            .env(FOLDER, dir.path())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let saved = lines.map_while(Result::ok).filter(|line| line.ends_with("saved"));
        let count = saved.take(1 + round % 3).count();
        child.kill().unwrap();
        child.wait().unwrap();
        assert_eq!(count, 1 + round % 3);
        let found = read(dir.path(), &Libraries::default());
        assert_eq!(found.problems, []);
        assert!(machines.contains(&found.machine));
    }
}
