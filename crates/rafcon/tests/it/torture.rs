//! Runners killed in the middle of a run, while it begins and while it is resumed, at moments that no one chose: what anyone
//! was told is in the journal, and the run comes to an end that its machine allows, with the data it had.

use crate::harness::{Answer, Place, Run};
use rafcon_storage::journal::{Reader, has_begun};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::time::SystemTime;
use std::{env, thread};

/// How often a runner is killed, where a few times are not enough.
const KILLS: &str = "RAFCON_TEST_KILLS";
/// The seed to begin with.
pub(crate) const SEED: &str = "RAFCON_TEST_SEED";
/// Lines that a whole run prints, about.
const LINES: u64 = 700;
/// How long a killing hand trembles at most while a run begins: about as long as that takes.
pub(crate) const TREMBLES: u64 = 1_200_000;
/// So often a process is looked for that was started.
const LOOKS: u32 = 500_000;

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

/// When a runner is killed first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Moment {
    /// While the run begins: before its first event.
    Starting,
    /// While it continues.
    Running,
    /// While it is resumed, after it was killed before: before the next event.
    Resuming,
}

/// How many were killed when.
#[derive(Debug, Default)]
struct Tally {
    starting: u32,
    running: u32,
    resuming: u32,
}

#[test]
fn a_killed_runner_loses_nothing_that_was_told() {
    let (kills, first) = (number(KILLS).unwrap_or(4), first_seed());
    let place = Place::with(MACHINE);
    let mut tally = Tally::default();
    for seed in first..first + kills {
        let _repeat = Repeat { seed, options: "" };
        one_kill(&place, seed, &mut tally);
    }
    writeln!(std::io::stdout(), "{kills} of {kills} runs passed: {tally:?}").unwrap();
}

/// A number from the environment.
pub(crate) fn number(name: &str) -> Option<u64> {
    env::var_os(name).map(|number| number.to_str().unwrap().parse().unwrap())
}

/// The seed to begin with: another one each day, unless one is named.
#[expect(clippy::disallowed_methods, reason = "every day tries other moments")]
pub(crate) fn first_seed() -> u64 {
    const DAY_S: u64 = 24 * 60 * 60;
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap();
    number(SEED).unwrap_or(since.as_secs() / DAY_S * 1000)
}

/// Says how a failure is repeated.
pub(crate) struct Repeat {
    pub(crate) seed: u64,
    pub(crate) options: &'static str,
}

impl Drop for Repeat {
    fn drop(&mut self) {
        if thread::panicking() {
            let Self { seed, options } = self;
            let again = format!("cargo xtask torture {options}--kills 1 --from {seed}");
            let mut output = std::io::stdout();
            writeln!(output, "seed {seed}: repeat it with `{again}`").unwrap_or_default();
        }
    }
}

fn one_kill(place: &Place, seed: u64, tally: &mut Tally) {
    let mut dice = Dice(seed);
    let runs = format!("runs-{seed}");
    let moments = [Moment::Starting, Moment::Running, Moment::Resuming];
    let moment =
        moments[usize::try_from([0, 1, 2, dice.roll(2) * 2][(seed % 4) as usize]).unwrap()];
    let policy = if dice.roll(2) == 0 { "abort" } else { "restart" };
    let start = |more: &str| Run::start(place, &format!("--runs {runs} {more}"));
    let mut told = if moment == Moment::Starting {
        let by_itself = format!("--on-crash {policy}");
        let run = start(if dice.roll(2) == 0 { "" } else { &by_itself });
        killed_early(run, &mut dice, &place.path(&runs), &mut tally.starting, &mut tally.running)
    } else {
        tally.running += 1;
        killed(start(""), dice.roll(LINES))
    };
    let mut lives = 1;
    while !told.iter().any(|line| line["type"] == "finished") {
        lives += 1;
        assert!(lives < 6, "seed {seed}: the run does not end");
        if latest(&place.path(&runs)).is_none() {
            // It was refused; no one was told anything of it.
            assert!(!told.iter().any(is_journaled), "seed {seed}: {told:?}");
            told = killed(start(""), u64::MAX);
            continue;
        }
        assert_prefix(&told, &history(place, &runs), seed);
        let words = format!("resume last --runs {runs} --policy {policy} --output json");
        let run = Run::of(place.command(&words));
        // The run is killed a second time now and then, and comes to its end in the third life at the latest.
        let again = lives == 2 && dice.roll(3) == 0;
        told.extend(if moment == Moment::Resuming && lives == 2 {
            let (early, late) = (&mut tally.resuming, &mut tally.running);
            killed_early(run, &mut dice, &place.path(&runs), early, late)
        } else {
            tally.running += u32::from(again);
            killed(run, if again { dice.roll(LINES / 2) } else { u64::MAX })
        });
    }
    let history = history(place, &runs);
    assert_prefix(&told, &history, seed);
    let end = told.iter().find(|line| line["type"] == "finished").unwrap();
    let outcome = end["outcome"]["name"].as_str().unwrap();
    let total = end["outputs"]["total"].as_i64();
    assert_eq!((outcome, total), ("success", Some(40)), "seed {seed}, policy {policy}: {end}");
    fs::remove_dir_all(place.path(&runs)).unwrap();
}

/// Reads so many lines of a run, kills its runner, and gives everything that was told.
fn killed(mut run: Run, after: u64) -> Vec<Value> {
    let mut told = Vec::new();
    while (told.len() as u64) < after {
        let Some(line) = run.next_line() else { break };
        told.push(line);
    }
    if let Some(runner) = run.runner() {
        kill(runner);
    }
    told.extend(run.end().1);
    told.iter().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Kills the runner of a run that begins, or is resumed, after a moment that no one chose; gives everything that was told. It is
/// counted as early if nothing had happened yet, else as late.
fn killed_early(
    run: Run,
    dice: &mut Dice,
    runs: &Path,
    early: &mut u32,
    late: &mut u32,
) -> Vec<Value> {
    let before = latest(runs).map(|run| events(&run));
    let runner = (0..LOOKS).find_map(|_| run.runner()).expect("a runner is started");
    tremble(dice.roll(TREMBLES));
    let now = latest(runs).filter(|run| has_begun(run)).map(|run| events(&run));
    kill(runner);
    *if now > before { late } else { early } += 1;
    run.end().1.iter().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Lets a moment pass.
pub(crate) fn tremble(times: u64) {
    for _ in 0..times {
        std::hint::spin_loop();
    }
}

/// It may have ended by itself in the meantime.
fn kill(runner: Pid) {
    kill_process(runner, Signal::KILL).unwrap_or_default();
}

/// The folder of the run that keeps what it is, if there is one.
fn latest(runs: &Path) -> Option<std::path::PathBuf> {
    let entries = fs::read_dir(runs).ok()?.flatten().map(|entry| entry.path());
    entries.filter(|run| run.join("run.json").exists()).max()
}

/// How many events the run in this folder has.
fn events(run: &Path) -> u64 {
    Reader::open(run).and_then(|reader| reader.last_sequence()).unwrap_or_default()
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
