//! Ctrl-C, hang-ups and kills while a machine runs. The machine says by its output when it is where it is wanted.

use crate::harness::{Place, Run};
use rustix::process::Signal;

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
def execute(self, inputs, outputs, gvm):
    print("here")
    while not self.preempted:
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
    assert_eq!(code, Some(5));
    let last: serde_json::Value = serde_json::from_str(lines.last().unwrap()).unwrap();
    assert_eq!(last["type"], "killed");
    assert_eq!(last["active"], serde_json::json!(["LONELY"]));
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
    std::fs::write(question, "are you there?").unwrap();
    assert_eq!(std::fs::read_to_string(place.path("answer")).unwrap(), "alive");
}
