//! A run that is held, stepped, asked and resumed from other terminals.

use crate::harness::{Place, Run};
use expect_test::{Expect, expect};
use rustix::process::{Signal, kill_process};
use serde_json::Value;

/// Three states, the second with a question on demand.
const MACHINE: &str = r#"
hierarchy ROOT "Root"
  outcome success
  var n: int = 0
  start -> ONEXXX
  ONEXXX.success -> TWOXXX ; TWOXXX.success -> THREEX ; THREEX.success -> .success
  TWOXXX.aborted -> THREEX
  flow .n -> ONEXXX.n ; ONEXXX.n -> .n ; .n -> TWOXXX.n ; TWOXXX.n -> .n
  execution ONEXXX "One"
    outcome success
    in n: int
    out n: int
    script |
      def execute(self, inputs, outputs, gvm):
          outputs["n"] = inputs["n"] + 1
          return 0
      def backward_execute(self, inputs, outputs, gvm):
          self.logger.info("one back with %s" % inputs["n"])
  execution TWOXXX "Two"
    outcome success
    in n: int
    out n: int
    script |
      def execute(self, inputs, outputs, gvm):
          if gvm.get_variable("ask", default=False):
              from rafcon import dialog
              answer = dialog.ask("go on?", buttons=("yes", "no"))
              self.logger.info("answered %s" % answer.label)
          outputs["n"] = inputs["n"] * 10
          return 0
  execution THREEX "Three"
    outcome success
    script |
      def execute(self, inputs, outputs, gvm):
          return 0
"#;

/// Begins a run with `words`; before each further command the events up to the named kind are taken. Prints what was told,
/// what each command was answered, and how it ended.
fn check(machine: &str, words: &str, commands: &[(&str, &str)], expect: &Expect) {
    let place = Place::with(machine);
    let mut run = Run::start(&place, &format!("--runs runs {words}"));
    let mut text = String::new();
    let mut question = String::new();
    for (until, command) in commands {
        if !until.is_empty() {
            let last = up_to(&mut run, until, &mut text);
            question = last["question"]["id"].to_string();
        }
        let command = command.replace("QUESTION", &question);
        let told = place.call(&format!("tell last {command} --runs runs"));
        text.extend(["> ", &*command, ": ", &told.stdout, &told.stderr]);
    }
    let (code, rest, said) = run.end();
    text += &rest.iter().filter_map(|line| shown(line)).collect::<String>();
    text.extend([&*code.unwrap_or(-1).to_string(), "\n", &said]);
    expect.assert_eq(&text);
}

/// Adds what is told up to the next event of this kind, and gives that event.
fn up_to(run: &mut Run, kind: &str, text: &mut String) -> Value {
    loop {
        let line = run.next_line();
        let line = line.unwrap_or_else(|| panic!("the run ended before `{kind}`: {text}"));
        *text += &shown(&line).unwrap_or_default();
        let event: Value = serde_json::from_str(&line).unwrap();
        if event["type"] == kind {
            return event;
        }
    }
}

/// One event in a few words; nothing about those that are not of interest here.
fn shown(line: &str) -> Option<String> {
    let event: Value = serde_json::from_str(line).unwrap();
    let field = |name: &str| event[name].as_str().unwrap_or_default().to_owned();
    let text = match field("type").as_str() {
        "entered" if event["undoes"].is_u64() => format!("back into {}", field("path")),
        "left" if event["undoes"].is_u64() => format!("back out of {}", field("path")),
        "entered" => format!("into {}", field("path")),
        "left" | "finished" => {
            let outcome = event["outcome"]["name"].as_str().unwrap_or_default();
            format!("{} {} by {outcome}", field("type"), field("path"))
        }
        "held" => format!("held before {} by {}", field("next"), event["by"]["type"]),
        "hit" => format!("hit {}", field("path")),
        "log" => format!("log {}", field("message")),
        "asked" => format!("asked {}", event["question"]["message"]),
        "closed" => format!("closed {}", field("how")),
        "forced" => format!("forced {}", field("path")),
        "waiting" => format!("waiting {}", field("path")),
        _ => return None,
    };
    Some(text + "\n")
}

#[test]
fn a_run_is_stepped_forwards_and_back() {
    check(
        MACHINE,
        "--hold",
        &[
            ("held", "step_back"),
            ("", "step_into"),
            ("held", "step_into"),
            ("held", "step_back"),
            ("held", "step_back"),
            ("held", "resume"),
        ],
        &expect![[r#"
            into ROOT
            held before ROOT/ONEXXX by "start"
            > step_back: refused: 'ROOT' is held at its beginning, and nothing comes before; step forwards
            > step_into: applied
            into ROOT/ONEXXX
            left ROOT/ONEXXX by success
            held before ROOT/TWOXXX by "step"
            > step_into: applied
            into ROOT/TWOXXX
            left ROOT/TWOXXX by success
            held before ROOT/THREEX by "step"
            > step_back: applied
            back into ROOT/TWOXXX
            back out of ROOT/TWOXXX
            held before ROOT/TWOXXX by "step"
            > step_back: applied
            back into ROOT/ONEXXX
            log one back with 1
            back out of ROOT/ONEXXX
            held before ROOT/ONEXXX by "start"
            > resume: applied
            into ROOT/ONEXXX
            left ROOT/ONEXXX by success
            into ROOT/TWOXXX
            left ROOT/TWOXXX by success
            into ROOT/THREEX
            left ROOT/THREEX by success
            left ROOT by success
            finished  by success
            0
        "#]],
    );
}

#[test]
fn a_breakpoint_holds_where_its_condition_is_true() {
    check(
        MACHINE,
        "--break Two",
        &[("held", "force_outcome path=ROOT/TWOXXX outcome=0"), ("held", "resume")],
        &expect![[r#"
            into ROOT
            into ROOT/ONEXXX
            left ROOT/ONEXXX by success
            hit ROOT/TWOXXX
            held before ROOT/TWOXXX by "breakpoint"
            > force_outcome path=ROOT/TWOXXX outcome=0: applied
            forced ROOT/TWOXXX
            held before ROOT/THREEX by "step"
            > resume: applied
            into ROOT/THREEX
            left ROOT/THREEX by success
            left ROOT by success
            finished  by success
            0
        "#]],
    );
}

#[test]
fn a_question_is_answered_from_elsewhere() {
    let asking = MACHINE.replace(r#"gvm.get_variable("ask", default=False)"#, "True");
    check(
        &asking,
        "",
        &[
            ("asked", r#"answer_question question=QUESTION value={"button":7}"#),
            ("", r#"answer_question question=QUESTION value={"button":0}"#),
        ],
        &expect![[r#"
            into ROOT
            into ROOT/ONEXXX
            left ROOT/ONEXXX by success
            into ROOT/TWOXXX
            asked "go on?"
            > answer_question question=1 value={"button":7}: refused: there is no button 7; the buttons are yes, no, counted from 0
            > answer_question question=1 value={"button":0}: applied
            closed answered
            log answered yes
            left ROOT/TWOXXX by success
            into ROOT/THREEX
            left ROOT/THREEX by success
            left ROOT by success
            finished  by success
            0
        "#]],
    );
}

#[test]
fn whoever_attaches_sees_the_end_or_leaves_it_running() {
    let place = Place::with(MACHINE);
    let mut run = Run::start(&place, "--runs runs --hold");
    up_to(&mut run, "held", &mut String::new());
    let mut guest = Run::of(place.command("attach last --runs runs --from 1 --output json"));
    up_to(&mut guest, "held", &mut String::new());
    guest.signal(Signal::INT);
    let (code, rest, said) = guest.end();
    assert_eq!((code, rest.last().map(String::as_str)), (Some(0), Some(r#"{"type":"left"}"#)));
    assert!(said.contains("the run continues"), "{said}");
    let mut guest = Run::of(place.command("attach last --runs runs --from 1 --output json"));
    up_to(&mut guest, "held", &mut String::new());
    assert_eq!(place.call("tell last resume --runs runs").code, Some(0));
    let (code, rest, _) = guest.end();
    assert_eq!(code, Some(0));
    assert!(rest.last().unwrap().contains(r#""type":"finished""#), "{rest:?}");
    assert_eq!(run.end().0, Some(0));
}

#[test]
fn nobody_can_join_a_run_that_is_over() {
    let place = Place::with(MACHINE);
    let (code, ..) = Run::start(&place, "--runs runs").end();
    assert_eq!(code, Some(0));
    for words in ["attach last --output json --runs runs", "tell last pause --runs runs"] {
        let answer = place.call(words);
        assert_eq!(answer.code, Some(1), "{answer:?}");
        assert!(answer.stderr.contains("is not active"), "{answer:?}");
    }
}

/// Kills the runner of a held run and resumes the run again by a policy.
fn resumed(policy: &str, then: &[(&str, &str)], expect: &Expect) {
    let place = Place::with(&MACHINE.replace(
        r#"gvm.get_variable("ask", default=False)"#,
        r#"gvm.get_variable("asked", default=0) < 1"#,
    ));
    let mut run = Run::start(&place, "--runs runs");
    up_to(&mut run, "asked", &mut String::new());
    kill_process(run.runner().unwrap(), Signal::KILL).unwrap();
    assert_eq!(run.end().0, Some(7));
    let words = format!("resume last --policy {policy} --output json --runs runs");
    let mut run = Run::of(place.command(&words));
    let mut text = String::new();
    for (until, command) in then {
        up_to(&mut run, until, &mut text);
        let told = place.call(&format!("tell last {command} --runs runs"));
        text.extend(["> ", command, ": ", &told.stdout, &told.stderr]);
    }
    let (code, rest, said) = run.end();
    text += &rest.iter().filter_map(|line| shown(line)).collect::<String>();
    expect.assert_eq(&format!("{text}{}\n{said}", code.unwrap_or(-1)));
}

#[test]
fn a_crash_takes_the_recovery_path() {
    resumed(
        "abort",
        &[],
        &expect![[r"
        into ROOT
        into ROOT/TWOXXX
        left ROOT/TWOXXX by aborted
        into ROOT/THREEX
        left ROOT/THREEX by success
        left ROOT by success
        finished  by success
        0
    "]],
    );
}

#[test]
fn after_a_crash_nothing_moves_until_somebody_decides() {
    resumed(
        "ask",
        &[("waiting", "recover policy=abort"), ("held", "resume")],
        &expect![[r#"
        into ROOT
        into ROOT/TWOXXX
        waiting ROOT/TWOXXX
        > recover policy=abort: applied
        left ROOT/TWOXXX by aborted
        held before ROOT/THREEX by "step"
        > resume: applied
        into ROOT/THREEX
        left ROOT/THREEX by success
        left ROOT by success
        finished  by success
        0
    "#]],
    );
    resumed(
        "ask",
        &[("waiting", "force_outcome path=ROOT/TWOXXX outcome=0"), ("held", "resume")],
        &expect![[r#"
        into ROOT
        into ROOT/TWOXXX
        waiting ROOT/TWOXXX
        > force_outcome path=ROOT/TWOXXX outcome=0: applied
        forced ROOT/TWOXXX
        left ROOT/TWOXXX by success
        held before ROOT/THREEX by "step"
        > resume: applied
        into ROOT/THREEX
        left ROOT/THREEX by success
        left ROOT by success
        finished  by success
        0
    "#]],
    );
}

#[test]
fn a_user_without_a_name_is_known_by_number() {
    let place = Place::with(MACHINE);
    let mut run = Run::start(&place, "--hold --runs runs");
    up_to(&mut run, "held", &mut String::new());
    let told = place.command("tell last stop --runs runs").env_remove("USER").output().unwrap();
    assert!(told.status.success(), "{told:?}");
    run.end();
    let history = place.call("history last --runs runs");
    let user = format!("uid {}", rustix::process::getuid().as_raw());
    assert!(history.stdout.contains(&user), "{}", history.stdout);
}
