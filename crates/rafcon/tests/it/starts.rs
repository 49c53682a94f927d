//! Starts whose server or runner dies at any step of them: the same request gives the same run, exactly once, or says why there
//! is none. The steps are chosen by what the interpreter does when it starts, before it becomes a runner: it runs what lies in
//! the file `fails`, once.

use crate::harness::{Place, assert_extension};
use crate::served::{Door, Served};
use anyhow::Result;
use expect_test::{Expect, expect};
use rafcon_protocol::api::RunPhase;
use rafcon_protocol::socket::{ToClient, ToServer, Topic};
use rafcon_storage::journal::Reader;
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
use serde_json::{Value, json};
use std::fs;
use std::os::unix::fs::symlink;
use std::process::Command;

/// Run by every interpreter that starts.
const CUSTOMIZE: &str = r#"
import os, resource, signal

def dies_at(size):
    """The process dies of the first file that it writes to beyond this size."""
    signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))

def kills_server():
    os.kill(os.getppid(), signal.SIGKILL)

if os.path.exists("fails"):
    with open("fails") as file:
        text = file.read()
    os.remove("fails")
    exec(text)
"#;

/// Leaves a line in a file, and does what the file `script` says, once.
const EFFECT: &str = r#"
execution LONELY "Lonely"
  outcome success
  in times: int = 1
  script |
    import ctypes, os, signal
    def execute(self, inputs, outputs, gvm):
        with open("effect", "a") as file:
            file.write("x" * inputs["times"] + "\n")
        if os.path.exists("script"):
            with open("script") as file:
                text = file.read()
            os.remove("script")
            exec(text)
        return "success"
"#;

/// The sizes of files at which a runner that begins a run dies: the first that it writes, its database, its recorder.
const SIZES: [&str; 3] = ["dies_at(0)", "dies_at(20000)", "dies_at(1000000)"];

/// A place with a project, its machine, and at times a server.
struct Site {
    place: Place,
    served: Option<Served>,
}

impl Site {
    fn new() -> Self {
        assert_extension();
        let place = Place::empty();
        let machine = notation::parse(EFFECT).unwrap();
        save(&machine, &place.path("project/machine"), None, Naming::default()).unwrap();
        fs::create_dir(place.path("site")).unwrap();
        fs::write(place.path("site/sitecustomize.py"), CUSTOMIZE).unwrap();
        Self { place, served: None }
    }

    /// The next interpreter that starts, or the next script that runs, does this.
    fn put(&mut self, file: &str, python: &str) -> &mut Self {
        fs::write(self.place.path(file), python).unwrap();
        self
    }

    fn command(&self, words: &str) -> Command {
        let mut command = self.place.command(words);
        command.env("PYTHONPATH", self.place.path("site"));
        command
    }

    fn serve(&mut self) {
        self.served = None;
        let words = "serve project --bind 127.0.0.1:0 --state state --runs runs --keep-token";
        self.served = Some(Served::start(self.command(words)).unwrap());
    }

    fn door(&self) -> &Door {
        self.served.as_ref().unwrap().door()
    }

    fn ask(&self, more: &Value) -> Result<(u16, Value)> {
        let machine = json!({ "project": "project", "path": "machine" });
        let mut body = json!({ "id": "start", "machine": machine, "inputs": { "times": 2 } });
        body.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        let (status, text) = self.door().answer("POST", "/api/v1/runs", Some(&body))?;
        Ok((status, serde_json::from_str(&text)?))
    }

    /// The folders of runs.
    fn runs(&self) -> Vec<String> {
        let entries = fs::read_dir(self.place.path("runs")).into_iter().flatten().flatten();
        entries.map(|entry| entry.file_name().into_string().unwrap()).collect()
    }

    /// What scripts have left, with what has become of the run once nothing runs in it.
    fn ending(&self, run: &str) -> String {
        let mut line = self.door().line().unwrap();
        let topic = Topic::RunStatus { run: run.to_owned() };
        line.say(&ToServer::Subscribe { subscription: 1, topic }).unwrap();
        let phase = loop {
            match line.hear().unwrap() {
                ToClient::RunStatus { status, .. } => match status.run.phase {
                    RunPhase::Live | RunPhase::Starting => {}
                    RunPhase::Finished { .. } => break "finished",
                    RunPhase::Crashed => break "crashed",
                    other => panic!("{other:?}"),
                },
                other => panic!("{other:?}"),
            }
        };
        let effect = fs::read_to_string(self.place.path("effect")).unwrap_or_default();
        format!("{phase} after {effect:?}")
    }
}

/// Asks for a run until there is an answer, with a new server after each that died; and once more after that. What was
/// answered, and what has become of it.
fn asked(site: &mut Site, more: &Value) -> String {
    let mut answers = Vec::new();
    let run = loop {
        site.serve();
        match site.ask(more) {
            Ok((200, run)) => break run["id"].as_str().unwrap().to_owned(),
            Ok((status, refusal)) => {
                answers.push(format!("{status} {}", refusal["code"].as_str().unwrap()));
                assert!(answers.len() < 3, "{refusal}");
            }
            Err(_lost) => answers.push("no answer".to_owned()),
        }
        let known = site.runs();
        assert!(known.len() <= 1, "{known:?}");
    };
    assert_eq!(site.runs(), [run.as_str()]);
    answers.push(site.ending(&run));
    let (status, again) = site.ask(more).unwrap();
    assert_eq!((status, again["id"].as_str().unwrap()), (200, run.as_str()));
    assert_eq!(site.runs(), [run.as_str()]);
    answers.join(", ")
}

fn check(fails: &str, script: &str, more: &Value, expect: &Expect) {
    let mut site = Site::new();
    for (file, python) in [("fails", fails), ("script", script)] {
        if !python.is_empty() {
            site.put(file, python);
        }
    }
    expect.assert_eq(&asked(&mut site, more));
}

#[test]
fn a_server_that_dies_while_it_starts_a_run_has_started_it_once() {
    let once = &expect![[r#"no answer, finished after "xx\n""#]];
    check("kills_server()", "", &json!({}), once);
    check("kills_server(); os._exit(9)", "", &json!({}), once);
}

#[test]
fn a_server_that_dies_of_the_first_script_has_started_the_run_once() {
    let mut site = Site::new();
    site.put("script", "os.kill(os.getppid(), signal.SIGKILL)").serve();
    // It may die before it answers or after.
    let answered = site.ask(&json!({})).map(|(_, run)| run["id"].as_str().unwrap().to_owned());
    let server = site.served.take().unwrap();
    let pid = Pid::from_raw(server.pid().cast_signed()).unwrap();
    waitid(WaitId::Pid(pid), WaitIdOptions::EXITED | WaitIdOptions::NOWAIT).unwrap();
    drop(server);
    assert_eq!(asked(&mut site, &json!({})), "finished after \"xx\\n\"");
    let run = site.runs().remove(0);
    assert_eq!(answered.unwrap_or_else(|_lost| run.clone()), run);
}

#[test]
fn a_server_and_a_runner_that_die_at_any_step_of_a_start_have_started_the_run_once() {
    for size in SIZES {
        let once = &expect![[r#"no answer, finished after "xx\n""#]];
        check(&format!("{size}; kills_server()"), "", &json!({}), once);
    }
}

#[test]
fn a_start_whose_runner_dies_before_anything_has_happened_is_refused_and_can_be_repeated() {
    let refused = &expect![[r#"422 not_started, finished after "xx\n""#]];
    check("os._exit(9)", "", &json!({}), refused);
    for size in SIZES {
        check(size, "", &json!({}), refused);
    }
}

#[test]
fn a_runner_that_dies_before_anything_has_happened_is_followed_by_another_where_the_policy_says_so()
{
    let more = &json!({ "on_crash": "restart" });
    let begun = &expect![[r#"finished after "xx\n""#]];
    check("os._exit(9)", "", more, begun);
    for size in SIZES {
        check(size, "", more, begun);
    }
}

#[test]
fn the_command_line_begins_a_run_again_whose_runner_died_before_anything_had_happened() {
    for size in SIZES {
        let mut site = Site::new();
        let words = "run project/machine --runs runs --input times=3 --on-crash restart";
        let output = site.put("fails", size).command(words).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{size}: {said}");
        assert!(said.contains("the run is started again"), "{size}: {said}");
        assert_eq!(site.runs().len(), 1);
        assert_eq!(fs::read_to_string(site.place.path("effect")).unwrap(), "xxx\n");
    }
}

#[test]
fn a_first_script_that_kills_its_process_at_once_leaves_a_run_with_a_journal() {
    assert_kept("os._exit(0)");
    assert_kept("os.kill(os.getpid(), 9)");
}

#[test]
fn a_first_script_that_crashes_its_process_at_once_leaves_a_run_with_a_journal() {
    assert_kept("os.abort()");
    assert_kept("ctypes.string_at(0)");
}

fn assert_kept(script: &str) {
    let mut site = Site::new();
    site.put("script", script);
    let answers = asked(&mut site, &json!({}));
    assert_eq!(answers, "crashed after \"xx\\n\"", "{script}");
    let folder = site.place.path("runs").join(&site.runs()[0]);
    let mut reader = Reader::open(&folder).unwrap();
    let entries = reader.page(1, 100).unwrap();
    let told = entries.iter().map(|entry| reader.event(entry, false).unwrap());
    let told: Vec<String> = told.map(|event| format!("{event:?}")).collect();
    assert!(told.iter().any(|event| event.starts_with("Entered")), "{script}: {told:?}");
}

#[test]
fn a_first_script_that_kills_its_process_at_once_is_resumed_where_the_policy_says_so() {
    let twice = &expect![[r#"finished after "xx\nxx\n""#]];
    check("", "os._exit(0)", &json!({ "on_crash": "restart" }), twice);
}

#[test]
fn inputs_of_a_client_import_nothing() {
    let mut site = Site::new();
    let module = "open('imported', 'w').close()\nclass Robot:\n    from_dict = classmethod(lambda cls, members: 1)\n";
    fs::write(site.place.path("site/reset_robot.py"), module).unwrap();
    site.serve();
    for value in [
        json!({ "__type__": "reset_robot.Robot" }),
        json!([{ "__jsonqualname__": "reset_robot.Robot" }]),
    ] {
        let (status, refusal) = site.ask(&json!({ "inputs": { "times": value } })).unwrap();
        assert_eq!((status, refusal["code"].as_str().unwrap()), (422, "load_failed"));
        let message = refusal["message"].as_str().unwrap();
        assert!(message.contains("no class is imported for a client"), "{message}");
    }
    assert!(!site.place.path("imported").exists());
}

#[test]
fn an_input_that_the_machine_does_not_have_is_refused_and_leaves_nothing() {
    let mut site = Site::new();
    site.serve();
    let (status, refusal) = site.ask(&json!({ "inputs": { "tiems": 2 } })).unwrap();
    assert_eq!((status, refusal["code"].as_str().unwrap()), (422, "load_failed"));
    let message = refusal["message"].as_str().unwrap();
    assert_eq!(message, "the machine has no input `tiems`: it has `times`");
    assert_eq!(site.runs(), [""; 0]);
}

#[test]
fn a_started_machine_is_read_in_its_project_and_nowhere_else() {
    for (to, why) in [
        ("../../secret", "leads out of the folders that may be read"),
        ("/dev/zero", "leads out of the folders that may be read"),
    ] {
        let mut site = Site::new();
        fs::write(site.place.path("secret"), "secret").unwrap();
        let script = site.place.path("project/machine/script.py");
        fs::remove_file(&script).unwrap();
        symlink(to, &script).unwrap();
        site.serve();
        let (status, refusal) = site.ask(&json!({})).unwrap();
        assert_eq!((status, refusal["code"].as_str().unwrap()), (422, "load_failed"));
        let message = refusal["message"].as_str().unwrap();
        assert!(message.contains("script.py") && message.contains(why), "{message}");
        assert_eq!(site.runs(), [""; 0]);
    }
}
