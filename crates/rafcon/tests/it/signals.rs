//! Ctrl-C, hang-ups and kills while a machine runs. The machine says by its output when it is where it is wanted.

use crate::harness::{Place, Run};
use crate::torture::number;
use rustix::process::Signal;
use std::io::Write as _;
use std::time::Duration;
use std::{fs, thread};

/// How many doubled signals are sent, where a few are not enough.
const SIGNALS: &str = "RAFCON_TEST_SIGNALS";
/// The doubled signals of wrappers and people.
const PAIRS: [[Signal; 2]; 4] = [
    [Signal::TERM, Signal::TERM],
    [Signal::INT, Signal::INT],
    [Signal::TERM, Signal::INT],
    [Signal::INT, Signal::TERM],
];

/// An arm that parks when its work is preempted. It parks until somebody has written `go`.
const ARM: &str = r#"
hierarchy ROOT "Arm"
  outcome success
  start -> WORKXX
  WORKXX.success -> .success ; WORKXX.preempted -> PARKXX
  PARKXX.success -> .success
  execution WORKXX "Work"
    outcome success
    script |
      def execute(self, inputs, outputs, gvm):
          print("working")
          self.preemptive_wait()
          return "preempted"
  execution PARKXX "Park the arm"
    outcome success
    script |
      import os
      def execute(self, inputs, outputs, gvm):
          print("parking")
          os.read(os.open("go", os.O_RDONLY), 2)
          print("parked")
          return "success"
"#;

fn waits() -> Place {
    Place::with_script(
        r#"
def execute(self, inputs, outputs, gvm):
    print("here")
    self.preemptive_wait()
    print("asked to end")
    return "success"
"#,
    )
}

#[test]
fn ctrl_c_ends_the_machine_in_an_orderly_way() {
    let place = waits();
    let mut run = Run::start(&place, "");
    run.wait_for("here");
    run.signal(Signal::INT);
    let (code, lines, _) = run.end();
    assert_eq!(code, Some(5));
    assert!(lines.iter().any(|line| line.contains("asked to end")), "{lines:?}");
    assert!(lines.last().unwrap().contains("finished"));
}

#[test]
fn a_second_ctrl_c_kills_what_does_not_listen() {
    let place = Place::with_script(
        r#"
import time

def execute(self, inputs, outputs, gvm):
    print("here")
    while not self.preempted:
        pass
    ends = time.monotonic() + 2.1
    while time.monotonic() < ends:
        pass
    print("deaf")
    while True:
        pass
"#,
    );
    let mut run = Run::start(&place, "");
    run.wait_for("here");
    run.signal(Signal::INT);
    run.wait_for("deaf");
    run.signal(Signal::INT);
    let (code, lines, _) = run.end();
    assert_eq!(code, Some(8));
    let last: serde_json::Value = serde_json::from_str(lines.last().unwrap()).unwrap();
    assert_eq!(last["type"], "killed");
    assert_eq!(last["active"], serde_json::json!(["LONELY"]));
}

/// Whether the arm parks although its run gets these signals, so far apart.
fn parks(signals: [Signal; 2], apart: Duration) -> bool {
    let place = Place::with(ARM);
    let go = place.path("go");
    rustix::fs::mkfifoat(rustix::fs::CWD, &go, rustix::fs::Mode::RWXU).unwrap();
    let mut run = Run::start(&place, "--keep off");
    run.wait_for("working");
    run.signal(signals[0]);
    thread::park_timeout(apart);
    run.signal(signals[1]);
    if run.wait_for_one_of(&["parking".to_owned()]).is_some() {
        // Opened for both: nobody reads in a run that was killed.
        let mut go = fs::OpenOptions::new().read(true).write(true).open(go).unwrap();
        go.write_all(b"go").unwrap();
        run.wait_for_one_of(&["parked".to_owned()]);
    }
    let (code, lines, _) = run.end();
    code == Some(5) && lines.last().is_some_and(|line| line.contains("finished"))
}

/// The long form waits up to nearly two seconds between two signals.
#[test]
fn a_doubled_signal_leaves_the_machine_its_recovery() {
    let pairs = number(SIGNALS).unwrap_or(4);
    let apart_ms = |number| 5 + number * 1_900 / 100.max(pairs);
    let killed = (0..pairs).zip(PAIRS.into_iter().cycle()).filter(|(number, signals)| {
        let apart = Duration::from_millis(apart_ms(*number));
        let parked = parks(*signals, apart);
        if !parked {
            println!("not parked: {signals:?}, {apart:?} apart");
        }
        !parked
    });
    let killed = killed.count();
    println!(r#"{{"name":"double_signal_killed","value":{killed},"of":{pairs},"bar":0}}"#);
    assert_eq!(killed, 0);
}

#[test]
fn a_terminal_that_hangs_up_leaves_the_run_alive() {
    let place = waits();
    let mut run = Run::start(&place, "");
    run.wait_for("here");
    run.signal(Signal::HUP);
    run.signal(Signal::INT);
    let (code, lines, _) = run.end();
    assert_eq!(code, Some(5));
    assert!(lines.last().unwrap().contains("finished"));
}

#[test]
fn a_reader_that_goes_away_leaves_the_run_alive() {
    let place = Place::with_script(
        r#"
def execute(self, inputs, outputs, gvm):
    print("here")
    for number in range(5000):
        print("unread", number)
    return "failure"
"#,
    );
    let mut run = Run::start(&place, "");
    run.wait_for("here");
    assert_eq!(run.end_unread(), Some(3));
}

/// The script waits for a file that comes only after its viewer is gone, and answers with another.
#[test]
fn a_run_outlives_its_viewer() {
    let place = Place::with_script(
        r#"
import os

def execute(self, inputs, outputs, gvm):
    os.mkfifo("answer")
    print("here")
    with open("question") as question:
        question.read()
    with open("answer", "w") as answer:
        answer.write("alive")
    return "success"
"#,
    );
    let question = place.path("question");
    rustix::fs::mkfifoat(rustix::fs::CWD, &question, rustix::fs::Mode::RWXU).unwrap();
    let mut run = Run::start(&place, "");
    run.wait_for("here");
    run.signal(Signal::KILL);
    assert_eq!(run.end().0, None);
    fs::write(question, "are you there?").unwrap();
    assert_eq!(fs::read_to_string(place.path("answer")).unwrap(), "alive");
}
