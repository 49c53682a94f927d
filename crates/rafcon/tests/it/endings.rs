//! How runs end, and the exit code of each.

use crate::harness::Place;
use expect_test::{Expect, expect};

/// A script's body in, exit code, outcome and error output out.
fn check(body: &str, expect: &Expect) {
    let place =
        Place::with_script(&format!("def execute(self, inputs, outputs, gvm):\n    {body}"));
    expect.assert_eq(&place.run("").ending());
}

#[test]
fn outcome_0_is_success() {
    check(
        "return 'success'",
        &expect![[r"
        0 finished success
    "]],
    );
}

#[test]
fn another_outcome_is_3() {
    check(
        "return 'failure'",
        &expect![[r"
        3 finished failure
    "]],
    );
}

#[test]
fn aborted_is_4() {
    check(
        "return 'aborted'",
        &expect![[r"
        4 finished aborted
    "]],
    );
}

#[test]
fn preempted_is_5() {
    check(
        "return 'preempted'",
        &expect![[r"
        5 finished preempted
    "]],
    );
}

#[test]
fn global_variables_of_the_command_line_are_there_from_the_start() {
    let place = Place::with_script(
        "def execute(self, inputs, outputs, gvm):\n    \
         return 'success' if gvm.get_variable('word') == ['a', 1] else 'failure'",
    );
    expect![[r"
        0 finished success
    "]]
    .assert_eq(&place.run(r#"--global word=["a",1]"#).ending());
    let told = place.run(r#"--global word=["a",1]"#).stdout;
    assert!(told.contains(r#""globals":{"word":["a",1]}"#), "{told}");
}

#[test]
fn long_values_at_the_end_are_printed_whole_and_bounded_in_the_journal() {
    let place = Place::with_script(
        "def execute(self, inputs, outputs, gvm):\n    \
         gvm.set_variable('cloud', list(range(100_000)))\n    return 'success'",
    );
    let told = place.run("").stdout;
    let last: serde_json::Value = serde_json::from_str(told.lines().last().unwrap()).unwrap();
    assert_eq!(last["globals"]["cloud"].as_array().map(Vec::len), Some(100_000));
    let history = place.call("history last --json --values").stdout;
    let event = history.lines().last().unwrap();
    assert!(event.len() < 10_000, "{} bytes", event.len());
    assert!(event.contains(r#""__len__":100000"#), "{event}");
}

#[test]
fn timed_out_is_6() {
    let script = "def execute(self, inputs, outputs, gvm):\n    self.preemptive_wait(); return 0";
    let answer = Place::with_script(script).run("--timeout 0.5");
    assert_eq!(answer.code, Some(6), "{answer:?}");
    assert!(answer.stderr.contains("the time limit of --timeout expired"), "{}", answer.stderr);
}

#[test]
fn a_dead_runner_is_7() {
    check(
        "import os; os._exit(9)",
        &expect![[r"
            7 died
            error: the Python process that ran the machine died: exit status 9
              active states:
                Lonely (LONELY)
              the run is recorded up to this point; resume it:
                rafcon resume RUN --policy abort   (abort the interrupted states; recovery transitions take over)
                rafcon resume RUN                  (wait until you decide)
        "]],
    );
}

#[test]
fn a_machine_that_is_not_there_is_1() {
    let place = Place::empty();
    expect![[r"
        1 load_failed
        error: PLACE/machine does not exist; give the folder of a state machine or a file in it
    "]]
    .assert_eq(&place.run("").ending());
}

#[test]
fn a_dead_runner_leaves_its_last_words() {
    check(
        "self.logger.info('nearly there'); import os; os._exit(9)",
        &expect![[r"
            7 died
            error: the Python process that ran the machine died: exit status 9
              active states:
                Lonely (LONELY)
              last log lines of these states:
                Lonely: nearly there
              the run is recorded up to this point; resume it:
                rafcon resume RUN --policy abort   (abort the interrupted states; recovery transitions take over)
                rafcon resume RUN                  (wait until you decide)
        "]],
    );
}

#[test]
fn wrong_words_are_2() {
    let place = Place::empty();
    for words in ["run", "run MACHINE --input x", "run MACHINE --timeout soon", "walk"] {
        assert_eq!(place.call(words).code, Some(2), "{words}");
    }
}

#[test]
fn what_is_printed_is_what_happened() {
    let place = Place::with(
        r#"
        hierarchy ROOT "Root"
          outcome success
          in name: str = "World"
          out greeting: str
          var last: str
          start -> GREETS
          GREETS.success -> .success
          flow .name -> GREETS.name ; GREETS.text -> .greeting ; GREETS.text -> .last
          execution GREETS "Greet"
            outcome success
            in name: str
            out text: str
            script |
              def execute(self, inputs, outputs, gvm):
                  gvm.set_variable("seen", (1, None, int))
                  outputs["text"] = "Hello, " + inputs["name"]
                  self.logger.info(outputs["text"])
                  print("printed")
                  return "success"
        "#,
    );
    let answer = place.run("--keep off --input name=\"Ada\"");
    assert_eq!(answer.code, Some(0));
    expect![[r#"
        {"type":"entered","path":"ROOT"}
        {"type":"entered","path":"ROOT/GREETS"}
        {"type":"log","path":"ROOT/GREETS","level":"info","stream":"logger","message":"Hello, Ada"}
        {"type":"log","path":"ROOT/GREETS","level":"info","stream":"stdout","message":"printed"}
        {"type":"left","path":"ROOT/GREETS","outcome":{"id":0,"name":"success"}}
        {"type":"left","path":"ROOT","outcome":{"id":0,"name":"success"}}
        {"type":"finished","outcome":{"id":0,"name":"success"},"outputs":{"greeting":"Hello, Ada"},"globals":{"seen":{"__tuple__":[1,null,{"__type__":"int"}]}},"scoped_variables":{"last":"Hello, Ada"},"states_run":2}
    "#]].assert_eq(&answer.stdout);
}

#[test]
fn a_run_can_begin_in_the_middle() {
    let place = Place::with(
        r#"
        hierarchy ROOT
          outcome success
          start -> AAAAAA
          AAAAAA.success -> BBBBBB
          BBBBBB.success -> .success
          execution AAAAAA
            outcome success
            script |
              def execute(self, inputs, outputs, gvm):
                  return "success"
          execution BBBBBB
            outcome success
            script |
              def execute(self, inputs, outputs, gvm):
                  return "success"
        "#,
    );
    let answer = place.run("--start-from ROOT/BBBBBB");
    let entered = answer.events().into_iter().filter(|event| event["type"] == "entered");
    let entered: Vec<_> = entered.map(|event| event["path"].to_string()).collect();
    assert_eq!(entered, ["\"ROOT\"", "\"ROOT/BBBBBB\""]);
}

#[test]
fn a_script_reads_what_is_piped_in() {
    let place = Place::with_script(
        "def execute(self, inputs, outputs, gvm):\n    return 'failure' if input() == 'Ada' else 'success'",
    );
    std::fs::write(place.path("names"), "Ada\n").unwrap();
    let names = std::fs::File::open(place.path("names")).unwrap();
    let output = place.command("run MACHINE --output json").stdin(names).output().unwrap();
    assert_eq!(place.answer(&output).code, Some(3));
}

#[test]
fn a_pipe_gets_plain_lines() {
    let place = Place::with_script("def execute(self, inputs, outputs, gvm):\n    return 0");
    let answer = place.call("run MACHINE");
    let words: Vec<_> = answer
        .stdout
        .lines()
        .map(|line| {
            line.trim_start_matches([' ', '.', '0', '1', '2', '3', '4', '5', '6', '7', '8', '9'])
        })
        .collect();
    assert_eq!(words[..2], ["running Lonely (1 state)", "Lonely"]);
    assert!(words[2].starts_with("Lonely ended with success (0) after "), "{}", answer.stdout);
    assert!(words[2].ends_with(", 1 state run"), "{}", answer.stdout);
}
