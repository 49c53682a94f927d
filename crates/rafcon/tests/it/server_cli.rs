//! The command line at a server: what it does over the network is what it does on this computer.

use crate::harness::{Answer, Place, Run};
use expect_test::{Expect, expect};
use rafcon_storage::journal::folder::ABOUT_FILE;
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::process::{Child, ChildStdout, Stdio};

/// Three states, a log line and a value.
const MACHINE: &str = r#"
hierarchy ROOT "Root"
  outcome success
  in n: int = 1
  out n: int
  start -> ONEXXX
  ONEXXX.success -> TWOXXX ; TWOXXX.success -> .success
  flow .n -> ONEXXX.n ; ONEXXX.n -> TWOXXX.n ; TWOXXX.n -> .n
  execution ONEXXX "One"
    outcome success
    in n: int
    out n: int
    script |
      def execute(self, inputs, outputs, gvm):
          outputs["n"] = inputs["n"] + 1
          self.logger.info("one more than %s" % inputs["n"])
          return 0
  execution TWOXXX "Two"
    outcome success
    in n: int
    out n: int
    script |
      def execute(self, inputs, outputs, gvm):
          outputs["n"] = inputs["n"] * 10
          return 0
"#;

/// A script that continues until it is asked to end.
const WAITS: &str = r#"
def execute(self, inputs, outputs, gvm):
    self.logger.info("here")
    self.wait_for_interruption(60)
    return 1
"#;

/// `rafcon serve` on a folder `robots` with the machine `pick`, until dropped.
struct CliServer {
    place: Place,
    child: Child,
    stdout: BufReader<ChildStdout>,
    port: String,
}

impl CliServer {
    fn with(machine: &str) -> Self {
        let place = Place::empty();
        let machine = notation::parse(machine).unwrap();
        save(&machine, &place.path("robots/pick"), None, Naming::default()).unwrap();
        Self::open(place, "--bind 127.0.0.1:0")
    }

    fn open(place: Place, words: &str) -> Self {
        let mut serve = place.command(&format!("serve robots {words}"));
        let mut child = serve.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut link = String::new();
        stdout.read_line(&mut link).unwrap();
        if link.is_empty() {
            let mut said = String::new();
            child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
            panic!("the server did not begin: {said}");
        }
        let port = link.split(':').nth(2).unwrap();
        let port = port.split(|c: char| !c.is_ascii_digit()).next().unwrap().to_owned();
        Self { place, child, stdout, port }
    }

    /// Killed, and begun again on the same port.
    fn again(mut self) -> Self {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        let words = format!("--bind 127.0.0.1:{}", self.port);
        let place = std::mem::replace(&mut self.place, Place::empty());
        Self::open(place, &words)
    }

    fn words(&self, words: &str) -> String {
        words.replace("SERVER", &format!("--server http://127.0.0.1:{}", self.port))
    }

    fn call(&self, words: &str) -> Answer {
        let mut answer = self.place.call(&self.words(words));
        answer.stderr = self.without_names(&answer.stderr);
        answer.stdout = self.without_names(&answer.stdout);
        answer
    }

    /// A text without what differs from test to test.
    fn without_names(&self, text: &str) -> String {
        let runs = std::fs::read_dir(self.place.path(".local/state/rafcon/runs"));
        let runs = runs.into_iter().flatten().flatten();
        let names = runs.map(|run| run.file_name().to_string_lossy().into_owned());
        names.fold(text.replace(&self.port, "PORT"), |text, run| text.replace(&run, "RUN"))
    }

    fn start(&self, words: &str) -> Run {
        Run::of(self.place.command(&self.words(words)))
    }
}

impl Drop for CliServer {
    /// Runs outlive the server; none outlives the test.
    fn drop(&mut self) {
        let runs = std::fs::read_dir(self.place.path(".local/state/rafcon/runs"));
        for run in runs.into_iter().flatten().flatten() {
            let run = run.file_name().to_string_lossy().into_owned();
            drop(self.place.call(&format!("tell {run} kill")));
        }
        self.child.kill().unwrap_or_default();
        self.child.wait().map(drop).unwrap_or_default();
    }
}

fn shown(answer: &Answer) -> String {
    format!("{}\n{}{}", answer.code.unwrap_or(-1), answer.stdout, answer.stderr)
}

fn check(server: &CliServer, words: &str, expect: &Expect) {
    expect.assert_eq(&shown(&server.call(words)));
}

#[test]
fn a_run_at_a_server_tells_what_one_on_this_computer_does() {
    let server = CliServer::with(MACHINE);
    for words in ["", "--input n=4", "--input n=4 --keep status", "--start-from ROOT/TWOXXX"] {
        let here = server.place.call(&format!("run robots/pick --output json {words}"));
        let there = server.call(&format!("run SERVER robots/pick --output json {words}"));
        assert_eq!(shown(&there), shown(&here), "{words}");
        assert!(here.stdout.contains("finished"), "{}", shown(&here));
    }
}

#[test]
fn a_server_below_a_path_of_a_proxy_is_reached_by_that_path() {
    let place = Place::empty();
    save(&notation::parse(MACHINE).unwrap(), &place.path("robots/pick"), None, Naming::default())
        .unwrap();
    let server = CliServer::open(place, "--bind 127.0.0.1:0 --base-path /fleet/one");
    for address in ["SERVER/fleet/one", "SERVER/fleet/one/", "SERVER"] {
        let answer = server.call(&format!("run {address} robots/pick --output json"));
        assert_eq!(answer.code, Some(0), "{}", shown(&answer));
        let answer = server.call(&format!("runs {address}"));
        assert_eq!(answer.code, Some(0), "{}", shown(&answer));
    }
    assert_ne!(server.call("runs SERVER/fleet/two").code, Some(0));
}

#[test]
fn kept_runs_are_read_at_a_server_as_beside_it() {
    let server = CliServer::with(MACHINE);
    for words in ["", "--input n=4"] {
        let answer = server.call(&format!("run SERVER robots/pick --output json {words}"));
        assert_eq!(answer.code, Some(0), "{answer:?}");
    }
    let runs = server.place.path(".local/state/rafcon/runs");
    let runs = std::fs::read_dir(runs).unwrap().map(|run| run.unwrap().file_name());
    let mut runs: Vec<String> = runs.map(|run| run.into_string().unwrap()).collect();
    runs.sort();
    let [one, other] = &runs[..] else { panic!("{runs:?}") };
    for words in [
        "history last",
        "history last --values --json",
        "history last --kind left --state one --last 1",
        "history last --from 0 --text more",
        "history last --outcome success --to 100",
        "log last",
        "log last --level warning",
        "replay last",
        "replay last --at 3 --json",
        "replay last --time 0.5",
        "replay last --at 99999",
        "export last --format jsonl",
        "export last --format csv",
        &format!("compare {one} {other}"),
        &format!("compare {one} {one} --json"),
    ] {
        let here = shown(&server.place.call(words));
        let there = shown(&server.place.call(&server.words(&format!("{words} SERVER"))));
        assert_eq!(there, here, "{words}");
    }
    let file = server.place.path("there.jsonl");
    let to_file = format!("export last --format jsonl -o {} SERVER", file.display());
    assert_eq!(server.call(&to_file).code, Some(0));
    let here = server.place.call("export last --format jsonl").stdout;
    assert_eq!(
        server.without_names(&std::fs::read_to_string(&file).unwrap()),
        server.without_names(&here)
    );
    assert_eq!(server.call("runs SERVER").code, Some(0));
    let broken = server.place.path(".local/state/rafcon/runs").join("20261121-120000-broken");
    std::fs::create_dir(&broken).unwrap();
    std::fs::write(broken.join(ABOUT_FILE), "{").unwrap();
    for words in ["runs", "runs SERVER"] {
        let answer = server.call(words);
        assert!(answer.code == Some(1) && answer.stdout.contains("unreadable: "), "{answer:?}");
    }
}

#[test]
fn what_is_wrong_with_a_machine_is_told_as_on_this_computer() {
    let server = CliServer::with(MACHINE);
    let file = server.place.path("robots/pick/Two_TWOXXX/core_data.json");
    std::fs::write(file, "{").unwrap();
    let words = "robots/pick --output json";
    let here = server.place.call(&format!("run {words}"));
    let there = server.call(&format!("run SERVER {words}"));
    assert!(here.stdout.contains("is not JSON"), "{}", shown(&here));
    assert_eq!(shown(&there), shown(&here));
}

#[test]
fn a_machine_that_does_not_load_is_told_as_on_this_computer() {
    let server = CliServer::with(MACHINE);
    check(
        &server,
        "run SERVER robots/nothing --output json",
        &expect![[r#"
        1
        {"type":"load_failed","reason":"PLACE/robots/nothing does not exist; give the folder of a state machine or a file in it"}
        error: PLACE/robots/nothing does not exist; give the folder of a state machine or a file in it
    "#]],
    );
}

#[test]
fn what_a_server_decides_itself_is_refused() {
    let server = CliServer::with(MACHINE);
    check(
        &server,
        "run SERVER robots/pick --library-path a=b",
        &expect![[r"
            2
            error: --library-path does not work with --server: the server has its own libraries (`rafcon serve --library-path`); leave it out

            For more information, try '--help'.
        "]],
    );
    check(
        &server,
        "run SERVER robots/pick --python python3",
        &expect![[r"
            2
            error: --python does not work with --server: the server has its own interpreter (`rafcon serve --python`); leave it out

            For more information, try '--help'.
        "]],
    );
    check(
        &server,
        "run SERVER robots/pick --keep off",
        &expect![[r"
            2
            error: --keep off does not work with --server: the server records every run; `--keep status` records the least; leave it out

            For more information, try '--help'.
        "]],
    );
    check(
        &server,
        "run SERVER pick",
        &expect![[r"
            2
            error: pick: write the project and the folder of the machine, such as robots/pick

            For more information, try '--help'.
        "]],
    );
    check(
        &server,
        "attach SERVER nobody",
        &expect![[r"
        2
        error: there is no run `nobody` at http://127.0.0.1:PORT: `rafcon runs --server http://127.0.0.1:PORT` lists them

        For more information, try '--help'.
    "]],
    );
    check(
        &server,
        "run --server http://rover:1 robots/pick",
        &expect![[r"
        2
        error: --server http://rover:1: without TLS, others in the network could read the token; write https://

        For more information, try '--help'.
    "]],
    );
}

#[test]
fn a_run_is_joined_stepped_and_followed_to_its_end() {
    let server = CliServer::with(MACHINE);
    let mut run = server.start("run SERVER robots/pick --hold --break Two --output json");
    run.wait_for("\"held\"");
    let mut guest = server.start("attach SERVER last --from 1 --output json");
    guest.wait_for("\"held\"");
    check(
        &server,
        "tell SERVER last resume",
        &expect![[r"
        0
        applied
    "]],
    );
    guest.wait_for("\"hit\"");
    check(
        &server,
        "tell SERVER last step_back",
        &expect![[r"
        0
        applied
    "]],
    );
    let control = server.call("control SERVER last").stdout;
    assert!(control.starts_with("owner is in control, last active "), "{control}");
    check(
        &server,
        "control SERVER last release",
        &expect![[r"
        0
        no user is in control; the first user to give a command gets control
    "]],
    );
    check(
        &server,
        "tell SERVER last force_outcome path=ROOT outcome=7",
        &expect![[r"
        1
        refused: 'ROOT' has no outcome 7; choose one of its outcomes
    "]],
    );
    guest.wait_for("back");
    check(
        &server,
        "tell SERVER last resume",
        &expect![[r"
        0
        applied
    "]],
    );
    guest.wait_for("\"hit\"");
    check(
        &server,
        "tell SERVER last resume",
        &expect![[r"
        0
        applied
    "]],
    );
    let (code, lines, said) = guest.end();
    assert_eq!((code, &*said), (Some(0), ""), "{lines:?}");
    let (code, more, said) = run.end();
    assert_eq!((code, &*said), (Some(0), ""));
    assert_eq!(more.last(), lines.last());
    let history = server.call("history SERVER last --json").stdout;
    let is_told = |line: &&str| line.contains("\"commanded\"") && !line.contains("control-");
    let commanded: Vec<_> = history.lines().filter(is_told).collect();
    assert_eq!(commanded.len(), 5, "{history}");
    let never = |line: &&&str| line.contains(r#""expiry":null"#);
    assert_eq!(commanded.iter().find(never), None);
}

#[test]
fn a_server_that_is_killed_leaves_no_gap_in_what_is_told() {
    let server = CliServer::with(MACHINE);
    let mut run = server.start("run SERVER robots/pick --hold --output json");
    let held = run.wait_for("\"held\"");
    let server = server.again();
    assert_eq!(shown(&server.call("tell SERVER last step_into")), "0\napplied\n");
    let mut lines = vec![held];
    let to_two = |line: &String| line.contains("held") && line.contains("TWOXXX");
    while !lines.last().is_some_and(to_two) {
        lines.push(run.next_line().unwrap());
    }
    let server = server.again();
    assert_eq!(shown(&server.call("tell SERVER last resume")), "0\napplied\n");
    let (code, rest, said) = run.end();
    lines.extend(rest);
    assert_eq!(code, Some(0), "{said}");
    let all = server.call("attach SERVER last --from 1 --output json").stdout;
    let from_held: Vec<&str> = all.lines().skip_while(|line| !line.contains("held")).collect();
    assert_eq!(lines, from_held);
    let entries = lines.iter().filter(|line| line.contains("entered"));
    expect![[r#"
        {"type":"entered","path":"ROOT/ONEXXX"}
        {"type":"entered","path":"ROOT/TWOXXX"}
    "#]]
    .assert_eq(&entries.flat_map(|line| [line, "\n"]).collect::<String>());
    assert_eq!(said.matches("no connection").count(), 2, "{said}");
    assert_eq!(said.matches("the connection is back").count(), 2, "{said}");
}

#[test]
fn ctrl_c_stops_a_run_at_a_server_and_kills_it_the_second_time() {
    use rustix::process::Signal;
    let server = CliServer::with(&crate::harness::one_script(WAITS));
    let mut run = server.start("run SERVER robots/pick --output json");
    run.wait_for("here");
    run.signal(Signal::INT);
    run.wait_for("\"stopping\"");
    let (code, lines, said) = run.end();
    assert_eq!(code, Some(5), "{said}");
    assert!(lines.last().unwrap().contains("finished"), "{lines:?}");
    assert_eq!(said, "rafcon: stopping; press Ctrl-C again after 2 s to kill\n");
}

#[test]
fn a_run_whose_runner_dies_is_told_with_the_way_out() {
    let script =
        "def execute(self, inputs, outputs, gvm):\n    import os\n    os.kill(os.getpid(), 9)";
    let server = CliServer::with(&crate::harness::one_script(script));
    let mut run = server.start("run SERVER robots/pick --hold --output json");
    run.wait_for("held");
    server.call("tell SERVER last resume");
    let (code, lines, said) = run.end();
    assert_eq!(code, Some(7), "{lines:?} {said}");
    expect![[r#"
        {"type":"died","reason":"the runner died","active":["LONELY"],"stderr":[]}
        error: the Python process that ran the machine died: the runner died
          active states:
            Lonely (LONELY)
          the run is recorded up to this point; resume it:
            rafcon resume RUN --server http://127.0.0.1:PORT --policy abort   (abort the interrupted states; recovery transitions take over)
            rafcon resume RUN --server http://127.0.0.1:PORT                  (wait until you decide)
    "#]].assert_eq(&server.without_names(&format!("{}\n{said}", lines.last().unwrap())));
    let answer = server.call("resume SERVER last --policy abort --output json");
    expect![[r#"
        4
        {"type":"resumed","life":2,"crash":{"reason":"the runner ended before the run","active":["LONELY"]},"policy":"abort"}
        {"type":"entered","path":"LONELY"}
        {"type":"left","path":"LONELY","outcome":{"id":-1,"name":"aborted"},"error":{"__exc__":"RuntimeError","msg":"the runner of this run ended in the middle of it: the runner ended before the run; the scripts of LONELY were running"}}
        {"type":"finished","outcome":{"id":-1,"name":"aborted"},"outputs":{"error":{"__exc__":"RuntimeError","msg":"the runner of this run ended in the middle of it: the runner ended before the run; the scripts of LONELY were running"}},"globals":{},"scoped_variables":{},"states_run":1}
    "#]].assert_eq(&shown(&answer));
}

#[test]
fn only_who_is_known_is_let_in() {
    let server = CliServer::with(MACHINE);
    std::fs::write(server.place.path("wrong"), "wrong").unwrap();
    check(
        &server,
        "runs SERVER --token-file wrong",
        &expect![[r"
        1
        error: this token or login is not known here, or its time is over: log in again, or make a new token (`rafcon login --server URL` gets a token; --token-file and RAFCON_TOKEN name one)
    "]],
    );
    check(
        &server,
        "attach SERVER --token-file nowhere",
        &expect![[r"
        1
        error: cannot read the token in nowhere
          because: No such file or directory (os error 2)
    "]],
    );
    let token = std::fs::read_to_string(server.place.path(".local/state/rafcon/server/token"));
    std::fs::write(server.place.path("right"), token.unwrap()).unwrap();
    check(
        &server,
        "runs SERVER --token-file right",
        &expect![[r"
        0
        no runs at http://127.0.0.1:PORT
    "]],
    );
}

/// Runs a command that reads `input`.
fn piped(place: &Place, words: &str, input: &str) -> Answer {
    let mut command = place.command(words);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    place.answer(&child.wait_with_output().unwrap())
}

#[test]
fn a_server_with_a_certificate_of_its_own_is_known_again_and_lets_users_in() {
    let place = Place::empty();
    let machine = notation::parse(MACHINE).unwrap();
    save(&machine, &place.path("robots/pick"), None, Naming::default()).unwrap();
    let added = piped(&place, "user add ana --role operator", "correct horse\n");
    assert_eq!(added.code, Some(0), "{}", shown(&added));
    let mut server = CliServer::open(place, "--bind 0.0.0.0:0");
    let fingerprint = fingerprint(&mut server.stdout);
    let words = |words: &str| {
        // Another folder for the server's state: as on another computer.
        let there = format!("--server https://127.0.0.1:{} --state elsewhere", server.port);
        words.replace("SERVER", &there).replace("FINGERPRINT", &fingerprint)
    };
    let hidden = |answer: Answer| {
        let text =
            shown(&answer).replace(&server.port, "PORT").replace(&fingerprint, "FINGERPRINT");
        text.lines()
            .filter(|line| !line.contains(':') || line.contains("error"))
            .collect::<Vec<_>>()
            .join("\n")
    };
    let unknown = server.place.call(&words("runs SERVER"));
    expect![[r"
        1
        error: this computer does not know the server at https://127.0.0.1:PORT yet; its certificate has the fingerprint
        Compare it with the one that `rafcon serve` printed, and accept it once with --fingerprint FINGERPRINT"]].assert_eq(&hidden(unknown));
    let wrong =
        server.place.call(&words(&format!("runs SERVER --fingerprint {}", "ab".repeat(32))));
    expect![[r"
        1
        error: THE CERTIFICATE OF https://127.0.0.1:PORT HAS CHANGED: another computer may be listening in. Nothing was sent.
        If the server's administrator confirms the new one, accept it once with --fingerprint FINGERPRINT"]].assert_eq(&hidden(wrong));
    let nobody = server.place.call(&words("runs SERVER --fingerprint FINGERPRINT"));
    expect![[r"
        1
        error: nobody is logged in: send a token, or log in at /api/v1/session (`rafcon login --server URL` gets a token; --token-file and RAFCON_TOKEN name one)"]].assert_eq(&hidden(nobody));
    let failed = piped(&server.place, &words("login SERVER --user ana"), "wrong horse\n");
    expect![[r"
        1
        error: this is not a user and their password: try again, or ask an admin for another (`rafcon login --server URL` gets a token; --token-file and RAFCON_TOKEN name one)"]].assert_eq(&hidden(failed));
    let known = piped(&server.place, &words("login SERVER --user ana"), "correct horse\n");
    assert_eq!(known.code, Some(0), "{}", shown(&known));
    let run = server.place.call(&words("run SERVER robots/pick --input n=1 --output json"));
    assert_eq!(
        (run.code, run.last()["outputs"]["n"].as_i64()),
        (Some(0), Some(20)),
        "{}",
        shown(&run)
    );
}

/// What the server prints about its certificate.
fn fingerprint(stdout: &mut BufReader<ChildStdout>) -> String {
    let hex = |line: &str| {
        let digits: String = line.trim().chars().filter(|c| *c != ':').collect();
        (digits.len() == 64 && digits.chars().all(|c| c.is_ascii_hexdigit())).then_some(digits)
    };
    loop {
        let mut line = String::new();
        assert!(stdout.read_line(&mut line).unwrap() > 0, "no fingerprint");
        if let Some(found) = hex(&line) {
            return found.to_ascii_lowercase();
        }
    }
}
