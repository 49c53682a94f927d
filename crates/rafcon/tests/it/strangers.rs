//! Interpreters that are none, and runners of another build.

use crate::harness::Place;
use expect_test::{Expect, expect};
use std::os::unix::fs::PermissionsExt as _;

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
