//! The commands that read what runs have kept. Most journals are written here, from text; one is that of a real run.

use crate::harness::{Place, assert_extension};
use expect_test::{Expect, expect};
use rafcon_storage::journal::{About, Journal, Options};
use rafcon_testkit::journal_notation;
use std::fs;
use std::path::Path;

const MACHINE: &str = r#"
    place R "Mission" in speed scoped n outcome done,lost
    place R/A "Mission/Scan" script in where out rooms outcome ok,dark
    place R/B "Mission/Both" outcome ok
    place R/B/X "Mission/Both/Left" script out x outcome ok
    place R/B/Y "Mission/Both/Right" script outcome ok
"#;

pub(crate) const RUN: &str = r#"
    @0 told {"type": "root", "hash": "0123456789abcdef", "change": ""}
    @0 enter R speed=1.5
    @0.1 scoped R n=0
    @1 enter R/A where="kitchen"
    @2 log R/A info "scanning\nthe kitchen"
    @3 global map={"rooms": [1, 2]}
    @1003 leave R/A ok rooms=[1, 2]
    @1003.1 scoped R n=2
    @1004 enter R/B
    @1004.5 enter R/B/X
    @1005 enter R/B/Y
    @1006 log R/B/Y warning "too close"
    @2500 leave R/B/X ok x=7
    @2600 leave R/B/Y aborted error="no wheels"
    @2600 told {"type": "waiting", "path": "R/B", "reason": "no transition begins at the outcome"}
"#;

pub(crate) const END: &str = r#"
    @3000 told {"type": "commanded", "answer": {"answer": "applied"}, "envelope": {"id": "1", "author": "ann", "command": {"type": "stop"}}}
    @3000 told {"type": "stopping"}
    @3001 leave R/B preempted
    @3001 leave R preempted
    @3001 told {"type": "finished", "outcome": {"id": -2, "name": "preempted"}, "outputs": {}, "globals": {}, "scoped_variables": {}, "states_run": 5}
"#;

/// Writes the journal of a run that came to its end, or of one whose runner died.
pub(crate) fn keep(place: &Place, id: &str, text: &str, died: bool) {
    let folder = place.path("runs").join(id);
    let about = About {
        id: id.to_owned(),
        name: "Mission".to_owned(),
        started_ms: 1_795_290_001_000,
        ..About::default()
    };
    let options = Options { recorder_bytes: 1 << 16, ..Options::default() };
    let journal = Journal::create(&folder, &about, &options).unwrap();
    journal.append(&journal_notation::batch(&format!("{MACHINE}{text}"), 0).unwrap()).unwrap();
    if died {
        drop(journal);
    } else {
        journal.close().unwrap();
    }
}

/// A place with a finished run and the same run as it was when its runner died in the middle.
fn place() -> Place {
    let place = Place::empty();
    keep(&place, "20261121-194001-mission-0001", &format!("{RUN}{END}"), false);
    keep(&place, "20261121-194002-mission-0002", RUN, true);
    place
}

fn check(words: &str, expect: &Expect) {
    let answer = place().call(&format!("{words} --runs runs"));
    let code = answer.code.unwrap();
    // A row of CSV ends with both; the compiler would take one of them out of the expectation.
    let stdout = answer.stdout.replace("\r\n", "\n");
    expect.assert_eq(&format!("{code}\n{stdout}{}", answer.stderr));
}

#[test]
fn runs_are_listed_with_what_became_of_them() {
    let place = place();
    let listed = |more: &str| cut_size(&place.call(&format!("runs {more} --runs runs")).stdout);
    expect![[r"
        20261121-194001-mission-0001  Mission  ended with preempted after 3.0 s, 20 events, SIZE
        20261121-194002-mission-0002  Mission  crashed after 2.6 s, 15 events, SIZE
    "]]
    .assert_eq(&listed(""));
    expect![[r#"
        {"id":"20261121-194001-mission-0001","name":"Mission","started_ms":1795290001000,"state":"finished","outcome":{"id":-2,"name":"preempted"},"states_run":5,"length_ms":3001,"events":20, SIZE
        {"id":"20261121-194002-mission-0002","name":"Mission","started_ms":1795290001000,"state":"crashed","length_ms":2600,"events":15, SIZE
    "#]].assert_eq(&listed("--json"));
}

#[test]
fn a_history_reads_line_by_line() {
    check(
        "history 20261121-194001",
        &expect![[r#"
            0
                  1     0.000  the machine is 0123456789ab
                  2     0.000  Mission  entered
                  3     0.000  Mission  n = 0
                  4     0.001  Mission/Scan  entered
                  5     0.002  Mission/Scan  scanning
                               the kitchen
                  6     0.003  global map = {"rooms": [1, 2]}
                  7     1.003  Mission/Scan  ended with ok after 1.0 s
                  8     1.003  Mission  n = 2
                  9     1.004  Mission/Both  entered
                 10     1.004  Mission/Both/Left  entered
                 11     1.005  Mission/Both/Right  entered
                 12     1.006  Mission/Both/Right  too close
                 13     2.500  Mission/Both/Left  ended with ok after 1.5 s
                 14     2.600  Mission/Both/Right  ended with aborted after 1.6 s, "no wheels"
                 15     2.600  Mission/Both  waiting: no transition begins at the outcome
                 16     3.000  ann gave the command stop
                 17     3.000  stopping
                 18     3.001  Mission/Both  ended with preempted after 2.0 s
                 19     3.001  Mission  ended with preempted after 3.0 s
                 20     3.001  the run ended with preempted
        "#]],
    );
}

#[test]
fn a_history_is_filtered() {
    check(
        "history last --state scan --values",
        &expect![[r#"
            0
                  4     0.001  Mission/Scan  entered: where = "kitchen"
                  5     0.002  Mission/Scan  scanning
                               the kitchen
                  7     1.003  Mission/Scan  ended with ok after 1.0 s: rooms = [1, 2]
        "#]],
    );
    check(
        "history last --outcome aborted --values",
        &expect![[r#"
            0
                 14     2.600  Mission/Both/Right  ended with aborted after 1.6 s, "no wheels"
        "#]],
    );
    check(
        "history last --text KITCHEN --kind log",
        &expect![[r"
            0
                  5     0.002  Mission/Scan  scanning
                               the kitchen
        "]],
    );
    check(
        "history last --from 1.003 --to 1.0045",
        &expect![[r"
            0
                  7     1.003  Mission/Scan  ended with ok after 1.0 s
                  8     1.003  Mission  n = 2
                  9     1.004  Mission/Both  entered
                 10     1.004  Mission/Both/Left  entered
        "]],
    );
    check(
        "history last --last 2 --json",
        &expect![[r#"
            0
            {"sequence":14,"t_ns":2600000000,"event":{"type":"left","path":"R/B/Y","outcome":{"id":-1,"name":"aborted"},"error":"no wheels"}}
            {"sequence":15,"t_ns":2600000000,"event":{"type":"waiting","path":"R/B","reason":"no transition begins at the outcome"}}
        "#]],
    );
}

#[test]
fn the_log_is_filtered_by_level_and_state() {
    check(
        "log last",
        &expect![[r"
        0
           0.002  Mission/Scan  scanning
                  the kitchen
           1.006  Mission/Both/Right  too close
    "]],
    );
    check(
        "log last --level warning",
        &expect![[r"
        0
           1.006  Mission/Both/Right  too close
    "]],
    );
    check(
        "log last --state *scan --json",
        &expect![[r#"
            0
            {"sequence":5,"t_ns":2000000,"event":{"type":"log","path":"R/A","level":"info","stream":"logger","message":"scanning\nthe kitchen"}}
        "#]],
    );
}

#[test]
fn a_run_is_replayed_at_any_event() {
    check(
        "replay last",
        &expect![[r#"
            0
            Mission at event 15 of 15, 2.6 s after the start, 5 states run; running
            Mission  for 2.6 s (event 2)
              input speed = 1.5
              scoped n = 2
              Scan ended with ok (event 7): rooms = [1, 2]
              Both  for 1.6 s (event 9)  waits: no transition begins at the outcome
                Left ended with ok (event 13): x = 7
                Right ended with aborted (event 14), "no wheels"
            global map = {"rooms": [1, 2]}
        "#]],
    );
    check(
        "replay 20261121-194001 --at 7",
        &expect![[r#"
            0
            Mission at event 7 of 20, 1.0 s after the start, 2 states run; running
            Mission  for 1.0 s (event 2)
              input speed = 1.5
              scoped n = 0
              Scan ended with ok (event 7): rooms = [1, 2]
            global map = {"rooms": [1, 2]}
        "#]],
    );
    check(
        "replay 20261121-194001 --time 1.0045",
        &expect![[r#"
            0
            Mission at event 10 of 20, 1.0 s after the start, 4 states run; running
            Mission  for 1.0 s (event 2)
              input speed = 1.5
              scoped n = 2
              Scan ended with ok (event 7): rooms = [1, 2]
              Both  for 0.5 ms (event 9)
                Left  for 0.0 ms (event 10)
            global map = {"rooms": [1, 2]}
        "#]],
    );
    check(
        "replay 20261121-194001 --at 21",
        &expect![[r"
            2
            error: event 21 does not exist yet; the last event is 20

            For more information, try '--help'.
        "]],
    );
    check(
        "replay last --at 4 --json",
        &expect![[r#"
        0
        {"sequence":4,"t_ns":1000000,"status":"running","outcome":null,"root":"0123456789abcdef","life":1,"states_run":2,"active":[{"path":"R","names":"Mission","depth":0,"entered":2,"since_ns":0,"inputs":{"speed":1.5},"scoped":{"n":0},"ended":[]},{"path":"R/A","names":"Mission/Scan","depth":1,"entered":4,"since_ns":1000000,"inputs":{"where":"kitchen"},"scoped":{},"ended":[]}],"held":[],"waiting":{},"globals":{},"persistent":{},"breakpoints":[],"questions":[]}
    "#]],
    );
}

#[test]
fn two_runs_are_compared() {
    check(
        "compare 20261121-194001 last",
        &expect![[r"
            1
            A is 20261121-194001-mission-0001, B is 20261121-194002-mission-0002
            the runs diverge on 1 branch; 8 steps alike before
              A  Mission/Both ended with preempted (event 18, after 3.0 s)
              B  was over
            time in states, largest difference first
              Mission             1x 3.001 s          0x 0.000 s
              Mission/Both        1x 1.997 s          0x 0.000 s
        "]],
    );
}

#[test]
fn a_run_is_exported_for_programs_and_spreadsheets() {
    check(
        "export last --format csv",
        &expect![[r#"
            0
            sequence,time_s,utc,kind,path,names,outcome,duration_s,level,text,values
            1,0.000000,2026-11-21T19:40:01.000Z,root,,,,,,,
            2,0.000000,2026-11-21T19:40:01.000Z,entered,R,Mission,,,,,"{""speed"":1.5}"
            3,0.000100,2026-11-21T19:40:01.000Z,scoped,R,Mission,,,,,"{""n"":0}"
            4,0.001000,2026-11-21T19:40:01.001Z,entered,R/A,Mission/Scan,,,,,"{""where"":""kitchen""}"
            5,0.002000,2026-11-21T19:40:01.002Z,log,R/A,Mission/Scan,,,info,"scanning
            the kitchen",
            6,0.003000,2026-11-21T19:40:01.003Z,global,,,,,,,"{""map"":{""rooms"":[1,2]}}"
            7,1.003000,2026-11-21T19:40:02.003Z,left,R/A,Mission/Scan,ok,1.002000,,,"{""rooms"":[1,2]}"
            8,1.003100,2026-11-21T19:40:02.003Z,scoped,R,Mission,,,,,"{""n"":2}"
            9,1.004000,2026-11-21T19:40:02.004Z,entered,R/B,Mission/Both,,,,,
            10,1.004500,2026-11-21T19:40:02.004Z,entered,R/B/X,Mission/Both/Left,,,,,
            11,1.005000,2026-11-21T19:40:02.005Z,entered,R/B/Y,Mission/Both/Right,,,,,
            12,1.006000,2026-11-21T19:40:02.006Z,log,R/B/Y,Mission/Both/Right,,,warning,too close,
            13,2.500000,2026-11-21T19:40:03.500Z,left,R/B/X,Mission/Both/Left,ok,1.495500,,,"{""x"":7}"
            14,2.600000,2026-11-21T19:40:03.600Z,left,R/B/Y,Mission/Both/Right,aborted,1.595000,,,"{""error"":""no wheels""}"
            15,2.600000,2026-11-21T19:40:03.600Z,waiting,R/B,Mission/Both,,,,no transition begins at the outcome,
        "#]],
    );
    check(
        "export 20261121-194001 --format jsonl",
        &expect![[r#"
            0
            {"sequence":1,"t_ns":0,"utc":"2026-11-21T19:40:01.000Z","names":"","event":{"type":"root","hash":"0123456789abcdef","change":""}}
            {"sequence":2,"t_ns":0,"utc":"2026-11-21T19:40:01.000Z","names":"Mission","event":{"type":"entered","path":"R","inputs":{"speed":1.5}}}
            {"sequence":3,"t_ns":100000,"utc":"2026-11-21T19:40:01.000Z","names":"Mission","event":{"type":"scoped","path":"R","name":"n","value":0}}
            {"sequence":4,"t_ns":1000000,"utc":"2026-11-21T19:40:01.001Z","names":"Mission/Scan","event":{"type":"entered","path":"R/A","inputs":{"where":"kitchen"}}}
            {"sequence":5,"t_ns":2000000,"utc":"2026-11-21T19:40:01.002Z","names":"Mission/Scan","event":{"type":"log","path":"R/A","level":"info","stream":"logger","message":"scanning\nthe kitchen"}}
            {"sequence":6,"t_ns":3000000,"utc":"2026-11-21T19:40:01.003Z","names":"","event":{"type":"global","name":"map","value":{"rooms":[1,2]}}}
            {"sequence":7,"t_ns":1003000000,"utc":"2026-11-21T19:40:02.003Z","names":"Mission/Scan","lasted_ns":1002000000,"event":{"type":"left","path":"R/A","outcome":{"id":0,"name":"ok"},"outputs":{"rooms":[1,2]}}}
            {"sequence":8,"t_ns":1003100000,"utc":"2026-11-21T19:40:02.003Z","names":"Mission","event":{"type":"scoped","path":"R","name":"n","value":2}}
            {"sequence":9,"t_ns":1004000000,"utc":"2026-11-21T19:40:02.004Z","names":"Mission/Both","event":{"type":"entered","path":"R/B","inputs":{}}}
            {"sequence":10,"t_ns":1004500000,"utc":"2026-11-21T19:40:02.004Z","names":"Mission/Both/Left","event":{"type":"entered","path":"R/B/X","inputs":{}}}
            {"sequence":11,"t_ns":1005000000,"utc":"2026-11-21T19:40:02.005Z","names":"Mission/Both/Right","event":{"type":"entered","path":"R/B/Y","inputs":{}}}
            {"sequence":12,"t_ns":1006000000,"utc":"2026-11-21T19:40:02.006Z","names":"Mission/Both/Right","event":{"type":"log","path":"R/B/Y","level":"warning","stream":"logger","message":"too close"}}
            {"sequence":13,"t_ns":2500000000,"utc":"2026-11-21T19:40:03.500Z","names":"Mission/Both/Left","lasted_ns":1495500000,"event":{"type":"left","path":"R/B/X","outcome":{"id":0,"name":"ok"},"outputs":{"x":7}}}
            {"sequence":14,"t_ns":2600000000,"utc":"2026-11-21T19:40:03.600Z","names":"Mission/Both/Right","lasted_ns":1595000000,"event":{"type":"left","path":"R/B/Y","outcome":{"id":-1,"name":"aborted"},"outputs":{},"error":"no wheels"}}
            {"sequence":15,"t_ns":2600000000,"utc":"2026-11-21T19:40:03.600Z","names":"Mission/Both","event":{"type":"waiting","path":"R/B","reason":"no transition begins at the outcome"}}
            {"sequence":16,"t_ns":3000000000,"utc":"2026-11-21T19:40:04.000Z","names":"","event":{"type":"commanded","envelope":{"id":"1","author":"ann","decided_on":null,"expiry":null,"command":{"type":"stop"}},"answer":{"answer":"applied"}}}
            {"sequence":17,"t_ns":3000000000,"utc":"2026-11-21T19:40:04.000Z","names":"","event":{"type":"stopping"}}
            {"sequence":18,"t_ns":3001000000,"utc":"2026-11-21T19:40:04.001Z","names":"Mission/Both","lasted_ns":1997000000,"event":{"type":"left","path":"R/B","outcome":{"id":-2,"name":"preempted"},"outputs":{}}}
            {"sequence":19,"t_ns":3001000000,"utc":"2026-11-21T19:40:04.001Z","names":"Mission","lasted_ns":3001000000,"event":{"type":"left","path":"R","outcome":{"id":-2,"name":"preempted"},"outputs":{}}}
            {"sequence":20,"t_ns":3001000000,"utc":"2026-11-21T19:40:04.001Z","names":"","event":{"type":"finished","outcome":{"id":-2,"name":"preempted"},"outputs":{},"globals":{},"scoped_variables":{},"states_run":5}}
        "#]],
    );
}

#[test]
fn a_run_is_exported_as_a_recording() {
    let place = place();
    let answer = place.call("export last --format mcap --output run.mcap --runs runs");
    assert_eq!((answer.code, &*answer.stderr), (Some(0), ""));
    let bytes = fs::read(place.path("run.mcap")).unwrap();
    let line = |message: Result<mcap::Message<'_>, _>| {
        let message = message.unwrap();
        let schema = message.channel.schema.clone().unwrap();
        let text = String::from_utf8_lossy(&message.data).into_owned();
        (message.channel.topic.clone(), format!("{} {} {text}\n", message.log_time, schema.name))
    };
    let messages: Vec<_> = mcap::MessageStream::new(&bytes).unwrap().map(line).collect();
    let on = |topic: &str| -> String {
        messages.iter().filter(|(t, _)| t == topic).map(|(_, line)| line.as_str()).collect()
    };
    expect![[r#"
        1795290001002000000 foxglove.Log {"file":"","level":2,"line":0,"message":"scanning\nthe kitchen","name":"Mission/Scan","timestamp":{"nsec":2000000,"sec":1795290001}}
        1795290002006000000 foxglove.Log {"file":"","level":3,"line":0,"message":"too close","name":"Mission/Both/Right","timestamp":{"nsec":6000000,"sec":1795290002}}
    "#]].assert_eq(&on("/log"));
    expect![[r#"
        1795290001000000000 rafcon.States {"active":["Mission"],"kind":"entered","outcome":"","path":"R","state":"Mission","timestamp":{"nsec":0,"sec":1795290001}}
        1795290001001000000 rafcon.States {"active":["Mission/Scan"],"kind":"entered","outcome":"","path":"R/A","state":"Mission/Scan","timestamp":{"nsec":1000000,"sec":1795290001}}
        1795290002003000000 rafcon.States {"active":["Mission"],"kind":"left","outcome":"ok","path":"R/A","state":"Mission/Scan","timestamp":{"nsec":3000000,"sec":1795290002}}
        1795290002004000000 rafcon.States {"active":["Mission/Both"],"kind":"entered","outcome":"","path":"R/B","state":"Mission/Both","timestamp":{"nsec":4000000,"sec":1795290002}}
        1795290002004500000 rafcon.States {"active":["Mission/Both/Left"],"kind":"entered","outcome":"","path":"R/B/X","state":"Mission/Both/Left","timestamp":{"nsec":4500000,"sec":1795290002}}
        1795290002005000000 rafcon.States {"active":["Mission/Both/Left","Mission/Both/Right"],"kind":"entered","outcome":"","path":"R/B/Y","state":"Mission/Both/Right","timestamp":{"nsec":5000000,"sec":1795290002}}
        1795290003500000000 rafcon.States {"active":["Mission/Both/Right"],"kind":"left","outcome":"ok","path":"R/B/X","state":"Mission/Both/Left","timestamp":{"nsec":500000000,"sec":1795290003}}
        1795290003600000000 rafcon.States {"active":["Mission/Both"],"kind":"left","outcome":"aborted","path":"R/B/Y","state":"Mission/Both/Right","timestamp":{"nsec":600000000,"sec":1795290003}}
    "#]].assert_eq(&on("/states"));
    expect![[r#"
        1795290001000000000 rafcon.Value {"kind":"input","name":"speed","number":1.5,"state":"Mission","timestamp":{"nsec":0,"sec":1795290001},"value":1.5}
        1795290001000100000 rafcon.Value {"kind":"scoped","name":"n","number":0.0,"state":"Mission","timestamp":{"nsec":100000,"sec":1795290001},"value":0}
        1795290001001000000 rafcon.Value {"kind":"input","name":"where","state":"Mission/Scan","timestamp":{"nsec":1000000,"sec":1795290001},"value":"kitchen"}
        1795290001003000000 rafcon.Value {"kind":"global","name":"map","state":"","timestamp":{"nsec":3000000,"sec":1795290001},"value":{"rooms":[1,2]}}
        1795290002003000000 rafcon.Value {"kind":"output","name":"rooms","state":"Mission/Scan","timestamp":{"nsec":3000000,"sec":1795290002},"value":[1,2]}
        1795290002003100000 rafcon.Value {"kind":"scoped","name":"n","number":2.0,"state":"Mission","timestamp":{"nsec":3100000,"sec":1795290002},"value":2}
        1795290003500000000 rafcon.Value {"kind":"output","name":"x","number":7.0,"state":"Mission/Both/Left","timestamp":{"nsec":500000000,"sec":1795290003},"value":7}
        1795290003600000000 rafcon.Value {"kind":"output","name":"error","state":"Mission/Both/Right","timestamp":{"nsec":600000000,"sec":1795290003},"value":"no wheels"}
    "#]].assert_eq(&on("/values"));
    assert_eq!(on("/events").lines().count(), 15);
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    assert_eq!(summary.stats.unwrap().message_count, messages.len() as u64);
}

#[test]
fn what_cannot_be_is_refused_with_the_way_out() {
    check(
        "history 2025",
        &expect![[r"
        2
        error: there is no run `2025` in PLACE/runs: `rafcon runs` lists the runs

        For more information, try '--help'.
    "]],
    );
    check(
        "replay last --at 99",
        &expect![[r"
            2
            error: event 99 does not exist yet; the last event is 15

            For more information, try '--help'.
        "]],
    );
    check(
        "runs --keep 5",
        &expect![[r"
        2
        error: the following required arguments were not provided:
          --prune

        Usage: rafcon runs --prune --keep <NUMBER> --runs <DIR>

        For more information, try '--help'.
    "]],
    );
    check(
        "export last --format csv --output nowhere/at/all.csv",
        &expect![[r"
            2
            error: the folder nowhere/at does not exist: create it, or name another file

            For more information, try '--help'.
        "]],
    );
}

#[test]
fn a_run_that_never_began_leaves_nothing() {
    let place = Place::empty();
    assert_eq!(place.call("run nowhere --runs runs").code, Some(1));
    let left = fs::read_dir(place.path("runs")).into_iter().flatten().count();
    assert_eq!(left, 0);
}

#[test]
fn a_real_run_can_be_read() {
    let place = Place::with_script(
        "def execute(self, inputs, outputs, gvm):\n    print('hello')\n    return 'failure'",
    );
    assert_eq!(place.run("--runs runs").code, Some(3));
    let answer = place.call("history last --runs runs --kind entered --kind left --kind finished");
    let without_times =
        |line: &str| line[19..].split(" after ").next().unwrap_or_default().to_owned() + "\n";
    let told: String = answer.stdout.lines().map(without_times).collect();
    expect![[r"
        Lonely  entered
        Lonely  ended with failure
        the run ended with failure
    "]]
    .assert_eq(&told);
    let log = place.call("log last --runs runs").stdout;
    assert!(log.ends_with("Lonely  hello\n"), "{log}");
    let replayed = place.call("replay last --runs runs").stdout;
    assert!(replayed.ends_with("1 state run; ended with failure (1)\n"), "{replayed}");
    let alike = place.call("compare last last --runs runs").stdout;
    assert!(alike.contains("the runs are equal: 2 steps alike"), "{alike}");
}

#[test]
fn old_runs_go_but_not_the_newest() {
    let place = Place::empty();
    for number in 1..=13 {
        keep(&place, &format!("20261121-1940{number:02}-mission-0000"), RUN, false);
    }
    let answer = place.call("runs --prune --keep 11 --runs runs");
    expect![[r"
        deleted 20261121-194001-mission-0000
        deleted 20261121-194002-mission-0000
        2 runs deleted, SIZE
    "]]
    .assert_eq(&cut_size(&answer.stdout));
    let answer = place.call("runs --prune --max-size 1K --runs runs");
    expect![[r"
        deleted 20261121-194003-mission-0000
        1 run deleted, SIZE
    "]]
    .assert_eq(&cut_size(&answer.stdout));
    assert_eq!(place.call("runs --runs runs").stdout.lines().count(), 10);
}

/// Sizes differ between versions of the database.
fn cut_size(text: &str) -> String {
    let cut = |line: &str| match line.rsplit_once([',']) {
        Some((rest, last)) if !last.contains("event") => format!("{rest}, SIZE\n"),
        _ => format!("{line}\n"),
    };
    text.lines().map(cut).collect()
}

/// What a plugin sets before the run begins is set in the run.
#[test]
fn global_variables_of_plugins_stand_in_the_journal() {
    assert_extension();
    let script = r#"
def execute(self, inputs, outputs, gvm):
    gvm.set_variable("own", gvm.get_variable("from_plugin")[1])
    return 0
"#;
    let place = Place::with_script(script);
    let plugin = place.path("plugin");
    fs::create_dir(&plugin).unwrap();
    fs::write(plugin.join("__init__.py"), "").unwrap();
    let hooks = r#"
from rafcon.core.singleton import global_variable_manager
def post_init(*arguments):
    global_variable_manager.set_variable("from_plugin", [1, 2])
"#;
    fs::write(plugin.join("hooks.py"), hooks).unwrap();
    let mut run = place.command("run MACHINE --runs runs");
    let answer = place.answer(&run.env("RAFCON_PLUGIN_PATH", &plugin).output().unwrap());
    assert_eq!(answer.code, Some(0), "{answer:?}");
    let history = place.call("history last --runs runs --kind global").stdout;
    let told: Vec<&str> =
        history.lines().filter_map(|line| line.split_once("global ")).map(|it| it.1).collect();
    assert_eq!(told, ["from_plugin = [1, 2]", "own = 2"]);
    let replay = place.call("replay last --runs runs --json").stdout;
    let picture: serde_json::Value = serde_json::from_str(&replay).unwrap();
    assert_eq!(picture["globals"], serde_json::json!({ "from_plugin": [1, 2], "own": 2 }));
}

/// Copies a run of an earlier version into the folder `runs` of a place.
fn keep_old(place: &Place, name: &str) {
    let old = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/runs").join(name);
    let folder = place.path("runs").join(name);
    fs::create_dir_all(&folder).unwrap();
    for entry in fs::read_dir(old).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
    }
}

#[test]
fn runs_of_an_earlier_version_are_read_and_resumed() {
    let place = Place::empty();
    keep_old(&place, "finished");
    keep_old(&place, "crashed");
    let said = |words: &str, expected: &str| {
        let answer = place.call(&format!("{words} --runs runs"));
        assert!(answer.code == Some(0) && answer.stdout.contains(expected), "{words}: {answer:?}");
    };
    said("history finished --values", "the run ended with success");
    said("replay finished", "\"kitchen\"");
    said("history crashed", "scanning");
    said("replay crashed", "\"kitchen\"");
    let resumed = Journal::resume(&place.path("runs/crashed"), &Options::default());
    let (journal, resume_point) = resumed.unwrap();
    assert_eq!((resume_point.life, resume_point.lost), (2, None));
    journal.close().unwrap();
    said("history crashed", "scanning");
    said("replay crashed", "\"kitchen\"");
}

/// Changes a byte in the middle of the first `text` of a file; says where that was.
fn spoil(path: &Path, text: &str) {
    let mut bytes = fs::read(path).unwrap();
    let at = bytes.windows(text.len()).position(|part| part == text.as_bytes()).unwrap();
    bytes[at + text.len() / 2] ^= 0x20;
    fs::write(path, bytes).unwrap();
}

/// Whether a command of a damaged run says so, and ends by an error.
fn check_damaged(place: &Place, words: &str, said: &str) {
    let answer = place.call(&format!("{words} --runs runs"));
    let all = format!("{}{}", answer.stdout, answer.stderr);
    assert!(answer.code == Some(1) && all.contains(said), "{words}: {answer:?}");
}

#[test]
fn a_damaged_value_is_named_by_whoever_reads_it() {
    let place = place();
    let id = "20261121-194001-mission-0001";
    spoil(&place.path("runs").join(id).join("journal.db"), "\"rooms\"");
    check_damaged(&place, &format!("history {id}"), "<damaged: value");
    check_damaged(&place, &format!("replay {id}"), "<damaged: value");
    check_damaged(&place, &format!("export {id} --format csv"), "<damaged: value");
}

#[test]
fn damaged_events_are_named_by_whoever_reads_them() {
    let place = place();
    let id = "20261121-194001-mission-0001";
    spoil(&place.path("runs").join(id).join("journal.db"), "too close");
    let events = "events 1 to 20 cannot be read";
    for words in ["history", "log", "replay", "export --format jsonl", "export --format csv"] {
        let (command, more) = words.split_once(' ').unwrap_or((words, ""));
        check_damaged(&place, &format!("{command} {id} {more}"), events);
    }
    check_damaged(&place, &format!("compare {id} 20261121-194002"), events);
    check_damaged(&place, "runs", "unreadable: ");
}
