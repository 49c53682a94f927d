//! Valid plans, and invalid plans that engines report as valid.

use super::{HUNGRY, LUNCH, PERSONS, RESTAURANT, plan, pool, task};
use crate::{Plan, Task, explain, validate};
use expect_test::{Expect, expect};
use std::fmt::Write as _;

const LOGISTICS: &str = "
skill drive
(:durative-action drive :parameters (?t - truck ?a ?b - loc) :duration (= ?duration 5)
 :condition (and (at start (at ?t ?a)) (over all (road ?a ?b)) (at start (>= (fuel ?t) 1)))
 :effect (and (at start (not (at ?t ?a))) (at end (at ?t ?b)) (at end (decrease (fuel ?t) 1))))
skill load
(:durative-action load :parameters (?p - pkg ?t - truck ?a - loc) :duration (= ?duration 2)
 :condition (and (at start (pat ?p ?a)) (over all (at ?t ?a)))
 :effect (and (at start (not (pat ?p ?a))) (at end (in ?p ?t))))
";
const DELIVERY: &str = "(define (problem p) (:objects t - truck a b - loc p q - pkg)
 (:init (at t a) (pat p a) (pat q a) (road a b) (= (fuel t) 1)) (:goal (and (in p t) (at t b))))";

fn check(skills: &str, types: &str, problem: &str, steps: &str, expect: &Expect) {
    let pool = pool(skills, types);
    let (task, findings) = task(&pool, problem);
    assert!(findings.is_empty(), "{findings:?}");
    expect.assert_eq(&match validate(&task, &plan(steps)) {
        Ok(world) => format!("valid, {} facts", world.facts.len()),
        Err(invalid) => invalid.to_string(),
    });
}

#[test]
fn a_plan_is_run_before_it_is_believed() {
    let check = |steps: &str, expect: &Expect| check(RESTAURANT, PERSONS, HUNGRY, steps, expect);
    check(LUNCH, &expect!["valid, 4 facts"]);
    check(
        &LUNCH.replace("(cook bob pizza)\n", ""),
        &expect!["step 5: (has bob pizza) does not hold"],
    );
    check(
        LUNCH.rsplit_once('\n').unwrap().0,
        &expect!["the goal is not reached: (be-full alice) does not hold"],
    );
    check("(fly james)", &expect!["step 1: there is no action `fly`"]);
    check("(cook bob)", &expect!["step 1: `cook` takes 2 objects, not 1"]);
    check("(cook alice pizza)", &expect!["step 1: `alice` is a guest, and `?chef` takes chef"]);
    check("(cook bob nothing)", &expect!["step 1: there is no object `nothing`"]);
    check("", &expect!["the goal is not reached: (be-full alice) does not hold"]);
}

#[test]
fn times_are_looked_at() {
    let check = |steps: &str, expect: &Expect| check(LOGISTICS, "", DELIVERY, steps, expect);
    check("0: (load p t a) [2]\n2: (drive t a b) [5]", &expect!["valid, 4 facts"]);
    check(
        "0: (load p t a) [2]\n1: (drive t a b) [5]",
        &expect!["step 1: (at t a) does not hold while it runs"],
    );
    check(
        "0: (load p t a) [2]\n2: (drive t a b) [4]",
        &expect!["step 2: it takes 4, and (= ?duration 5) is asked for"],
    );
    check(
        "0: (load p t a) [2]\n0: (load p t a) [2]\n2: (drive t a b) [5]",
        &expect!["step 2: it disturbs step 1, which is simultaneous"],
    );
    check(
        "0: (load p t a) [2]\n2: (drive t a b) [5]\n9: (drive t b a) [5]",
        &expect!["step 3: (>= (fuel ?t) 1) does not hold: the numbers are 0 and 1"],
    );
}

#[test]
fn numbers_and_conditions_of_every_kind_are_understood() {
    let skills = "skill pour
(:action pour :parameters (?a ?b - jug)
 :precondition (and (not (= ?a ?b)) (imply (lid ?b) (open ?b)) (>= (litres ?a) (- 5 2)) (exists (?j - jug) (open ?j)))
 :effect (and (decrease (litres ?a) 3) (increase (litres ?b) 3) (when (> (litres ?b) 0) (mixed ?b))
   (forall (?j - jug) (seen ?j))))";
    let problem = |litres: f64, goal: &str| {
        format!(
            "(define (problem p) (:objects a b - jug) (:init (lid b) (open b) (= (litres a) {litres}) (= (litres b) 1)) (:goal {goal}))"
        )
    };
    let steps = "(pour a b)";
    check(
        skills,
        "",
        &problem(4.0, "(and (= (litres b) 4) (mixed b) (forall (?j - jug) (seen ?j)))"),
        steps,
        &expect!["valid, 5 facts"],
    );
    check(
        skills,
        "",
        &problem(2.0, "(mixed b)"),
        steps,
        &expect!["step 1: (>= (litres ?a) (- 5 2)) does not hold: the numbers are 2 and 3"],
    );
    check(
        skills,
        "",
        &problem(4.0, "(or (mixed a) (< (litres b) 4))"),
        steps,
        &expect![
            "the goal is not reached: (mixed a) does not hold and (< (litres b) 4) does not hold: the numbers are 4 and 4"
        ],
    );
    check(skills, "", &problem(4.0, "(mixed b)"), "(pour a a)", &expect!["step 1: both are a"]);
}

#[test]
fn what_is_no_plan_is_told() {
    for (text, expect) in [
        ("{", expect!["the plan is not JSON: line 1, column 2: expected a key in quotes"]),
        ("{\"steps\": 3}", expect!["the plan has no `steps`"]),
        (
            "{\"steps\": [{\"action\": \"go\"}]}",
            expect!["step 1 of the plan is no action in brackets"],
        ),
        (
            "{\"temporal\": true, \"steps\": [{\"action\": \"(go)\", \"time\": NaN}]}",
            expect!["step 1 of the plan has a time that is no time"],
        ),
        (
            "{\"temporal\": true, \"steps\": [{\"action\": \"(go)\", \"time\": 0, \"duration\": -3}]}",
            expect!["step 1 of the plan has a time that is no time"],
        ),
    ] {
        expect.assert_eq(&Plan::read(text).unwrap_err());
    }
}

fn explained(task: &Task, plan: &Plan) -> String {
    let mut text = String::new();
    for (at, (step, reason)) in plan.steps.iter().zip(explain(task, plan)).enumerate() {
        writeln!(text, "{} {step}", at + 1).unwrap();
        for need in reason.needs {
            let from = need.from.map_or("the beginning".to_owned(), |from| (from + 1).to_string());
            writeln!(text, "    needs {} from {from}", need.fact).unwrap();
        }
        for gain in reason.brings {
            let steps: Vec<_> = gain.steps.iter().map(|step| (step + 1).to_string()).collect();
            writeln!(
                text,
                "    brings {} for {}{}",
                gain.fact,
                steps.join(", "),
                if gain.goal { " the goal" } else { "" }
            )
            .unwrap();
        }
    }
    text
}

#[test]
fn each_step_says_why_it_is_there() {
    let pool = pool(RESTAURANT, PERSONS);
    let (task, _) = task(&pool, HUNGRY);
    expect![[r"
        1 (got-to entrance table james)
            needs (at entrance james) from the beginning
            brings (at table james) for 2, 3
        2 (order james alice pizza table)
            needs (at table alice) from the beginning
            needs (at table james) from 1
            needs (wants alice pizza) from the beginning
            brings (wants james pizza) for 4, 6
        3 (got-to table kitchen james)
            needs (at table james) from 1
            brings (at kitchen james) for 4, 6, 7
        4 (order bob james pizza kitchen)
            needs (at kitchen bob) from the beginning
            needs (at kitchen james) from 3
            needs (wants james pizza) from 2
            brings (wants bob pizza) for 5
        5 (cook bob pizza)
            needs (wants bob pizza) from 4
            brings (has bob pizza) for 6
        6 (give bob james pizza kitchen)
            needs (at kitchen bob) from the beginning
            needs (at kitchen james) from 3
            needs (has bob pizza) from 5
            needs (wants james pizza) from 2
            brings (has james pizza) for 8
        7 (got-to kitchen table james)
            needs (at kitchen james) from 3
            brings (at table james) for 8
        8 (give james alice pizza table)
            needs (at table alice) from the beginning
            needs (at table james) from 7
            needs (has james pizza) from 6
            needs (wants alice pizza) from the beginning
            brings (has alice pizza) for 9
        9 (eat alice pizza)
            needs (has alice pizza) from 8
            brings (be-full alice) for  the goal
    "]]
    .assert_eq(&explained(&task, &plan(LUNCH)));
}

#[test]
fn what_must_not_hold_is_a_reason_as_well() {
    let pool = pool(
        "
skill enter room
(:action enter :parameters (?r - room) :precondition (and (not (locked ?r)) (not (occupied ?r))
  (forall (?d - dog) (not (in ?d ?r)))) :effect (occupied ?r))
skill unlock room
(:action unlock :parameters (?r - room) :precondition (locked ?r) :effect (not (locked ?r)))
skill call dog room
(:action call :parameters (?d - dog ?r - room) :precondition (in ?d ?r) :effect (not (in ?d ?r)))
skill leave room
(:action leave :parameters (?r - room) :precondition (occupied ?r) :effect (not (occupied ?r)))
",
        "",
    );
    let problem = "(define (problem visit)(:domain d)(:objects hall - room rex bello - dog)
        (:init (locked hall) (in rex hall)) (:goal (and (not (occupied hall)) (not (locked hall)))))";
    let (task, findings) = task(&pool, problem);
    assert!(findings.is_empty(), "{findings:?}");
    let plan = plan("(unlock hall)\n(call rex hall)\n(enter hall)\n(leave hall)");
    assert!(validate(&task, &plan).is_ok());
    expect![[r"
        1 (unlock hall)
            needs (locked hall) from the beginning
            brings (not (locked hall)) for 3 the goal
        2 (call rex hall)
            needs (in rex hall) from the beginning
            brings (not (in rex hall)) for 3
        3 (enter hall)
            needs (not (in bello hall)) from the beginning
            needs (not (in rex hall)) from 2
            needs (not (locked hall)) from 1
            needs (not (occupied hall)) from the beginning
            brings (occupied hall) for 4
        4 (leave hall)
            needs (occupied hall) from 3
            brings (not (occupied hall)) for  the goal
    "]]
    .assert_eq(&explained(&task, &plan));
}

#[test]
fn a_plan_has_so_many_steps_at_most() {
    let read = |steps: usize| {
        let steps = vec![r#"{"action": "(go)"}"#; steps].join(",");
        Plan::read(&format!(r#"{{"steps": [{steps}]}}"#)).map(|plan| plan.steps.len())
    };
    assert_eq!(read(100_000), Ok(100_000));
    let refused = "the plan has 100001 steps; at most 100000 are taken";
    assert_eq!(read(100_001), Err(refused.to_owned()));
}
