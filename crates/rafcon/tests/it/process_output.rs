//! Output of child processes and native code: in the log, with the state if only one script runs.

use crate::harness::{Place, one_script};
use crate::server_runs::Site;
use rafcon_protocol::api::RunPhase;
use rustix::fs::{CWD, Mode, OFlags, mkfifoat};
use serde_json::json;

const SEQUENCE: &str = r#"
hierarchy ROOT "Sequence"
  outcome done
  start -> A
  A.ok -> B
  B.ok -> .done
  execution A
    outcome ok
    script |
      import os, subprocess
      def execute(self, inputs, outputs, gvm):
          subprocess.run(["echo", "of a child"])
          os.write(1, b"native\nunfinished")
          return 0
  execution B
    outcome ok
    script |
      import os
      def execute(self, inputs, outputs, gvm):
          os.system("echo of a shell >&2")
          print("printed")
          return 0
"#;

/// Both scripts run when the first writes.
const BOTH: &str = r#"
barrier ROOT "Both"
  outcome done
  A.ok -> unique_decider_state_id ; B.ok -> unique_decider_state_id
  unique_decider_state_id.ok -> .done
  execution A
    outcome ok
    script |
      import os
      def execute(self, inputs, outputs, gvm):
          with open("meet", "w"):
              os.write(1, b"of one of them\n")
          return 0
  execution B
    outcome ok
    script |
      def execute(self, inputs, outputs, gvm):
          open("meet").read()
          self.parent.states["A"].join()
          return 0
  decider unique_decider_state_id
    outcome ok
    script |
      def execute(self, inputs, outputs, gvm):
          return 0
"#;

/// `path: text` of each line of the log, sorted.
fn log(place: &Place) -> Vec<String> {
    let answer = place.run("--runs runs");
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let events = answer.events();
    let logs = events.iter().filter(|event| event["type"] == "log");
    let mut lines: Vec<String> = logs
        .map(|line| {
            let text = |name: &str| line[name].as_str().unwrap().to_owned();
            assert_eq!(text("level"), "info");
            format!("{} {}: {}", text("path"), text("stream"), text("message"))
        })
        .collect();
    lines.sort_unstable();
    lines
}

const SEQUENCE_LOG: [&str; 5] = [
    "ROOT/A stdout: native",
    "ROOT/A stdout: of a child",
    "ROOT/A stdout: unfinished",
    "ROOT/B stderr: of a shell",
    "ROOT/B stdout: printed",
];

#[test]
fn it_is_logged_with_the_state_and_kept() {
    let place = Place::with(SEQUENCE);
    assert_eq!(log(&place), SEQUENCE_LOG);
    let kept = place.call("log last --runs runs").stdout;
    for text in ["of a child", "native", "unfinished", "of a shell"] {
        assert!(kept.contains(text), "{kept}");
    }
}

#[test]
fn where_several_scripts_run_it_has_no_state() {
    let place = Place::with(BOTH);
    mkfifoat(CWD, place.path("meet"), Mode::RWXU).unwrap();
    assert_eq!(log(&place), [" stdout: of one of them"]);
}

#[test]
fn a_flood_arrives_in_order() {
    let place = Place::with_script(
        "import subprocess\ndef execute(self, inputs, outputs, gvm):\n    subprocess.run(['seq', '20000'])\n    return 0",
    );
    let answer = place.run("");
    let expected = (1..=20_000).fold(String::new(), |lines, number| lines + &format!("{number}\n"));
    assert_eq!((answer.code, answer.log() == expected), (Some(0), true), "{}", answer.stderr);
}

#[test]
fn a_child_that_stays_does_not_hold_the_run() {
    let place = Place::with_script(
        "import subprocess\ndef execute(self, inputs, outputs, gvm):\n    self.child = subprocess.Popen(['cat', 'gate'])\n    print(self.child.pid)\n    return 0",
    );
    let gate = place.path("gate");
    mkfifoat(CWD, &gate, Mode::RWXU).unwrap();
    assert_eq!(place.run("").code, Some(0));
    // Without a reader this is refused: the child may be gone.
    drop(rustix::fs::open(&gate, OFlags::WRONLY | OFlags::NONBLOCK, Mode::empty()));
}

#[test]
fn under_a_server_it_is_logged_and_in_the_file() {
    let site = Site::new(SEQUENCE);
    let run = site.start("r1", &json!({}))["id"].as_str().unwrap().to_owned();
    site.until(&run, |now| matches!(now.run.phase, RunPhase::Finished { .. }));
    let get = |what: &str| site.door().ask("GET", &format!("/api/v1/runs/{run}/{what}"), None);
    let page = get("log").unwrap();
    let lines = page["lines"].as_array().unwrap().iter();
    let mut lines: Vec<_> =
        lines.map(|line| format!("{}: {}", line["path"], line["message"])).collect();
    lines.sort_unstable();
    assert_eq!(
        lines,
        [
            r#""ROOT/A": "native""#,
            r#""ROOT/A": "of a child""#,
            r#""ROOT/A": "unfinished""#,
            r#""ROOT/B": "of a shell""#,
            r#""ROOT/B": "printed""#,
        ]
    );
    let output = get("output").unwrap();
    assert_eq!(output["text"], "of a child\nnative\nunfinishedof a shell\n");
}

#[test]
fn of_a_file_that_is_far_ahead_the_end_is_logged_with_the_number_of_bytes_before() {
    let site = Site::new(&one_script(
        "import os\ndef execute(self, inputs, outputs, gvm):\n    os.ftruncate(1, os.fstat(1).st_size + (8 << 20))\n    os.lseek(1, 0, os.SEEK_END)\n    os.write(1, b'\\nthe end\\n')\n    return 0",
    ));
    let run = site.start("r1", &json!({}))["id"].as_str().unwrap().to_owned();
    site.until(&run, |now| matches!(now.run.phase, RunPhase::Finished { .. }));
    let page = site.door().ask("GET", &format!("/api/v1/runs/{run}/log"), None).unwrap();
    let lines = page["lines"].as_array().unwrap().iter();
    let texts: Vec<_> = lines.map(|line| line["message"].as_str().unwrap()).collect();
    assert!(texts.iter().any(|text| text.contains("native code wrote are left out")), "{texts:?}");
    assert_eq!(texts.last(), Some(&"the end"));
}
