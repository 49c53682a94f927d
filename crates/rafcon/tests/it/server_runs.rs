//! Runs under a server: begun once, found again, resumed, commanded by one at a time. With the real server, real runners and
//! nothing in between.

use crate::harness::{Place, Run, assert_extension};
use crate::served::{Door, Line, Served};
use expect_test::{Expect, expect};
use rafcon_protocol::api::{HistoryEntry, Role, RunNow, RunPhase, RunSummary};
use rafcon_protocol::socket::{ToClient, ToServer, Topic};
use rafcon_protocol::{Command, Event};
use rafcon_server::access::Users;
use rafcon_server::settings::HashCost;
use rafcon_storage::journal::{Reader, Record, size_of, writer_of};
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};

/// What hashing a password costs here: next to nothing.
pub(crate) const CHEAP: HashCost = HashCost { memory_kib: 8, passes: 1 };

/// A script that continues until it is asked to end, after it has said so past every capture.
pub(crate) const WAITS: &str = r#"
hierarchy ROOT "Waits"
  outcome done
  var speed: int = 7
  start -> A
  A.ok -> .done
  A.aborted -> B
  B.ok -> .done
  execution A
    outcome ok
    script |
      import os
      def execute(self, inputs, outputs, gvm):
          gvm.set_variable("mode", "slow")
          os.write(1, b"past the capture\n")
          self.preemptive_wait()
          return "preempted"
  execution B
    outcome ok
    script |
      def execute(self, inputs, outputs, gvm):
          return "ok"
"#;

/// A script that heeds nothing, and is cut off soon after it was asked to end.
const HANGS: &str = r#"
hierarchy ROOT "Hangs"
  outcome done
  start -> A
  A.ok -> .done
  A.aborted -> A
  semantic {"grace_s": 0.1}
  execution A
    outcome ok
    script |
      def execute(self, inputs, outputs, gvm):
          while True:
              pass
"#;

/// A place with a project, its machine, and a server.
pub(crate) struct Site {
    pub(crate) place: Place,
    pub(crate) served: Option<Served>,
}

impl Site {
    pub(crate) fn new(machine: &str) -> Self {
        assert_extension();
        let place = Place::empty();
        let machine = notation::parse(machine).unwrap();
        save(&machine, &place.path("project/machine"), None, Naming::default()).unwrap();
        let mut site = Self { place, served: None };
        site.serve();
        site
    }

    /// Another server, after the one before was killed.
    pub(crate) fn serve(&mut self) {
        self.served = None;
        let words = "serve project --bind 127.0.0.1:0 --state state --runs runs --keep-token";
        self.served = Some(Served::start(self.place.command(words)).unwrap());
    }

    pub(crate) fn door(&self) -> &Door {
        self.served.as_ref().unwrap().door()
    }

    /// The same for a user with this role.
    pub(crate) fn door_of(&self, user: &str, role: Role) -> Door {
        let users = Users::open(&self.place.path("state"), CHEAP).unwrap();
        users.add(user, role, "correct horse").unwrap();
        let wanted = serde_json::from_value(json!({ "name": "tests" })).unwrap();
        let token = users.make_token(user, role, &wanted).unwrap().token;
        Door { address: self.door().address, token }
    }

    pub(crate) fn start(&self, id: &str, more: &Value) -> Value {
        let mut body = json!({ "id": id, "machine": { "project": "project", "path": "machine" } });
        body.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        self.door().ask("POST", "/api/v1/runs", Some(&body)).unwrap()
    }

    /// The status of a run once it is as wanted.
    pub(crate) fn until(&self, run: &str, wanted: impl Fn(&RunNow) -> bool) -> RunNow {
        let mut line = self.line(Topic::RunStatus { run: run.to_owned() });
        loop {
            match line.hear().unwrap() {
                ToClient::RunStatus { status, .. } if wanted(&status) => return *status,
                ToClient::RunStatus { .. } => {}
                other => panic!("{other:?}"),
            }
        }
    }

    fn line(&self, topic: Topic) -> Line {
        let mut line = self.door().line().unwrap();
        line.say(&ToServer::Subscribe { subscription: 1, topic }).unwrap();
        line
    }

    pub(crate) fn kill_runner(&self, run: &str) {
        let writer = writer_of(&self.place.path("runs").join(run)).unwrap().unwrap();
        kill_process(Pid::from_raw(writer.cast_signed()).unwrap(), Signal::KILL).unwrap();
    }

    /// The events of a run in its journal, in short.
    pub(crate) fn journal(&self, run: &str) -> Vec<String> {
        let mut reader = Reader::open(&self.place.path("runs").join(run)).unwrap();
        let entries = reader.page(1, 1000).unwrap();
        let told = entries.iter().filter_map(|entry| match &entry.record {
            Record::Told(event) => text(event),
            _ => None,
        });
        told.collect()
    }
}

impl Drop for Site {
    fn drop(&mut self) {
        self.served = None;
        let runs = std::fs::read_dir(self.place.path("runs")).into_iter().flatten().flatten();
        for run in runs {
            let writer = writer_of(&run.path()).ok().flatten();
            if let Some(pid) = writer.and_then(|pid| Pid::from_raw(pid.cast_signed())) {
                kill_process(pid, Signal::KILL).unwrap_or_default();
            }
        }
    }
}

fn text(event: &Event) -> Option<String> {
    match event {
        Event::Commanded { envelope, answer } => {
            let command = match &envelope.command {
                Command::Control { holder } => {
                    format!("control to {}", holder.as_deref().unwrap_or("nobody"))
                }
                command => serde_json::to_value(command).unwrap()["type"].as_str()?.to_owned(),
            };
            Some(format!("{command} by {}: {answer:?}", envelope.author))
        }
        Event::Resumed { life, policy, .. } => Some(format!("life {life} {policy:?}")),
        Event::Finished { outcome, .. } => Some(format!("finished {}", outcome.name)),
        _ => None,
    }
}

pub(crate) fn command(door: &Door, run: &str, id: &str, command: &Value) -> String {
    let body = json!({ "id": id, "command": command });
    said(door, "POST", &format!("/api/v1/runs/{run}/commands"), Some(&body))
}

pub(crate) fn control(door: &Door, run: &str, wanted: &Value) -> String {
    said(door, "POST", &format!("/api/v1/runs/{run}/control"), Some(wanted))
}

/// Status, and what of the answer says most.
pub(crate) fn said(door: &Door, method: &str, path: &str, body: Option<&Value>) -> String {
    let (status, text) = door.answer(method, path, body).unwrap();
    let json: Value = serde_json::from_str(&text).unwrap();
    let word = ["answer", "code", "holder"].iter().find_map(|name| json[name].as_str());
    format!("{status} {}", word.unwrap_or("-"))
}

pub(crate) fn is_running(now: &RunNow) -> bool {
    let active = now.snapshot.as_ref().is_some_and(|snapshot| snapshot.active.len() == 2);
    now.run.phase == RunPhase::Live && active
}

pub(crate) fn check(lines: &[String], expect: &Expect) {
    expect.assert_eq(&lines.join("\n"));
}

#[test]
fn a_request_starts_one_run_and_a_server_that_was_killed_leaves_it_going() {
    let mut site = Site::new(WAITS);
    let run = site.start("r1", &json!({}))["id"].as_str().unwrap().to_owned();
    assert_eq!(site.start("r1", &json!({}))["id"], run.as_str());
    site.until(&run, is_running);
    site.serve();
    assert_eq!(site.start("r1", &json!({}))["id"], run.as_str());
    let now = site.until(&run, is_running);
    assert_eq!((now.run.author.as_deref(), now.run.name.as_str()), (Some("owner"), "Waits"));
    let stop = json!({ "type": "stop" });
    let answers = [
        command(site.door(), &run, "c1", &stop),
        said(site.door(), "GET", &format!("/api/v1/runs/{run}/control"), None),
    ];
    check(
        &answers,
        &expect![[r"
        200 applied
        200 -"]],
    );
    site.until(&run, |now| matches!(now.run.phase, RunPhase::Finished { .. }));
    // Asked for again it has its answer again, from the journal.
    check(
        &[
            command(site.door(), &run, "c1", &stop),
            command(site.door(), &run, "c2", &stop),
            said(
                site.door(),
                "POST",
                &format!("/api/v1/runs/{run}/resume"),
                Some(&json!({ "id": "x" })),
            ),
        ],
        &expect![[r"
            200 applied
            409 run_is_not_live
            409 run_is_over"]],
    );
    check(
        &site.journal(&run),
        &expect![[r"
        stop by owner: Applied
        finished preempted"]],
    );
}

#[test]
fn a_runner_that_dies_is_resumed_by_its_policy() {
    let site = Site::new(WAITS);
    let run =
        site.start("r1", &json!({ "on_crash": "restart" }))["id"].as_str().unwrap().to_owned();
    let before = site.until(&run, is_running).snapshot.unwrap().sequence;
    site.kill_runner(&run);
    site.until(&run, |now| {
        is_running(now) && now.snapshot.as_ref().is_some_and(|now| now.sequence > before)
    });
    assert_eq!(command(site.door(), &run, "stop", &json!({ "type": "stop" })), "200 applied");
    site.until(&run, |now| matches!(now.run.phase, RunPhase::Finished { .. }));
    check(
        &site.journal(&run),
        &expect![[r"
        life 2 Restart
        stop by owner: Applied
        finished preempted"]],
    );
}

#[test]
fn a_script_that_hangs_is_stopped_under_every_policy() {
    for policy in ["ask", "abort", "restart"] {
        let site = Site::new(HANGS);
        let start = site.start("r1", &json!({ "on_crash": policy }));
        let run = start["id"].as_str().unwrap().to_owned();
        site.until(&run, is_running);
        assert_eq!(command(site.door(), &run, "stop", &json!({ "type": "stop" })), "200 applied");
        let now = site.until(&run, |now| matches!(now.run.phase, RunPhase::Finished { .. }));
        let RunPhase::Finished { outcome, .. } = now.run.phase else { unreachable!() };
        assert_eq!(outcome.name, "preempted", "{policy}");
    }
}

#[test]
fn without_a_policy_a_dead_runner_waits_for_somebody_to_take_its_run_up() {
    let site = Site::new(WAITS);
    let run = site.start("r1", &json!({}))["id"].as_str().unwrap().to_owned();
    site.until(&run, is_running);
    site.kill_runner(&run);
    site.until(&run, |now| now.run.phase == RunPhase::Crashed);
    let resume = |id: &str| {
        let body = json!({ "id": id, "policy": "abort" });
        said(site.door(), "POST", &format!("/api/v1/runs/{run}/resume"), Some(&body))
    };
    let answers = [
        command(site.door(), &run, "late", &json!({ "type": "pause" })),
        resume("u1"),
        resume("u1"),
    ];
    site.until(&run, |now| matches!(now.run.phase, RunPhase::Finished { .. }));
    check(
        &answers,
        &expect![[r"
        409 run_is_not_live
        200 -
        200 -"]],
    );
    check(
        &site.journal(&run),
        &expect![[r"
        life 2 Abort
        finished done"]],
    );
}

#[test]
fn the_machine_of_a_run_can_be_had_as_soon_as_it_has_begun() {
    let many: Vec<_> =
        (0..400).map(|number| format!("  execution S{number:05}\n    outcome ok\n")).collect();
    let many = many.concat();
    let site = Site::new(&format!("{WAITS}{many}"));
    for keeping in ["full", "status"] {
        let run = site.start(keeping, &json!({ "keeping": keeping }));
        let path = format!("/api/v1/runs/{}/machine", run["id"].as_str().unwrap());
        let machine = site.door().ask("GET", &path, None).unwrap();
        assert_eq!(machine["states"].as_array().unwrap().len(), 403, "{keeping}");
    }
}

/// All that is told from a cursor on until the run is over, and the cursor to continue with.
fn told(mut line: Line) -> (Vec<HistoryEntry>, u64) {
    let (mut told, mut cursor) = (Vec::new(), 0);
    loop {
        match line.hear().unwrap() {
            ToClient::Events { events, next, .. } => {
                told.extend(events);
                cursor = next;
            }
            ToClient::Ended { refusal: None, .. } => return (told, cursor),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_run_of_one_state_enters_the_root_once() {
    let site = Site::new(WAITS);
    let run = site.start("r1", &json!({ "start_from": "ROOT/B", "afterwards": "stop" }));
    let run = run["id"].as_str().unwrap().to_owned();
    let history = site.line(Topic::RunHistory { run, from: 1, values: false });
    let entered = told(history).0.into_iter().filter_map(|entry| match entry.event {
        Event::Entered { path, .. } => Some(path),
        _ => None,
    });
    assert_eq!(entered.collect::<Vec<_>>(), ["ROOT", "ROOT/B"]);
}

#[test]
fn a_history_goes_on_over_a_crash_and_is_told_further_when_a_run_that_was_over_is_resumed() {
    let site = Site::new(WAITS);
    let run = site.start("r1", &json!({}))["id"].as_str().unwrap().to_owned();
    let follow = |from| site.line(Topic::RunHistory { run: run.clone(), from, values: true });
    let resume =
        |body: &Value| said(site.door(), "POST", &format!("/api/v1/runs/{run}/resume"), Some(body));
    let from_the_start = follow(1);
    site.until(&run, is_running);
    site.kill_runner(&run);
    site.until(&run, |now| now.run.phase == RunPhase::Crashed);
    let since_the_crash = follow(1);
    assert_eq!(resume(&json!({ "id": "u1", "policy": "abort" })), "200 -");
    let (mut events, cursor) = told(from_the_start);
    assert_eq!(told(since_the_crash), (events.clone(), cursor));
    let entry = events
        .iter()
        .find(|entry| matches!(&entry.event, Event::Entered { path, .. } if path.ends_with("/A")));
    let from = entry.unwrap().sequence;
    assert_eq!(resume(&json!({ "id": "u2", "policy": "restart", "from": from })), "200 -");
    site.until(&run, |now| now.run.phase == RunPhase::Live);
    assert_eq!(command(site.door(), &run, "go", &json!({ "type": "resume" })), "200 applied");
    site.until(&run, is_running);
    let further = follow(cursor);
    assert_eq!(command(site.door(), &run, "stop", &json!({ "type": "stop" })), "200 applied");
    events.extend(told(further).0);
    let sequences: Vec<u64> = events.iter().map(|entry| entry.sequence).collect();
    assert_eq!(sequences, (1..=sequences.len() as u64).collect::<Vec<_>>());
    assert_eq!(told(follow(1)).0, events);
}

/// At first with more values than the last event has, the second time with few.
const ENDS_TWICE: &str = r#"
hierarchy ROOT "Ends twice"
  outcome success
  out numbers: list
  start -> AXXXXX
  AXXXXX.success -> .success
  flow AXXXXX.numbers -> .numbers
  execution AXXXXX "A"
    outcome success
    out numbers: list
    script |
      import os
      def execute(self, inputs, outputs, gvm):
          ended = os.path.expanduser("~/ended")
          outputs["numbers"] = [7] * (3 if os.path.exists(ended) else 30_000)
          open(ended, "w").close()
          return 0
"#;

#[test]
fn the_results_of_a_run_that_is_resumed_after_its_end_are_those_of_its_new_end() {
    let site = Site::new(ENDS_TWICE);
    let run = site.start("r1", &json!({}))["id"].as_str().unwrap().to_owned();
    let results = || site.door().ask("GET", &format!("/api/v1/runs/{run}/results"), None);
    let is_over = |now: &RunNow| matches!(now.run.phase, RunPhase::Finished { .. });
    site.until(&run, is_over);
    assert_eq!(results().unwrap()["outputs"]["numbers"].as_array().unwrap().len(), 30_000);
    let body = json!({ "id": "u1", "policy": "restart", "from": 2 });
    said(site.door(), "POST", &format!("/api/v1/runs/{run}/resume"), Some(&body));
    site.until(&run, |now| now.run.phase == RunPhase::Live);
    assert!(results().is_err());
    assert_eq!(command(site.door(), &run, "go", &json!({ "type": "resume" })), "200 applied");
    site.until(&run, is_over);
    assert_eq!(results().unwrap()["outputs"], json!({ "numbers": [7, 7, 7] }));
}

#[test]
fn what_dies_with_its_server_is_resumed_by_the_next_one() {
    let mut site = Site::new(WAITS);
    let run = site.start("r1", &json!({ "on_crash": "abort" }))["id"].as_str().unwrap().to_owned();
    site.until(&run, is_running);
    site.served = None;
    site.kill_runner(&run);
    site.serve();
    site.until(&run, |now| matches!(now.run.phase, RunPhase::Finished { .. }));
    check(
        &site.journal(&run),
        &expect![[r"
        life 2 Abort
        finished done"]],
    );
}

#[test]
fn the_status_of_a_run_that_stands_still_carries_the_time_of_the_answer() {
    let site = Site::new(WAITS);
    let run = site.start("r1", &json!({}))["id"].as_str().unwrap().to_owned();
    site.until(&run, is_running);
    let path = format!("/api/v1/runs/{run}");
    let ask = || site.door().ask("GET", &path, None).unwrap()["now_ms"].as_u64().unwrap();
    for _ in 0..3 {
        let before = rafcon_supervisor::clock::since_1970_ms();
        let said = ask();
        let after = rafcon_supervisor::clock::since_1970_ms();
        assert!((before..=after).contains(&said), "{before} {said} {after}");
    }
}

#[test]
fn the_list_of_runs_says_what_a_run_takes_by_now() {
    let site = Site::new(WAITS);
    let run = site.start("r1", &json!({}))["id"].as_str().unwrap().to_owned();
    site.until(&run, is_running);
    let size = || size_of(&site.place.path("runs").join(&run));
    let before = size();
    let runs = site.door().ask("GET", "/api/v1/runs", None).unwrap();
    let told = runs[0]["bytes"].as_u64().unwrap();
    let after = size();
    assert!((before..=after).contains(&told), "{before} {told} {after}");
}

#[test]
fn a_run_that_somebody_kills_is_left_alone() {
    let site = Site::new(WAITS);
    let run =
        site.start("r1", &json!({ "on_crash": "restart" }))["id"].as_str().unwrap().to_owned();
    site.until(&run, is_running);
    // A kill overtakes what is under way: that control was taken is noted before.
    let step = json!({ "type": "step_mode" });
    assert_eq!(command(site.door(), &run, "step", &step), "200 applied");
    assert_eq!(command(site.door(), &run, "kill", &json!({ "type": "kill" })), "200 applied");
    site.until(&run, |now| now.run.phase == RunPhase::Crashed);
    check(
        &site.journal(&run),
        &expect![[r"
            control to owner by owner: Applied
            step_mode by owner: Applied
            kill by owner: Applied"]],
    );
}

#[test]
fn a_run_of_the_command_line_appears_and_is_commanded() {
    let site = Site::new(WAITS);
    let mut line = site.line(Topic::ServerStatus);
    let words = "run project/machine --output json --runs runs";
    let mut console = Run::of(site.place.command(words));
    console.wait_for("\"entered\"");
    let run = loop {
        match line.hear().unwrap() {
            ToClient::ServerStatus { status, .. } => {
                let is_live = |run: &&RunSummary| run.phase == RunPhase::Live;
                if let Some(run) = status.runs.iter().find(is_live) {
                    break run.clone();
                }
            }
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(run.author, None);
    assert_eq!(run.machine.unwrap().path, "machine");
    site.until(&run.id, is_running);
    assert_eq!(command(site.door(), &run.id, "stop", &json!({ "type": "stop" })), "200 applied");
    let (code, lines, _said) = console.end();
    assert_eq!(code, Some(5), "{lines:?}");
}

#[test]
fn one_at_a_time_commands_a_run_and_the_journal_knows_who() {
    let site = Site::new(WAITS);
    let run = site.start("r1", &json!({}))["id"].as_str().unwrap().to_owned();
    site.until(&run, is_running);
    let (ana, bob) = (site.door_of("ana", Role::Operator), site.door_of("bob", Role::Operator));
    let vera = site.door_of("vera", Role::Viewer);
    let (go, wait) = (json!({ "type": "resume" }), json!({ "type": "pause" }));
    let answers = [
        command(&ana, &run, "1", &wait),
        command(&ana, &run, "2", &go),
        command(&bob, &run, "3", &go),
        command(&vera, &run, "4", &wait),
        command(&bob, &run, "5", &wait),
        control(&bob, &run, &json!({ "move": "take_over" })),
        control(&bob, &run, &json!({ "move": "request" })),
        control(&ana, &run, &json!({ "move": "hand_over", "to": "bob" })),
        command(&bob, &run, "6", &go),
        control(&bob, &run, &json!({ "move": "release" })),
        command(&bob, &run, "7", &json!({ "type": "control", "holder": "bob" })),
        command(&ana, &run, "8", &json!({ "type": "reload" })),
        command(&ana, &run, "9", &json!({ "type": "stop" })),
    ];
    check(
        &answers,
        &expect![[r"
        200 applied
        200 applied
        409 not_in_control
        403 not_your_right
        200 applied
        409 not_in_control
        200 ana
        200 bob
        200 applied
        200 -
        400 use_control
        403 not_your_right
        200 applied"]],
    );
    site.until(&run, |now| matches!(now.run.phase, RunPhase::Finished { .. }));
    check(
        &site.journal(&run),
        &expect![[r"
        pause by ana: Applied
        control to ana by ana: Applied
        resume by ana: Applied
        pause by bob: Applied
        control to bob by ana: Applied
        resume by bob: Applied
        control to nobody by bob: Applied
        stop by ana: Applied
        finished preempted"]],
    );
}

#[test]
fn a_command_that_the_run_refuses_gives_nobody_control() {
    let site = Site::new(WAITS);
    let run = site.start("r1", &json!({}))["id"].as_str().unwrap().to_owned();
    site.until(&run, is_running);
    let (ana, bob) = (site.door_of("ana", Role::Operator), site.door_of("bob", Role::Operator));
    let (wrong, go) = (
        json!({ "type": "answer_question", "question": 77, "value": 33 }),
        json!({ "type": "step_mode" }),
    );
    let answers = [
        command(&ana, &run, "1", &wrong),
        command(&bob, &run, "2", &go),
        command(&bob, &run, "3", &wrong),
        command(&ana, &run, "4", &go),
        command(&bob, &run, "5", &json!({ "type": "stop" })),
    ];
    check(
        &answers,
        &expect![[r"
            200 refused
            200 applied
            200 refused
            409 not_in_control
            200 applied"]],
    );
}

#[test]
fn what_a_run_holds_and_wrote_can_be_asked() {
    let site = Site::new(WAITS);
    let point = json!({ "id": 3, "path": "ROOT/B" });
    let run =
        site.start("r1", &json!({ "breakpoints": [point] }))["id"].as_str().unwrap().to_owned();
    site.until(&run, is_running);
    let get = |what: &str| {
        let (status, text) =
            site.door().answer("GET", &format!("/api/v1/runs/{run}/{what}"), None).unwrap();
        let json: Value = serde_json::from_str(&text).unwrap();
        format!("{status} {}", if status < 300 { &json } else { &json["code"] })
    };
    let answers = [
        "state?path=ROOT",
        "state?path=ROOT/B",
        "state",
        "questions",
        "globals",
        "output",
        "output?bytes=8",
        "output?bytes=-1",
    ];
    let mut lines: Vec<String> =
        answers.iter().map(|what| format!("{what}: {}", get(what))).collect();
    lines.push(get("breakpoints").chars().take(40).collect());
    check(
        &lines,
        &expect![[r#"
        state?path=ROOT: 200 {"inputs":{},"outputs":{},"scoped_variables":{"speed":7}}
        state?path=ROOT/B: 404 "not_active"
        state: 400 "bad_query"
        questions: 200 []
        globals: 200 {"mode":"slow"}
        output: 200 {"bytes":17,"from":0,"text":"past the capture\n"}
        output?bytes=8: 200 {"bytes":17,"from":9,"text":"capture\n"}
        output?bytes=-1: 400 "bad_query"
        200 [{"condition":null,"enabled":true,"h"#]],
    );
}

#[test]
fn what_cannot_begin_is_refused_and_leaves_nothing() {
    let site = Site::new(WAITS);
    std::fs::create_dir(site.place.path("project/empty")).unwrap();
    let refused = |body: Value| said(site.door(), "POST", "/api/v1/runs", Some(&body));
    let machine = |path: &str| json!({ "project": "project", "path": path });
    let answers = [
        refused(json!({ "id": "1", "machine": machine("empty") })),
        refused(json!({ "id": "1", "machine": machine("nothing") })),
        refused(json!({ "id": "1", "machine": machine("../runs") })),
        refused(json!({ "id": "1", "machine": { "project": "x", "path": "machine" } })),
        refused(json!({ "id": "1", "machine": machine("machine"), "keeping": "off" })),
        refused(json!({ "id": "", "machine": machine("machine") })),
        refused(json!({ "id": "1", "machine": machine("machine"), "start_from": "ROOT/X" })),
        refused(json!({ "id": "1", "machine": machine("machine"), "afterwards": "stop" })),
        refused(json!({ "id": "1" })),
        said(site.door(), "GET", "/api/v1/runs/none", None),
    ];
    check(
        &answers,
        &expect![[r"
        422 load_failed
        422 load_failed
        400 bad_path
        404 no_such_project
        400 keeping_off
        400 bad_id
        422 load_failed
        422 load_failed
        400 bad_body
        404 no_such_run"]],
    );
    assert_eq!(std::fs::read_dir(site.place.path("runs")).unwrap().count(), 0);
}

#[test]
fn what_a_server_did_not_get_to_begin_waits_a_day_for_the_same_request() {
    let mut site = Site::new(WAITS);
    site.served = None;
    let request = |id: &str| {
        let folder = site.place.path("runs").join(id);
        std::fs::create_dir_all(&folder).unwrap();
        let start = json!({ "id": id, "machine": { "project": "project", "path": "machine" } });
        let request = json!({ "author": "owner", "boot": "", "start": start });
        std::fs::write(folder.join("request.json"), request.to_string()).unwrap();
        folder.join("request.json")
    };
    request("new");
    let old = std::fs::File::options().write(true).open(request("old")).unwrap();
    old.set_modified(std::time::SystemTime::UNIX_EPOCH).unwrap();
    site.serve();
    let runs = site.door().ask("GET", "/api/v1/runs", None).unwrap();
    let runs = runs.as_array().unwrap();
    assert_eq!((runs.len(), &runs[0]["phase"]), (1, &json!("not_started")));
    assert!(!site.place.path("runs/old").exists());
    let begun = site.start("new", &json!({}));
    assert_eq!((&begun["id"], &begun["phase"]), (&json!("new"), &json!("live")));
}
