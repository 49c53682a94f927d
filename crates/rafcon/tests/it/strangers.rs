//! Interpreters that are none, and runners of another build.

use crate::harness::Place;
use expect_test::{Expect, expect};
use std::os::unix::fs::PermissionsExt as _;
use std::process::{Command, Stdio};

/// Runs a machine with a program of ours instead of Python.
fn check(program: &str, expect: &Expect) {
    let place = Place::with_script("def execute(self, inputs, outputs, gvm):\n    return 0");
    let python = place.path("python");
    std::fs::write(&python, program).unwrap();
    std::fs::set_permissions(&python, std::fs::Permissions::from_mode(0o755)).unwrap();
    let answer = place.run(&format!("--python {}", python.display()));
    expect.assert_eq(&answer.ending());
}

#[test]
fn a_program_that_ends_at_once() {
    check(
        "#!/bin/sh\necho 'not today' >&2\nexit 3\n",
        &expect![[r"
        1 not_started
        error: the Python interpreter did not become a runner: exit status 3
          last output:
            not today
    "]],
    );
}

#[test]
fn a_program_that_is_killed() {
    check(
        "#!/bin/sh\nkill -9 $$\n",
        &expect![[r"
        1 not_started
        error: the Python interpreter did not become a runner: killed by signal 9 (SIGKILL)
    "]],
    );
}

/// Runs a machine with an interpreter that never answers, for a short time.
fn check_silent(command: &mut Command, place: &Place) {
    let output = command.args(["--output", "json", "--timeout", "0.3"]).output().unwrap();
    expect![[r"
        6 killed
        error: the time limit of --timeout expired before the Python process answered; it was killed, and no state has run
    "]]
    .assert_eq(&place.answer(&output).ending());
}

#[test]
fn a_python_that_never_answers_is_killed_when_the_time_is_over() {
    let place = Place::with_script("def execute(self, inputs, outputs, gvm):\n    return 0");
    std::fs::write(place.path("sitecustomize.py"), "import time\ntime.sleep(1000)\n").unwrap();
    check_silent(place.command("run MACHINE").env("PYTHONPATH", place.path("")), &place);
}

/// The launch is larger than what a socket takes without a reader.
#[test]
fn a_stopped_process_that_reads_no_launch_is_killed_when_the_time_is_over() {
    let place = Place::with_script("def execute(self, inputs, outputs, gvm):\n    return 0");
    let python = place.path("python");
    std::fs::write(&python, "#!/bin/sh\nkill -STOP $$\n").unwrap();
    std::fs::set_permissions(&python, std::fs::Permissions::from_mode(0o755)).unwrap();
    let mut command = place.command("run MACHINE");
    command.arg("--python").arg(python);
    for name in 'a'..='h' {
        command.args(["--global", &format!("{name}=\"{}\"", "x".repeat(100_000))]);
    }
    check_silent(&mut command, &place);
}

/// Nobody reads the output: it fills its pipe.
#[test]
fn a_time_limit_holds_although_nobody_reads_the_output() {
    let script =
        "def execute(self, inputs, outputs, gvm):\n    while True:\n        print('x' * 1000)";
    let place = Place::with_script(script);
    let mut command = place.command("run MACHINE --output json --keep off --timeout 4");
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(8));
}

#[test]
fn a_runner_of_another_version() {
    check(
        "#!/bin/sh\necho '{\"protocol\":99,\"program\":\"9.9\"}' >&$RAFCON_CONTROL_FD\nexec cat >/dev/null <&$RAFCON_CONTROL_FD\n",
        &expect![[r"
            1 not_started
            error: the Python interpreter did not become a runner: the other side (version 9.9) speaks protocol 99, this one speaks 3: install the rafcon binary and its extension from the same build
        "]],
    );
}

#[test]
fn a_program_that_babbles() {
    check(
        "#!/bin/sh\necho 'good evening' >&$RAFCON_CONTROL_FD\n",
        &expect![[r"
            1 not_started
            rafcon: cannot understand the runner: not a message of this protocol: good evening

            error: the Python interpreter did not become a runner: exit status 0
        "]],
    );
}
