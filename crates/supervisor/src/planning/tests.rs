//! Engines with correct and faulty behaviour: shell scripts replace `kairos`.

use super::{Cancel, Planner, machine_of};
use crate::{Interpreter, ProgramEnvironment};
use expect_test::{Expect, expect};
use rafcon_protocol::api::{MakePlan, PlanEvent, PlanPool};
use rafcon_storage::{Libraries, Naming, Root, save};
use rafcon_testkit::notation::parse;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::Read as _;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::Command;
use std::{iter, thread};

const GO: &str = r#"
execution GOGOGO "Go"
  outcome success
  in to: str
  script "def execute(self, inputs, outputs, gvm):\n    return 0"
  semantic {"RAFCONTPP": {"PDDL_ACTION": {"pddl_action": "(:action go :parameters (?from ?to - place) :precondition (at ?from) :effect (and (not (at ?from)) (at ?to)))", "pddl_predicates": "(at ?x - place)", "pddl_types": "place", "requirements": [":strips", ":typing"], "description": ""}}}
"#;
const FACTS: &str =
    "(define (problem walk) (:domain d) (:objects a b - place) (:init (at a)) (:goal (at b)))";
const PLAN: &str = r#"echo '{"temporal":false,"cost":1,"steps":[{"action":"(go a b)"}]}'"#;
const DETOUR: &str = r#"echo '{"temporal":false,"cost":3,"steps":[{"action":"(go a b)"},{"action":"(go b a)"},{"action":"(go a b)"}]}'"#;

/// A pool with one skill, and an engine.
struct World {
    folder: tempfile::TempDir,
    libraries: Libraries,
}

impl World {
    fn new(engine: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let pool = folder.path().join("pool");
        save(&parse(GO).unwrap(), &pool.join("go"), None, Naming::default()).unwrap();
        let program = folder.path().join("kairos");
        if !engine.is_empty() {
            fs::write(&program, format!("#!/bin/sh\ncd {}\n{engine}\n", folder.path().display()))
                .unwrap();
            fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
        }
        Self { libraries: Libraries::new(vec![Root { name: "pool".into(), dir: pool }]), folder }
    }

    fn plan(
        &self,
        request: &MakePlan,
        cancel: &Cancel,
        tell: &mut dyn FnMut(&PlanEvent),
    ) -> Vec<PlanEvent> {
        let environment = ProgramEnvironment::default();
        let python =
            Interpreter::choose(Some(&self.folder.path().join("python3")), &environment).unwrap();
        let planner =
            Planner { libraries: &self.libraries, python: &python, environment: &environment };
        let mut events = Vec::new();
        let last = planner.plan(request, cancel, &mut |event| {
            tell(&event);
            events.push(event);
        });
        events.into_iter().chain(iter::once(last)).collect()
    }
}

fn request() -> MakePlan {
    let pool = PlanPool { libraries: vec!["pool".to_owned()], ..PlanPool::default() };
    MakePlan { pool, facts: FACTS.to_owned(), time_limit_ms: Some(60_000), ..MakePlan::default() }
}

fn told(events: &[PlanEvent]) -> String {
    let mut text = String::new();
    for event in events {
        let line = match event {
            PlanEvent::Found(found) => {
                let steps: Vec<_> = found.steps.iter().map(|step| step.title.as_str()).collect();
                format!("found {}, {} states", steps.join(", "), found.machine.states.len())
            }
            PlanEvent::Done(end) => format!("done: {}", end.reason),
            PlanEvent::Impossible(end) => format!("impossible: {}", end.reason),
            PlanEvent::NotFound(end) => format!("not found: {}", end.reason),
            PlanEvent::Failed(end) => format!("failed: {}", end.reason),
            PlanEvent::Cancelled(end) => format!("cancelled: {}", end.reason),
            PlanEvent::Refused(refused) => {
                let texts: Vec<_> =
                    refused.findings.iter().map(|finding| finding.text.as_str()).collect();
                format!("refused: {}", texts.join("; "))
            }
        };
        writeln!(text, "{line}").unwrap();
    }
    text
}

fn check(engine: &str, request: &MakePlan, expect: &Expect) {
    let world = World::new(engine);
    let events = world.plan(request, &Cancel::default(), &mut |_| ());
    let text = told(&events).replace(&world.folder.path().display().to_string(), "…");
    expect.assert_eq(&text);
}

#[test]
fn an_engine_is_believed_only_what_is_true() {
    check(
        PLAN,
        &request(),
        &expect![[r"
        found Go a b, 2 states
        done: a plan was found
    "]],
    );
    let lie = r#"echo '{"steps":[{"action":"(go b a)"}]}'"#;
    check(
        lie,
        &request(),
        &expect![[r"
        failed: the engine `kairos` gave a plan that is not valid: step 1: (at b) does not hold; choose another engine
    "]],
    );
    // The second search may succeed after the first one failed.
    let liar_once = format!("if [ -e lied ]; then {PLAN}; else touch lied; {lie}; fi");
    check(
        &liar_once,
        &request(),
        &expect![[r"
        found Go a b, 2 states
        done: a plan was found
    "]],
    );
    check(
        "echo '{]'; echo hello",
        &request(),
        &expect![[r"
        failed: the engine `kairos` gave a plan that is not valid: the plan is not JSON: line 1, column 2: expected a key in quotes; choose another engine
    "]],
    );
}

#[test]
fn what_an_engine_says_is_bounded() {
    let flood = "head -c 3000000 /dev/zero | tr '\\0' 'x'; echo; head -c 3000000 /dev/zero >&2";
    check(
        &format!("{flood}; {PLAN}"),
        &request(),
        &expect![[r"
        found Go a b, 2 states
        done: a plan was found
    "]],
    );
    // More lines than the queue can hold.
    check(
        &format!("seq 1 1000; {PLAN}"),
        &request(),
        &expect![[r"
        found Go a b, 2 states
        done: a plan was found
    "]],
    );
    let long = "printf '{'; head -c 9000000 /dev/zero | tr '\\0' '{'; echo";
    check(
        &format!("{long}; {PLAN}"),
        &request(),
        &expect![[r"
        found Go a b, 2 states
        done: a plan was found
    "]],
    );
}

#[test]
fn a_plan_that_is_too_long_to_be_ordered_is_refused() {
    let there_and_back = r#"{"action":"(go a b)"},{"action":"(go b a)"},"#.repeat(2000);
    let plan = format!(r#"{{"steps":[{there_and_back}{{"action":"(go a b)"}}]}}"#);
    let world = World::new("exec cat plan.json");
    fs::write(world.folder.path().join("plan.json"), plan + "\n").unwrap();
    let parallel = MakePlan { parallel: true, ..request() };
    let events = world.plan(&parallel, &Cancel::default(), &mut |_| ());
    expect![[r"
        failed: the plan has 4001 steps, too many to find out what of them can be done at the same time (at most 3000): plan without `--parallel` and durations, or for a smaller goal
    "]].assert_eq(&told(&events));
}

#[test]
fn engines_that_find_nothing_say_why() {
    check(
        "exit 10",
        &request(),
        &expect![[r"
        impossible: the goal cannot be reached from these facts with these skills
    "]],
    );
    check(
        "exit 14",
        &request(),
        &expect![[r"
        not found: the engine `kairos` has found no plan; most likely there is none
    "]],
    );
    check(
        "exit 0",
        &request(),
        &expect![[r"
        failed: the engine `kairos` ended without a plan and said nothing; choose another engine
    "]],
    );
    check(
        "echo 'bad luck' >&2; exit 3",
        &request(),
        &expect![[r"
        failed: the engine `kairos` ended with exit status 3: bad luck
    "]],
    );
    check(
        "kill -9 $$",
        &request(),
        &expect![[r"
        failed: the engine `kairos` was killed: it said nothing
    "]],
    );
    check(
        "exec tail -f /dev/null",
        &MakePlan { time_limit_ms: Some(20), ..request() },
        &expect![[r"
            not found: the engine `kairos` has found no plan within 0.02 s: give it more time (`--time-limit`), or fewer objects
        "]],
    );
}

#[test]
fn an_engine_gets_names_that_it_understands_and_people_their_own() {
    let facts = "(define (problem walk) (:domain d) (:objects Küche place - place) (:init (at Küche)) (:goal (at place)))";
    let wanted = MakePlan { facts: facts.to_owned(), ..request() };
    let engine = r#"
        if LC_ALL=C grep -q '[^ -~]' "$2" "$3"; then echo 'names' >&2; exit 3; fi
        if grep -q 'place - place$' "$3"; then echo 'twice' >&2; exit 3; fi
        from=$(sed -n 's/.*(at \([^ )]*\)).*/\1/p' "$3" | head -n 1)
        echo "{\"steps\":[{\"action\":\"(go $from place)\"}]}"
    "#;
    check(
        engine,
        &wanted,
        &expect![[r"
            found Go Küche place, 2 states
            done: a plan was found
        "]],
    );
    check(
        &format!("{engine}\nexit 0").replace("(go $from place)", "(go place $from)"),
        &wanted,
        &expect![[r"
            failed: the engine `kairos` gave a plan that is not valid: step 1: (at place) does not hold; choose another engine
        "]],
    );
    check(
        "echo 'line one' >&2; sed -n 's/.*(at \\([^ )]*\\)).*/here: \\1/p' \"$3\" | head -n 1 >&2; echo 'on the output'; exit 3",
        &wanted,
        &expect![[r"
            failed: the engine `kairos` ended with exit status 3: 
            line one
            here: küche
            on the output
        "]],
    );
}

#[test]
fn a_missing_engine_is_told_with_the_way_to_get_it() {
    let world = World::new("");
    let events = world.plan(
        &MakePlan { engine: Some("pyperplan".to_owned()), ..request() },
        &Cancel::default(),
        &mut |_| (),
    );
    expect![[r"
        failed: the engine `pyperplan` is not there: --python or RAFCON_PYTHON must name a Python 3.9 or newer
    "]].assert_eq(&told(&events));
}

#[test]
fn an_engine_that_cannot_be_started_is_told_with_the_way_to_get_it() {
    let world = World::new("exit 0");
    fs::write(world.folder.path().join("kairos"), "#!/nowhere/interpreter\n").unwrap();
    let events = world.plan(&request(), &Cancel::default(), &mut |_| ());
    expect![[r"
        failed: the engine `kairos` is not there: install it: `pip install kairos-planner`, or choose another engine
    "]].assert_eq(&told(&events));
}

#[test]
fn better_plans_follow_and_worse_ones_do_not() {
    let anytime = MakePlan { anytime: true, ..request() };
    check(
        &format!("{DETOUR}; {PLAN}; {DETOUR}"),
        &anytime,
        &expect![[r"
        found Go a b, Go b a, Go a b, 4 states
        found Go a b, 2 states
        done: the last of 2 plans is the best
    "]],
    );
}

#[test]
fn what_cannot_be_planned_starts_no_engine() {
    let goal = |text: &str| MakePlan { goal: Some(text.to_owned()), ..request() };
    let engine = "echo 'it was started' >&2; exit 3";
    check(
        engine,
        &goal("(at c)"),
        &expect![[r"
        refused: goal: `(at c)` names `c`, which is no object: add it to `(:objects …)`
    "]],
    );
    check(
        engine,
        &goal("(at b"),
        &expect![[r"
        refused: goal: line 1, column 1: this `(` is never closed
    "]],
    );
    let pool = |path: &str| PlanPool { libraries: vec![path.to_owned()], ..PlanPool::default() };
    check(
        engine,
        &MakePlan { pool: pool("nowhere"), ..request() },
        &expect![[r"
        refused: there are no libraries in `nowhere`: name a library root, or a folder below one; the pool has no skills: none of its libraries has a planner annotation
    "]],
    );
    check(
        engine,
        &MakePlan { observe: Some("pool/look".to_owned()), ..request() },
        &expect![[r"
            refused: the library pool/look is missing: …/pool/look: No such file or directory (os error 2)
        "]],
    );
    check(
        engine,
        &MakePlan { observe: Some("pool/go".to_owned()), ..request() },
        &expect![[r"
        refused: the library planning/replan is missing: no library root is named `planning`; it comes with RAFCON: `--library-path planning=…/libraries/planning`
    "]],
    );
}

#[test]
fn a_cancelled_engine_is_gone_with_all_that_it_started() {
    check_gone("(exec 3>alive; exec tail -f /dev/null) &");
}

#[test]
fn a_cancelled_engine_is_gone_with_what_left_its_session_and_lost_its_parent() {
    check_gone("(setsid sh -c 'exec 3>alive; exec tail -f /dev/null' &);");
}

/// Cancels an engine that has started a background process.
fn check_gone(background: &str) {
    let world = World::new(&format!("{background} exec 3>alive; {PLAN}; exec tail -f /dev/null"));
    let alive = world.folder.path().join("alive");
    assert!(Command::new("mkfifo").arg(&alive).status().unwrap().success());
    thread::scope(|scope| {
        // The pipe is closed once all processes that have it open have exited.
        let ended = scope
            .spawn(|| File::open(&alive).and_then(|mut file| file.read_to_end(&mut Vec::new())));
        let cancel = Cancel::default();
        let anytime = MakePlan { anytime: true, ..request() };
        let events = world.plan(&anytime, &cancel, &mut |_| cancel.cancel());
        assert_eq!(ended.join().unwrap().unwrap(), 0);
        expect![[r"
            found Go a b, 2 states
            cancelled: nobody waits for it any more
        "]]
        .assert_eq(&told(&events));
    });
}

#[test]
fn a_search_that_was_cancelled_before_its_begin_starts_no_engine() {
    let world = World::new(PLAN);
    let cancel = Cancel::default();
    cancel.cancel();
    assert!(matches!(world.plan(&request(), &cancel, &mut |_| ())[..], [PlanEvent::Cancelled(_)]));
}

#[test]
fn the_machine_of_a_plan_is_saved_as_any_other() {
    let world = World::new(PLAN);
    let events = world.plan(&request(), &Cancel::default(), &mut |_| ());
    let PlanEvent::Found(found) = &events[0] else { panic!("{events:?}") };
    let machine = machine_of(found, &world.libraries).unwrap();
    let folder = world.folder.path().join("walk");
    save(&machine, &folder, None, Naming::default()).unwrap();
    let loaded = rafcon_storage::load(&folder, &world.libraries).unwrap();
    assert!(loaded.problems.is_empty(), "{:?}", loaded.problems);
    assert_eq!(loaded.machine.root, machine.root);
    assert!(Path::new(&folder).join("statemachine.json").exists());
}
