//! A session as text: what comes in, and what goes out.

use super::{Session, Todo};
use expect_test::{Expect, expect};
use rafcon_protocol::socket::ToClient;
use rafcon_protocol::{Command, Envelope, Join, ToRunner};
use serde_json::{Value, json};

/// What happens; the time continues by a second with each.
enum Turn {
    /// The run is to be told something.
    Say(Box<ToRunner>),
    /// The server says this.
    Hear(Value),
    /// The connection breaks.
    Cut,
    /// So many seconds pass.
    Wait(u64),
}
use Turn::{Cut, Hear, Say, Wait};

fn check(every_event: bool, turns: Vec<Turn>, expect: &Expect) {
    let mut session = Session::new("RUN".to_owned());
    let (mut now_ms, mut text) = (0, String::new());
    let join = ToRunner::Join(Join { from: 0, every_event });
    let first = [Hear(welcome(0)), Say(Box::new(join))];
    for turn in first.into_iter().chain(turns) {
        let mut todo = Todo::default();
        now_ms += 1000;
        match turn {
            Say(message) => session.said(*message, now_ms, &mut todo),
            Hear(frame) => {
                let frame: ToClient = serde_json::from_value(frame).unwrap();
                session.heard(frame, now_ms, &mut todo);
            }
            Cut => session.cut("no route", &mut todo),
            Wait(seconds) => {
                now_ms += seconds * 1000;
                session.tick(now_ms, &mut todo);
            }
        }
        text += &told(&todo);
        text += "--\n";
    }
    expect.assert_eq(&text);
}

fn told(todo: &Todo) -> String {
    let frames =
        todo.frames.iter().map(|frame| format!("> {}\n", serde_json::to_string(frame).unwrap()));
    let causes = todo.causes.iter().map(|cause| format!("{cause:?}\n"));
    let inspect = todo.inspect.iter().map(|inspect| format!("inspect {inspect:?}\n"));
    frames.chain(causes).chain(inspect).collect()
}

/// The server's clock is ahead by 100 s.
fn welcome(connection: u64) -> Value {
    let session = json!({"user": "ana", "role": "operator", "rights": [], "version": "0.1.0", "expires_ms": null});
    json!({"frame": "welcome", "protocol": 2, "session": session, "connection": connection, "now_ms": 101_000})
}

fn status(phase: &str, link: &str, safe: Option<u64>, events: u64) -> Value {
    let snapshot = safe.map(|safe| {
        json!({"status": "running", "active": [], "states_run": 1, "elapsed_ms": 5000, "disk_safe": safe})
    });
    let mut run = json!({
        "id": "RUN", "name": "Pick", "machine": null, "author": null, "started_ms": 0, "phase": phase,
        "length_ms": 0, "events": events, "bytes": 0, "keeping": "full"
    });
    if phase == "finished" {
        run["outcome"] = json!({"id": 0, "name": "success"});
        run["states_run"] = json!(3);
    }
    let loaded = safe.map(|_| json!({"states": 5, "problems": []}));
    let control =
        json!({"holder": null, "since_ms": 0, "heard_ms": 0, "silence_ms": 0, "requests": []});
    let status = json!({
        "run": run, "loaded": loaded, "link": link, "snapshot": snapshot, "snapshot_ms": 50, "now_ms": 250, "control": control
    });
    json!({"frame": "run_status", "subscription": 1, "status": status})
}

fn paused(sequences: &[u64], next: u64) -> Value {
    let event = |sequence| json!({"sequence": sequence, "t_ns": 0, "event": {"type": "paused", "paused": true}});
    let events: Vec<Value> = sequences.iter().map(event).collect();
    json!({"frame": "events", "subscription": 2, "next": next, "events": events})
}

fn command(id: &str, command: Command) -> Turn {
    Say(Box::new(ToRunner::Command(Envelope::new(id, "ana", command))))
}

fn refused(id: &str, code: &str) -> Turn {
    let refusal = json!({"code": code, "message": "bo holds control of this run"});
    Hear(json!({"frame": "refused", "id": id, "refusal": refusal}))
}

#[test]
fn a_run_is_joined_where_it_stands_and_goes_on_from_its_cursor() {
    check(
        true,
        vec![
            Hear(status("live", "down", None, 9)),
            Hear(status("live", "up", Some(7), 9)),
            Hear(paused(&[8, 9], 10)),
            Cut,
            Cut,
            Hear(welcome(1)),
            Hear(status("live", "up", Some(12), 12)),
            Hear(paused(&[9, 10, 12], 14)),
            Hear(paused(&[], 14)),
        ],
        &expect![[r#"
            Hello(Hello { protocol: 3, program: "0.1.0" })
            --
            > {"frame":"subscribe","subscription":1,"topic":{"topic":"run_status","run":"RUN"}}
            --
            --
            > {"frame":"subscribe","subscription":2,"topic":{"topic":"run_history","run":"RUN","from":8,"values":false}}
            Messages([Loaded { name: "Pick", states: 5, problems: [], run: "RUN" }, Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 7, journal_problem: None, breakpoints: [], questions: [] })])
            --
            Messages([Event { sequence: 8, t_ns: 0, event: Paused { paused: true } }, Event { sequence: 9, t_ns: 0, event: Paused { paused: true } }])
            --
            Cut("no connection to the server (no route); trying again")
            --
            --
            > {"frame":"subscribe","subscription":1,"topic":{"topic":"run_status","run":"RUN"}}
            > {"frame":"subscribe","subscription":2,"topic":{"topic":"run_history","run":"RUN","from":10,"values":false}}
            Mended("the connection is back")
            --
            Messages([Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 12, journal_problem: None, breakpoints: [], questions: [] })])
            --
            Messages([Event { sequence: 10, t_ns: 0, event: Paused { paused: true } }, Event { sequence: 12, t_ns: 0, event: Paused { paused: true } }])
            --
            --
        "#]],
    );
}

#[test]
fn commands_have_an_expiry_and_are_said_again_by_the_same_id() {
    check(
        true,
        vec![
            Hear(status("live", "up", Some(7), 7)),
            command("key-1", Command::Pause),
            command("key-2", Command::Stop),
            Hear(json!({"frame": "answer", "id": "key-2", "answer": "applied"})),
            Cut,
            command("key-3", Command::StepMode),
            Hear(welcome(1)),
            refused("key-1", "not_in_control"),
            refused("key-3", "link_lost"),
            Hear(status("live", "down", Some(7), 7)),
            Hear(status("live", "up", Some(7), 7)),
        ],
        &expect![[r#"
            Hello(Hello { protocol: 3, program: "0.1.0" })
            --
            > {"frame":"subscribe","subscription":1,"topic":{"topic":"run_status","run":"RUN"}}
            --
            > {"frame":"subscribe","subscription":2,"topic":{"topic":"run_history","run":"RUN","from":8,"values":false}}
            Messages([Loaded { name: "Pick", states: 5, problems: [], run: "RUN" }, Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 7, journal_problem: None, breakpoints: [], questions: [] })])
            --
            > {"frame":"command","run":"RUN","envelope":{"id":"key-1","author":"ana","decided_on":7,"expiry":114000,"command":{"type":"pause"}}}
            --
            > {"frame":"command","run":"RUN","envelope":{"id":"key-2","author":"ana","decided_on":7,"expiry":null,"command":{"type":"stop"}}}
            --
            Messages([Answer { id: "key-2", answer: Applied }])
            --
            Cut("no connection to the server (no route); trying again")
            --
            --
            > {"frame":"subscribe","subscription":1,"topic":{"topic":"run_status","run":"RUN"}}
            > {"frame":"subscribe","subscription":2,"topic":{"topic":"run_history","run":"RUN","from":8,"values":false}}
            > {"frame":"command","run":"RUN","envelope":{"id":"key-1","author":"ana","decided_on":7,"expiry":114000,"command":{"type":"pause"}}}
            > {"frame":"command","run":"RUN","envelope":{"id":"key-3","author":"ana","decided_on":7,"expiry":118000,"command":{"type":"step_mode"}}}
            Mended("the connection is back")
            --
            Messages([Answer { id: "key-1", answer: Refused { reason: "bo holds control of this run" } }])
            --
            --
            Messages([Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 7, journal_problem: None, breakpoints: [], questions: [] })])
            --
            > {"frame":"command","run":"RUN","envelope":{"id":"key-3","author":"ana","decided_on":7,"expiry":118000,"command":{"type":"step_mode"}}}
            Messages([Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 7, journal_problem: None, breakpoints: [], questions: [] })])
            --
        "#]],
    );
}

#[test]
fn a_command_without_an_answer_is_said_again_while_it_is_wanted() {
    check(
        true,
        vec![
            Hear(status("live", "up", Some(7), 7)),
            command("key-1", Command::Pause),
            refused("key-1", "no_answer"),
            Wait(1),
            refused("key-1", "no_answer"),
            Wait(9),
            refused("key-1", "no_answer"),
            Wait(2),
        ],
        &expect![[r#"
            Hello(Hello { protocol: 3, program: "0.1.0" })
            --
            > {"frame":"subscribe","subscription":1,"topic":{"topic":"run_status","run":"RUN"}}
            --
            > {"frame":"subscribe","subscription":2,"topic":{"topic":"run_history","run":"RUN","from":8,"values":false}}
            Messages([Loaded { name: "Pick", states: 5, problems: [], run: "RUN" }, Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 7, journal_problem: None, breakpoints: [], questions: [] })])
            --
            > {"frame":"command","run":"RUN","envelope":{"id":"key-1","author":"ana","decided_on":7,"expiry":114000,"command":{"type":"pause"}}}
            --
            --
            > {"frame":"command","run":"RUN","envelope":{"id":"key-1","author":"ana","decided_on":7,"expiry":114000,"command":{"type":"pause"}}}
            --
            --
            > {"frame":"command","run":"RUN","envelope":{"id":"key-1","author":"ana","decided_on":7,"expiry":114000,"command":{"type":"pause"}}}
            --
            Messages([Answer { id: "key-1", answer: Unknown { reason: "bo holds control of this run" } }])
            --
            --
        "#]],
    );
}

#[test]
fn only_what_is_rare_is_shown_in_a_picture() {
    let event = |sequence, event: Value| json!({"sequence": sequence, "t_ns": 0, "event": event});
    let events = vec![
        event(1, json!({"type": "entered", "path": "A"})),
        event(2, json!({"type": "stopping"})),
        event(3, json!({"type": "left", "path": "A", "outcome": {"id": 0, "name": "success"}})),
    ];
    check(
        false,
        vec![
            Hear(status("live", "up", Some(0), 0)),
            Hear(json!({"frame": "events", "subscription": 2, "next": 4, "events": events})),
        ],
        &expect![[r#"
            Hello(Hello { protocol: 3, program: "0.1.0" })
            --
            > {"frame":"subscribe","subscription":1,"topic":{"topic":"run_status","run":"RUN"}}
            --
            > {"frame":"subscribe","subscription":2,"topic":{"topic":"run_history","run":"RUN","from":1,"values":false}}
            Messages([Loaded { name: "Pick", states: 5, problems: [], run: "RUN" }, Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 0, journal_problem: None, breakpoints: [], questions: [] })])
            --
            Messages([Event { sequence: 2, t_ns: 0, event: Stopping }])
            --
        "#]],
    );
}

#[test]
fn a_run_that_no_one_resumes_is_lost_once_all_was_told() {
    check(
        true,
        vec![
            Hear(status("live", "up", Some(1), 1)),
            Hear(status("crashed", "over", None, 3)),
            Hear(status("starting", "down", None, 3)),
            Wait(10),
            Hear(status("crashed", "over", None, 3)),
            Wait(10),
            Hear(paused(&[2, 3], 4)),
            Wait(1),
            Wait(1),
        ],
        &expect![[r#"
            Hello(Hello { protocol: 3, program: "0.1.0" })
            --
            > {"frame":"subscribe","subscription":1,"topic":{"topic":"run_status","run":"RUN"}}
            --
            > {"frame":"subscribe","subscription":2,"topic":{"topic":"run_history","run":"RUN","from":2,"values":false}}
            Messages([Loaded { name: "Pick", states: 5, problems: [], run: "RUN" }, Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 1, journal_problem: None, breakpoints: [], questions: [] })])
            --
            --
            --
            --
            --
            --
            Messages([Event { sequence: 2, t_ns: 0, event: Paused { paused: true } }, Event { sequence: 3, t_ns: 0, event: Paused { paused: true } }])
            --
            Silence
            --
            --
        "#]],
    );
}

#[test]
fn of_a_run_that_is_over_the_end_is_told() {
    let finished = json!({
        "type": "finished", "outcome": {"id": 0, "name": "success"}, "outputs": {}, "globals": {},
        "scoped_variables": {}, "states_run": 3
    });
    let entry = json!({"sequence": 20, "t_ns": 0, "event": finished});
    check(
        true,
        vec![
            Hear(status("finished", "over", None, 20)),
            Hear(json!({"frame": "events", "subscription": 2, "next": 21, "events": [entry]})),
            Hear(json!({"frame": "ended", "subscription": 2, "refusal": null})),
        ],
        &expect![[r#"
            Hello(Hello { protocol: 3, program: "0.1.0" })
            --
            > {"frame":"subscribe","subscription":1,"topic":{"topic":"run_status","run":"RUN"}}
            --
            > {"frame":"subscribe","subscription":2,"topic":{"topic":"run_history","run":"RUN","from":20,"values":false}}
            Messages([Loaded { name: "Pick", states: 0, problems: [], run: "RUN" }])
            --
            Messages([Event { sequence: 20, t_ns: 0, event: Finished { outcome: Outcome { id: 0, name: "success" }, outputs: {}, globals: {}, scoped_variables: {}, states_run: 3 } }])
            --
            --
        "#]],
    );
}

#[test]
fn a_server_of_another_version_is_not_spoken_with() {
    let mut frame = welcome(1);
    frame["protocol"] = json!(9);
    check(
        true,
        vec![Hear(frame)],
        &expect![[r#"
            Hello(Hello { protocol: 3, program: "0.1.0" })
            --
            > {"frame":"subscribe","subscription":1,"topic":{"topic":"run_status","run":"RUN"}}
            --
            Refused("the server (version 0.1.0) speaks version 9 of the socket's frames, this program 2: install the same version of rafcon on both computers")
            --
        "#]],
    );
}

#[test]
fn what_the_server_does_not_want_ends_the_visit() {
    let refusal = json!({"code": "no_such_run", "message": "there is no run RUN"});
    check(
        true,
        vec![
            Say(Box::new(ToRunner::Inspect { id: "1".to_owned(), path: "A".to_owned() })),
            Hear(json!({"frame": "ended", "subscription": 1, "refusal": refusal})),
        ],
        &expect![[r#"
            Hello(Hello { protocol: 3, program: "0.1.0" })
            --
            > {"frame":"subscribe","subscription":1,"topic":{"topic":"run_status","run":"RUN"}}
            --
            inspect ("1", "A")
            --
            Refused("there is no run RUN")
            --
        "#]],
    );
}

#[test]
fn a_runner_that_does_not_answer_is_told_once_and_so_is_that_it_does_again() {
    check(
        false,
        vec![
            Hear(status("live", "silent", Some(7), 9)),
            Hear(status("live", "silent", Some(7), 9)),
            command("1", Command::Pause),
            Hear(status("live", "up", Some(7), 9)),
            Hear(status("live", "silent", Some(7), 9)),
            Cut,
            Hear(welcome(1)),
            Hear(status("live", "silent", Some(7), 9)),
        ],
        &expect![[r#"
            Hello(Hello { protocol: 3, program: "0.1.0" })
            --
            > {"frame":"subscribe","subscription":1,"topic":{"topic":"run_status","run":"RUN"}}
            --
            > {"frame":"subscribe","subscription":2,"topic":{"topic":"run_history","run":"RUN","from":8,"values":false}}
            Messages([Loaded { name: "Pick", states: 5, problems: [], run: "RUN" }, Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 7, journal_problem: None, breakpoints: [], questions: [] })])
            Cut("the run does not answer; trying again")
            --
            Messages([Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 7, journal_problem: None, breakpoints: [], questions: [] })])
            --
            > {"frame":"command","run":"RUN","envelope":{"id":"1","author":"ana","decided_on":7,"expiry":115000,"command":{"type":"pause"}}}
            --
            Messages([Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 7, journal_problem: None, breakpoints: [], questions: [] })])
            Mended("the run answers again")
            --
            Messages([Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 7, journal_problem: None, breakpoints: [], questions: [] })])
            Cut("the run does not answer; trying again")
            --
            Cut("no connection to the server (no route); trying again")
            --
            > {"frame":"subscribe","subscription":1,"topic":{"topic":"run_status","run":"RUN"}}
            > {"frame":"subscribe","subscription":2,"topic":{"topic":"run_history","run":"RUN","from":8,"values":false}}
            > {"frame":"command","run":"RUN","envelope":{"id":"1","author":"ana","decided_on":7,"expiry":115000,"command":{"type":"pause"}}}
            Mended("the connection is back")
            --
            Messages([Snapshot(Snapshot { status: Running, active: [], states_run: 1, elapsed_ms: 5200, sequence: 0, disk_safe: 7, journal_problem: None, breakpoints: [], questions: [] })])
            Cut("the run does not answer; trying again")
            --
        "#]],
    );
}
