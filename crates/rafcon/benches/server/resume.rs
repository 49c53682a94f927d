//! A run of a machine of 10,000 states with 24 active branches whose runner is killed: how long until the next script runs.

use crate::bench_server::{BenchServer, Heard, until};
use crate::clock::{noted_ms, now_ms, pass};
use crate::{percentile, print};
use anyhow::{Context as _, Result, ensure};
use rafcon_protocol::Event;
use rafcon_storage::journal::writer_of;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::json;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::time::Duration;

/// Branches that are active when the runner is killed.
const BRANCHES: usize = 24;
/// States in each of them.
const STATES: usize = 416;
/// How often it is killed: a run that dies more often in a minute is left alone.
const KILLS: usize = 5;
/// How often it is looked whether scripts run.
const POLL_INTERVAL: Duration = Duration::from_millis(1);
/// So often without an answer is never.
const POLLS_MAX: usize = 60_000;

pub(crate) fn measure(server: &BenchServer) -> Result<()> {
    let notes = server.path("notes");
    server.machine("wide", &machine(&notes)?)?;
    let start = json!({ "id": "wide", "machine": server.file("wide"), "on_crash": "restart" });
    let run = server.door().ask("POST", "/api/v1/runs", Some(&start))?;
    let run = run["id"].as_str().context("a run without an id")?.to_owned();
    until(&mut server.follow(&run)?, |_, heard| {
        let Heard::Event(entry) = heard else { return Ok(None) };
        Ok(matches!(entry.event, Event::Root { .. }).then_some(()))
    })?;
    let folder = server.path("runs").join(&run);
    let times = (1..=KILLS).map(|life| {
        noted(&notes, life * BRANCHES)?;
        let writer = writer_of(&folder)?.and_then(|pid| Pid::from_raw(pid.cast_signed()));
        let killed = now_ms();
        kill_process(writer.context("nobody runs it")?, Signal::KILL)?;
        Ok(noted(&notes, life * BRANCHES + 1)?[life * BRANCHES] - killed)
    });
    print("resume_10000_ms", percentile(times.collect::<Result<_>>()?, 50)?, "ms");
    Ok(())
}

/// When scripts began, once so many have.
fn noted(notes: &Path, count: usize) -> Result<Vec<f64>> {
    for _ in 0..POLLS_MAX {
        let text = fs::read_to_string(notes).unwrap_or_default();
        let whole = text.rsplit_once('\n').map_or("", |(whole, _)| whole);
        let times: Vec<f64> =
            whole.lines().filter_map(|line| Some(noted_ms(line.parse().ok()?))).collect();
        if times.len() >= count {
            return Ok(times);
        }
        pass(POLL_INTERVAL);
    }
    ensure!(false, "fewer than {count} scripts began");
    Ok(Vec::new())
}

/// A barrier of hierarchies whose first states note when they begin, and wait.
fn machine(notes: &Path) -> Result<String> {
    let mut text = "barrier ROOT \"Wide\"\n  outcome success\n".to_owned();
    for branch in 0..BRANCHES {
        write!(text, "  hierarchy B{branch} \"Branch {branch}\"\n    outcome success\n")?;
        writeln!(text, "    start -> S0")?;
        for state in 1..STATES {
            writeln!(text, "    S{}.success -> S{state}", state - 1)?;
        }
        writeln!(text, "    S{}.success -> .success", STATES - 1)?;
        for state in 0..STATES {
            write!(
                text,
                "    execution S{state} \"Branch {branch}, state {state}\"\n      outcome success\n"
            )?;
            writeln!(text, "      in number: int = {state}\n      script |")?;
            writeln!(text, "        # {branch}, {state}\n        import os, time")?;
            writeln!(text, "        def execute(self, inputs, outputs, gvm):")?;
            writeln!(
                text,
                "            with open({:?}, \"a\") as notes:",
                notes.display().to_string()
            )?;
            writeln!(text, "                notes.write(f\"{{time.time_ns()}}\\n\")")?;
            writeln!(text, "            self.preemptive_wait()\n            return 0")?;
        }
    }
    text += "  unique_decider_state_id.success -> .success\n";
    text += "  decider unique_decider_state_id \"Decider\"\n    outcome success\n    script |\n";
    text += "      def execute(self, inputs, outputs, gvm):\n          return 0\n";
    Ok(text)
}
