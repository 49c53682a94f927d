//! Machines with many branches under the eyes of many viewers: each run continues, and each command is answered.

use crate::harness::{Place, Run};
use crate::torture::number;
use expect_test::{Expect, expect};
use rafcon_storage::journal::folder::SOCKET_FILE;
use rustix::process::Signal;
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::io::Read as _;
use std::os::unix::net::UnixStream;

/// How many runs with 64 branches there are, where one with fewer is not enough.
const WIDE: &str = "RAFCON_TEST_WIDE";
const BRANCHES: usize = 24;
/// States of each branch.
const STATES: usize = 60;

/// A barrier of hierarchies, whose states each sleep 2 ms and are entered once; the decider does what `last` says.
fn machine(branches: usize, states: usize, last: &str) -> String {
    let mut text = "barrier ROOT \"Wide\"\n  outcome success\n".to_owned();
    text += "  unique_decider_state_id.success -> .success\n";
    for branch in 0..branches {
        writeln!(text, "  hierarchy ROW{branch}\n    outcome success\n    start -> S0").unwrap();
        for state in 1..states {
            writeln!(text, "    S{}.success -> S{state}", state - 1).unwrap();
        }
        writeln!(text, "    S{}.success -> .success", states - 1).unwrap();
        for state in 0..states {
            writeln!(text, "    execution S{state} \"Sleep\"\n      outcome success").unwrap();
            text += "      script |\n        import time\n";
            text += "        def execute(self, inputs, outputs, gvm):\n";
            text += "            time.sleep(0.002)\n            return 0\n";
        }
    }
    text += "  decider unique_decider_state_id \"Decider\"\n    outcome success\n    script |\n";
    text += "      def execute(self, inputs, outputs, gvm):\n";
    writeln!(text, "          {last}\n          return 0").unwrap();
    text
}

/// Runs it beside so many viewers, and gives it each command after a line with a word; what was answered, and how each saw the
/// end.
fn check(viewers: usize, commands: &[(&str, &str)], expect: &Expect) {
    let place = Place::with(&machine(BRANCHES, STATES, "self.preemptive_wait()"));
    let mut run = Run::start(&place, "--hold --runs runs");
    run.wait_for("\"held\"");
    let attach = "attach last --from 1 --output json --runs runs";
    let mut viewers: Vec<Run> = (0..viewers).map(|_| Run::of(place.command(attach))).collect();
    for viewer in &mut viewers {
        viewer.wait_for("\"held\"");
    }
    let mut text = String::new();
    for (until, command) in commands {
        if !until.is_empty() {
            run.wait_for(until);
        }
        let told = place.call(&format!("tell last {command} --runs runs"));
        text.extend(["> ", command, ": ", &*told.stdout, &*told.stderr]);
    }
    for seen in std::iter::once(run).chain(viewers) {
        let (_code, lines, _said) = seen.end();
        let mut events = lines.iter().map(|line| serde_json::from_str::<Value>(line).unwrap());
        let end = events.rfind(|event| event["type"] == "finished");
        let outcome = end.map(|end| end["outcome"]["name"].as_str().unwrap().to_owned());
        writeln!(text, "{}", outcome.unwrap_or_else(|| "no end".to_owned())).unwrap();
    }
    expect.assert_eq(&text);
}

/// To its last state, with a pause on the way.
const WHOLE: [(&str, &str); 4] =
    [("", "resume"), ("", "pause"), ("", "resume"), ("ROOT/unique_decider_state_id", "stop")];

#[test]
fn a_large_machine_is_kept_beside_its_first_states() {
    let place = Place::with(&machine(2, 255, "pass"));
    let answer = place.run("--runs runs");
    let events = answer.events();
    let mut kept = events.iter().filter(|event| event["type"] == "root");
    assert_eq!(kept.next().unwrap()["hash"].as_str().unwrap().len(), 64, "{}", answer.stderr);
    assert_eq!(answer.code, Some(0));
}

#[test]
fn who_connects_to_a_run_and_says_nothing_is_disconnected() {
    let place = Place::with_script("def execute(self, inputs, outputs, gvm):\n    return 0");
    let mut run = Run::start(&place, "--hold --runs runs");
    run.wait_for("\"held\"");
    let folder = fs::read_dir(place.path("runs")).unwrap().next().unwrap().unwrap().path();
    let mut silent = UnixStream::connect(folder.join(SOCKET_FILE)).unwrap();
    // The end of what the runner says.
    silent.read_to_end(&mut Vec::new()).unwrap();
    assert_eq!(place.call("tell last stop --runs runs").code, Some(0));
    run.end();
}

#[test]
fn a_wide_run_goes_on_without_viewers() {
    check(
        0,
        &WHOLE,
        &expect![[r"
            > resume: applied
            > pause: applied
            > resume: applied
            > stop: applied
            preempted
        "]],
    );
}

#[test]
fn a_wide_run_goes_on_beside_a_viewer() {
    check(
        1,
        &WHOLE,
        &expect![[r"
            > resume: applied
            > pause: applied
            > resume: applied
            > stop: applied
            preempted
            preempted
        "]],
    );
}

#[test]
fn a_wide_run_goes_on_beside_many_viewers() {
    check(
        8,
        &WHOLE,
        &expect![[r"
            > resume: applied
            > pause: applied
            > resume: applied
            > stop: applied
            preempted
            preempted
            preempted
            preempted
            preempted
            preempted
            preempted
            preempted
            preempted
        "]],
    );
}

#[test]
fn a_wide_run_beside_many_viewers_is_stopped() {
    check(
        8,
        &[("", "resume"), ("ROOT/ROW0/S5\"", "stop")],
        &expect![[r"
            > resume: applied
            > stop: applied
            preempted
            preempted
            preempted
            preempted
            preempted
            preempted
            preempted
            preempted
            preempted
        "]],
    );
}

#[test]
fn a_wide_run_ends_while_viewers_come_and_go() {
    let runs = number(WIDE).unwrap_or(0);
    let branches = if runs == 0 { BRANCHES } else { 64 };
    let place = Place::with(&machine(branches, STATES, "pass"));
    for seed in 0..runs.max(1) {
        let words = format!("--runs runs-{seed}");
        let mut run = Run::start(&place, &words);
        run.wait_for("\"left\"");
        let attach = format!("attach last --output json {words}");
        for reached in [20, 30, 40] {
            let mut viewers: Vec<Run> = (0..4).map(|_| Run::of(place.command(&attach))).collect();
            // Any branch: nobody says which of them is ahead.
            run.wait_for(&format!("/S{reached}\""));
            // One has seen nothing yet, perhaps, and one hears on until it is let go.
            viewers.pop();
            for viewer in viewers {
                viewer.signal(Signal::TERM);
            }
        }
        let (code, lines, said) = run.end();
        assert_eq!(code, Some(0), "run {seed}: {said} {:?}", lines.last());
    }
}
