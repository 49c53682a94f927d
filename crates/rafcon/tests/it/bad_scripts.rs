//! Scripts that misbehave in every way: the machine's own aborted path, or a clear message; never a run lost without a word.

use crate::harness::Place;
use expect_test::{Expect, expect};

/// A whole script in; exit code, outcome, error output and the log out.
fn check(script: &str, expect: &Expect) {
    let answer = Place::with_script(script).run("");
    // Marks below a line of code differ from one Python to the next.
    let is_text = |line: &&str| !line.trim_matches([' ', '^', '~']).is_empty();
    let log: Vec<_> =
        answer.log().lines().filter(is_text).map(|line| format!("{line}\n")).collect();
    expect.assert_eq(&format!("{}{}", answer.ending(), log.concat()));
}

fn body(text: &str) -> String {
    format!("def execute(self, inputs, outputs, gvm):\n    {text}")
}

#[test]
fn a_syntax_error() {
    check(
        "return 0",
        &expect![[r#"
            4 finished aborted
              File "PLACE/machine/script.py", line 1
                return 0
            SyntaxError: 'return' outside function
        "#]],
    );
}

#[test]
fn no_execute() {
    check(
        "def excute(self, inputs, outputs, gvm):\n    return 0",
        &expect![[r"
        4 finished aborted
        AttributeError: the script has no function execute(self, inputs, outputs, gvm)
    "]],
    );
}

#[test]
fn an_exception() {
    check(
        &body("raise ValueError('boom')"),
        &expect![[r#"
            4 finished aborted
            Traceback (most recent call last):
              File "PLACE/machine/script.py", line 2, in execute
                raise ValueError('boom')
            ValueError: boom
        "#]],
    );
}

#[test]
fn a_missing_module() {
    check(
        "import nothing_like_that\n\ndef execute(self, inputs, outputs, gvm):\n    return 0",
        &expect![[r#"
            4 finished aborted
            Traceback (most recent call last):
              File "PLACE/machine/script.py", line 1, in <module>
                import nothing_like_that
            ModuleNotFoundError: No module named 'nothing_like_that'
        "#]],
    );
}

#[test]
fn an_exit() {
    check(
        &body("import sys; sys.exit(3)"),
        &expect![[r#"
            4 finished aborted
            Traceback (most recent call last):
              File "PLACE/machine/script.py", line 2, in execute
                import sys; sys.exit(3)
            SystemExit: 3
        "#]],
    );
}

#[test]
fn a_keyboard_interrupt() {
    check(
        &body("raise KeyboardInterrupt"),
        &expect![[r#"
            4 finished aborted
            Traceback (most recent call last):
              File "PLACE/machine/script.py", line 2, in execute
                raise KeyboardInterrupt
            KeyboardInterrupt
        "#]],
    );
}

#[test]
fn an_exit_past_all_handlers() {
    check(
        &body("import os; os._exit(0)"),
        &expect![[r"
            7 died
            error: the Python process that ran the machine died: exit status 0
              active states:
                Lonely (LONELY)
              the run is recorded up to this point; resume it:
                rafcon resume RUN --policy abort   (abort the interrupted states; recovery transitions take over)
                rafcon resume RUN                  (wait until you decide)
        "]],
    );
}

#[test]
fn a_signal() {
    check(
        &body("import os, signal; os.kill(os.getpid(), signal.SIGKILL)"),
        &expect![[r"
            7 died
            error: the Python process that ran the machine died: killed by signal 9 (SIGKILL)
              active states:
                Lonely (LONELY)
              the run is recorded up to this point; resume it:
                rafcon resume RUN --policy abort   (abort the interrupted states; recovery transitions take over)
                rafcon resume RUN                  (wait until you decide)
        "]],
    );
}

#[test]
fn a_crash_names_the_line() {
    let script = body("import ctypes; ctypes.string_at(0)");
    let answer = Place::with_script(&script).run("");
    assert_eq!(answer.code, Some(7));
    let last = answer.last();
    assert_eq!(last["type"], "died");
    assert_eq!(last["reason"], "killed by signal 11 (SIGSEGV)");
    assert_eq!(last["active"], serde_json::json!(["LONELY"]));
    for words in ["Lonely (LONELY)", "Segmentation fault", "line 2 in execute"] {
        assert!(answer.stderr.contains(words), "{}", answer.stderr);
    }
}

#[test]
fn nonsense_returned() {
    check(
        &body("return 'nowhere'"),
        &expect![[r"
        4 finished aborted
        the script returned 'nowhere', which is neither the id nor the name of an outcome; the state aborts
    "]],
    );
    check(
        &body("return {}"),
        &expect![[r"
        4 finished aborted
        TypeError: unhashable type: 'dict'
    "]],
    );
    check(
        &body("pass"),
        &expect![[r"
        4 finished aborted
        the script returned None, which is neither the id nor the name of an outcome; the state aborts
    "]],
    );
}

#[test]
fn a_hang_that_ignores_everything_is_killed() {
    let answer = Place::with_script(&body("\n    while True: pass")).run("--timeout 4");
    assert_eq!((answer.code, &answer.last()["type"]), (Some(8), &"killed".into()), "{answer:?}");
}

#[test]
fn a_connection_closed_by_the_script() {
    let script = body("import os; os.closerange(3, 256); return 0");
    let answer = Place::with_script(&script).run("");
    assert!(matches!(answer.code, Some(0 | 7)), "{answer:?}");
    assert!(!answer.stdout.is_empty());
}

#[test]
fn megabytes_of_output_all_arrive() {
    let script = body("\n    for number in range(20000): print('x' * 200, number)\n    return 0");
    let answer = Place::with_script(&script).run("");
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let log = answer.log();
    let lines: Vec<_> = log.lines().collect();
    assert_eq!(lines.len(), 20_000);
    assert!(lines[19_999].ends_with(" 19999"));
}

#[test]
fn one_endless_line_arrives() {
    let script = body("print('x' * 5_000_000); return 0");
    let answer = Place::with_script(&script).run("");
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let length: usize = answer.log().lines().map(str::len).sum();
    assert_eq!(length, 5_000_000);
}

#[test]
fn output_past_the_capture_is_a_line_of_the_log() {
    let script = body("import os; os.write(1, b'raw\\n'); os.write(2, b'\\xff\\n'); return 0");
    let answer = Place::with_script(&script).run("");
    let log = answer.log();
    let mut lines: Vec<_> = log.lines().collect();
    lines.sort_unstable();
    assert_eq!((answer.code, lines), (Some(0), vec!["raw", "\u{fffd}"]));
}

#[test]
fn deep_recursion() {
    let script =
        "def execute(self, inputs, outputs, gvm):\n    return execute(self, inputs, outputs, gvm)";
    let answer = Place::with_script(script).run("");
    assert_eq!(answer.code, Some(4), "{}", answer.stderr);
    assert!(answer.last()["outputs"]["error"]["__exc__"] == "RecursionError", "{}", answer.stdout);
}

#[test]
fn an_exception_of_ten_million_characters_is_shown_in_part() {
    let answer = Place::with_script(&body("raise ValueError('x' * 10_000_000)")).run("");
    assert_eq!(answer.code, Some(4), "{}", answer.stderr);
    let message = answer.last()["outputs"]["error"]["msg"].as_str().unwrap().to_owned();
    assert_eq!(message, format!("{}… (10000000 characters)", "x".repeat(16_384)));
}

#[test]
fn a_fork_that_goes_its_own_way() {
    let script = body("import os\n    if os.fork() == 0: os._exit(0)\n    os.wait(); return 0");
    check(
        &script,
        &expect![[r"
        0 finished success
    "]],
    );
}

#[test]
fn a_thread_that_never_ends() {
    let script =
        body("import threading; threading.Thread(target=threading.Event().wait).start(); return 0");
    check(
        &script,
        &expect![[r"
        0 finished success
    "]],
    );
}

/// A second runner asks for the run while its script continues.
#[test]
fn a_script_that_copies_the_folder_of_its_run_keeps_its_run() {
    let script = r#"
import glob, os, shutil, subprocess
def execute(self, inputs, outputs, gvm):
    (run,) = glob.glob(os.path.expanduser("~/.local/state/rafcon/runs/*"))
    shutil.copytree(run, os.path.expanduser("~/copy"), ignore=shutil.ignore_patterns("socket"))
    second = subprocess.run(["RAFCON", "resume", run, "--policy", "restart"], capture_output=True, text=True)
    self.logger.info(second.stderr.replace(str(os.getpid()), "PID").strip())
    return "success"
"#;
    check(
        &script.replace("RAFCON", env!("CARGO_BIN_EXE_rafcon")),
        &expect![[r"
            0 finished success
            error: the run in PLACE/.local/state/rafcon/runs/RUN is still active (process PID): join it with `rafcon attach`, or end it first
        "]],
    );
}
