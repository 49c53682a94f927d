//! Runners killed in the middle of a run, at moments that nobody chose: what anybody was told is in the journal, and the run
//! comes to an end that its machine allows, with the data it had.

use crate::harness::{Answer, Place, Run};
use rustix::process::{Signal, kill_process};
use serde_json::Value;
use std::env;
use std::io::Write as _;

/// How often a runner is killed, where a few times are not enough.
const KILLS: &str = "RAFCON_TEST_KILLS";
/// Lines that a whole run prints, about.
const LINES: u64 = 700;

/// Counts to 40, each time through a barrier; whatever is aborted recovers and counts on. Data of several kinds goes round,
/// and a script that gets other data than it should leaves by `wrong`.
pub(crate) const MACHINE: &str = r#"
hierarchy ROOT "Torture"
  outcome success
  outcome wrong
  out total: int
  out sides: int
  var n: int = 0
  var bag: dict = {}
  var sides: int = 0
  start -> COUNTX
  COUNTX.more -> FORKED ; COUNTX.done -> .success ; COUNTX.wrong -> .wrong
  COUNTX.aborted -> RECOVR
  FORKED.success -> COUNTX ; FORKED.aborted -> RECOVR
  RECOVR.success -> COUNTX ; RECOVR.aborted -> RECOVR
  flow .n -> COUNTX.n ; .bag -> COUNTX.bag
  flow COUNTX.n -> .n ; COUNTX.bag -> .bag
  flow .n -> FORKED.n ; FORKED.sides -> .sides
  flow .n -> .total ; .sides -> .sides
  execution COUNTX "Count"
    outcome more
    outcome done
    outcome wrong
    in n: int = 0
    in bag: dict
    out n: int
    out bag: dict
    script |
      import datetime
      def bag(n):
          return {"n": n, "day": datetime.date(2026, 1, 1 + n % 28), "set": {n, n + 1}, "text": "x" * 100}
      def execute(self, inputs, outputs, gvm):
          n = inputs["n"]
          if n and inputs["bag"] != bag(n):
              return "wrong"
          if gvm.get_variable("n", default=n) not in (n, n + 1):
              return "wrong"
          self.preemptive_wait(0.001)
          gvm.set_variable("n", n + 1)
          outputs["n"] = n + 1
          outputs["bag"] = bag(n + 1)
          return "done" if n + 1 >= 40 else "more"
  execution RECOVR "Recover"
    outcome success
    script |
      def execute(self, inputs, outputs, gvm):
          self.preemptive_wait(0.001)
          return 0
  barrier FORKED "Both sides"
    outcome success
    in n: int
    out sides: int
    unique_decider_state_id.success -> .success
    unique_decider_state_id.lost -> .aborted
    flow .n -> LEFTXX.n
    flow LEFTXX.n -> unique_decider_state_id.n
    flow unique_decider_state_id.n -> .sides
    execution LEFTXX "Left"
      outcome success
      in n: int
      out n: int
      script |
        def execute(self, inputs, outputs, gvm):
            self.preemptive_wait(0.001)
            outputs["n"] = inputs["n"] * 2
            return 0
    execution RIGHTX "Right"
      outcome success
      script |
        def execute(self, inputs, outputs, gvm):
            return 0
    decider unique_decider_state_id "Decider"
      outcome success
      outcome lost
      in n: int
      out n: int
      script |
        def execute(self, inputs, outputs, gvm):
            outputs["n"] = inputs["n"]
            return 0 if inputs["n"] is not None else "lost"
"#;

/// Numbers that look random and are the same for the same seed.
#[derive(Debug)]
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn roll(&mut self, below: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % below
    }
}

#[test]
fn a_killed_runner_loses_nothing_that_was_told() {
    let kills = number(KILLS).unwrap_or(4);
    let place = Place::with(MACHINE);
    let mut passed = 0;
    for seed in 0..kills {
        one_kill(&place, seed);
        passed += 1;
    }
    writeln!(std::io::stdout(), "{passed} of {kills} kills passed").unwrap();
}

/// A number from the environment.
pub(crate) fn number(name: &str) -> Option<u64> {
    env::var_os(name).map(|number| number.to_str().unwrap().parse().unwrap())
}

fn one_kill(place: &Place, seed: u64) {
    let mut dice = Dice(seed);
    let runs = format!("runs-{seed}");
    let mut told = killed(Run::start(place, &format!("--runs {runs}")), dice.roll(LINES));
    let policy = if dice.roll(2) == 0 { "abort" } else { "restart" };
    let mut lives = 1;
    while !told.iter().any(|line| line["type"] == "finished") {
        assert_prefix(&told, &history(place, &runs), seed);
        let words = format!("resume last --runs {runs} --policy {policy} --output json");
        let run = Run::of(place.command(&words));
        // The run is killed a second time now and then, and comes to its end in the third life at the latest.
        let again = lives == 1 && dice.roll(3) == 0;
        let after = if again { dice.roll(LINES / 2) } else { u64::MAX };
        told.extend(killed(run, after));
        lives += 1;
        assert!(lives < 5, "seed {seed}: the run does not end");
    }
    let history = history(place, &runs);
    assert_prefix(&told, &history, seed);
    let end = told.iter().find(|line| line["type"] == "finished").unwrap();
    let outcome = end["outcome"]["name"].as_str().unwrap();
    let total = end["outputs"]["total"].as_i64();
    assert_eq!((outcome, total), ("success", Some(40)), "seed {seed}, policy {policy}: {end}");
    std::fs::remove_dir_all(place.path(&runs)).unwrap();
}

/// Reads so many lines of a run, kills its runner, and gives everything that was told.
fn killed(mut run: Run, after: u64) -> Vec<Value> {
    let mut told = Vec::new();
    while (told.len() as u64) < after {
        let Some(line) = run.next_line() else { break };
        told.push(line);
    }
    if let Some(runner) = run.runner() {
        // It may have ended by itself in the meantime.
        kill_process(runner, Signal::KILL).unwrap_or_default();
    }
    let (_, rest, _) = run.end();
    told.extend(rest);
    told.iter().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Every event of the journal, which must be numbered without a gap.
fn history(place: &Place, runs: &str) -> Vec<Value> {
    let Answer { code, stdout, stderr } = place.call(&format!("history last --runs {runs} --json"));
    assert_eq!(code, Some(0), "{stderr}");
    let events: Vec<Value> =
        stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let numbers = events.iter().map(|event| event["sequence"].as_u64().unwrap());
    assert!(numbers.eq(1..=events.len() as u64), "the journal has a gap");
    events
}

/// What was told is in the journal, in the same order.
fn assert_prefix(told: &[Value], history: &[Value], seed: u64) {
    let mut kept = history.iter().map(key);
    for event in told.iter().filter(|event| is_journaled(event)) {
        let key = key(event);
        assert!(kept.any(|kept| kept == key), "seed {seed}: not in the journal: {event}");
    }
}

/// Whether the line is an event of the run, and not one about the end of a runner.
fn is_journaled(line: &Value) -> bool {
    ["entered", "left", "finished"].iter().any(|kind| line["type"] == *kind)
}

fn key(event: &Value) -> (String, String, String) {
    let event = event.get("event").unwrap_or(event);
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    (text(&event["type"]), text(&event["path"]), text(&event["outcome"]["name"]))
}
