//! Merging of skills into a domain, and findings about contradictions.

use super::{HUNGRY, PERSONS, RESTAURANT, lines, pool, skills, task};
use crate::pddl::read_action;
use expect_test::{Expect, expect};

fn check_findings(text: &str, types: &str, expect: &Expect) {
    let all = skills(text);
    let broken = lines(all.iter().filter_map(|skill| skill.as_ref().err()));
    if broken.is_empty() {
        expect.assert_eq(&lines(&pool(text, types).findings));
    } else {
        expect.assert_eq(&broken);
    }
}

#[test]
fn the_restaurant_becomes_one_domain() {
    expect![[r"
        (define (domain test)
          (:requirements :strips :typing)
          (:types chef - person food - object guest - person location - object person - object waiter - person)
          (:predicates (at ?loc - location ?interlocutor1 - person) (be-full ?person - person) (has ?chef - person ?food - food) (wants ?chef - person ?food - food))
          (:action cook
            :parameters (?chef - chef ?food - food)
            :precondition (wants ?chef ?food)
            :effect (and (has ?chef ?food) (not (wants ?chef ?food))))
          (:action eat
            :parameters (?person - person ?food - food)
            :precondition (and (has ?person ?food))
            :effect (and (not (has ?person ?food)) (be-full ?person)))
          (:action give
            :parameters (?interlocutor1 - person ?interlocutor2 - person ?food - food ?loc - location)
            :precondition (and (at ?loc ?interlocutor1) (at ?loc ?interlocutor2) (wants ?interlocutor2 ?food) (has ?interlocutor1 ?food))
            :effect (and (not (wants ?interlocutor2 ?food)) (not (has ?interlocutor1 ?food)) (has ?interlocutor2 ?food)))
          (:action got-to
            :parameters (?start - location ?destination - location ?name - waiter)
            :precondition (and (at ?start ?name))
            :effect (and (not (at ?start ?name)) (at ?destination ?name)))
          (:action order
            :parameters (?interlocutor1 - person ?interlocutor2 - person ?food - food ?loc - location)
            :precondition (and (at ?loc ?interlocutor1) (at ?loc ?interlocutor2) (wants ?interlocutor2 ?food))
            :effect (and (wants ?interlocutor1 ?food)))
        )"]].assert_eq(&pool(RESTAURANT, PERSONS).domain.to_string());
    check_findings(RESTAURANT, PERSONS, &expect![[r""]]);
}

#[test]
fn what_is_written_reads_back() {
    let drive = "(:durative-action drive :parameters (?t - truck ?a ?b - place) :duration (= ?duration (/ (far ?a ?b) 2))
        :condition (and (at start (at ?t ?a)) (over all (or (road ?a ?b) (not (wet ?a)))) (at start (>= (fuel ?t) 1)))
        :effect (and (at start (not (at ?t ?a))) (at end (at ?t ?b)) (at end (decrease (fuel ?t) 1))
          (at end (forall (?p - thing) (when (in ?p ?t) (at ?p ?b))))))";
    let action = read_action(drive).unwrap();
    expect![[r"
        (:durative-action drive
            :parameters (?t - truck ?a - place ?b - place)
            :duration (= ?duration (/ (far ?a ?b) 2))
            :condition (and (at start (and (at ?t ?a) (>= (fuel ?t) 1))) (over all (or (road ?a ?b) (not (wet ?a)))))
            :effect (and (at start (not (at ?t ?a))) (at end (at ?t ?b)) (at end (decrease (fuel ?t) 1)) (at end (forall (?p - thing) (when (in ?p ?t) (at ?p ?b))))))"]].assert_eq(&action.to_string());
    assert_eq!(read_action(&action.to_string()).unwrap(), action);
}

#[test]
fn what_contradicts_is_named_by_its_states() {
    let two = "skill a\n(:action go :parameters (?x - robot ?y - place) :precondition (at ?x ?y) :effect (on))
skill b\n(:action go :parameters (?x - place ?y - robot) :precondition (at ?x ?y) :effect (and))
types robot - thing
skill c\n(:action stay :parameters (?x - robot) :precondition (and (at ?x) (on)) :effect (increase (on) 1))
types robot - machine";
    check_findings(
        two,
        "",
        &expect![[r"
        error: pool/b, pool/c: the type `robot` is a kind of `thing` and of `machine`: decide for one
        error: pool/a, pool/b: each is the action `go`: rename it in all but one
        warning: pool/a, pool/b: `(at ?x - robot ?y - place)` and `(at ?x - place ?y - robot)` take unrelated types: `robot` and `place`; if they belong together, give them a common supertype
        warning: pool/a, pool/b: `(at ?x - robot ?y - place)` and `(at ?x - place ?y - robot)` take unrelated types: `place` and `robot`; if they belong together, give them a common supertype
        error: pool/a, pool/c: `(at ?x - object ?y - object)` and `(at ?x - robot)` differ in their number of arguments: make them equal, or rename one
        error: `on` is a predicate and a number: rename one
    "]],
    );
    check_findings(
        "skill a\n(:action go :parameters (?x - a) :effect (on ?x))",
        "a b, b c, c a",
        &expect![[r"
            error: the types `a`, `b`, `c` form a circle: each is a kind of the next
        "]],
    );
    check_findings(
        "skill a where to\n(:action go :parameters (?where) :effect (and (on ?z) (off home)))\npredicates (on ?z)",
        "",
        &expect![[r"
            warning: pool/a: `off` is used in the action and missing among its predicates
            error: pool/a: `?z` is no parameter of `go`: add it to `:parameters`
            error: pool/a: `go` names the object `home`: make it a parameter, `?home`
            warning: pool/a: no parameter sets the input `to`: name one `?to`, or give the input a default value
        "]],
    );
}

#[test]
fn of_two_kinds_the_narrower_counts_where_one_is_object() {
    for (first, second) in [("object", "surface"), ("surface", "object")] {
        let two = format!(
            "skill a\n(:action go :parameters (?x - area) :precondition (on ?x) :effect (on ?x))\ntypes area - {first}\n\
             skill b\n(:action stay :parameters (?x - area) :precondition (on ?x) :effect (on ?x))\ntypes area - {second}"
        );
        check_findings(&two, "", &expect![[""]]);
    }
}

#[test]
fn what_is_no_action_is_told_with_its_place() {
    for (text, expect) in [
        (
            "(:action go",
            expect![[r"
            error: pool/a: pddl_action: line 1, column 1: this `(` is never closed
        "]],
        ),
        (
            "(:action go :parameters (x))",
            expect![[r"
            error: pool/a: pddl_action: line 1, column 26: `x` is no variable: write `?x`
        "]],
        ),
        (
            "(:action go :parameters () :effect (at start (on)))",
            expect![[r"
            error: pool/a: pddl_action: line 1, column 46: a variable or an object is expected here
        "]],
        ),
        (
            "(:durative-action go :parameters () :effect (at start (on)))",
            expect![[r"
            error: pool/a: pddl_action: line 1, column 1: the `:duration` is missing, such as `(= ?duration 5)`
        "]],
        ),
        (
            "(:durative-action go :parameters () :duration (= ?duration 1) :effect (on))",
            expect![[r"
                error: pool/a: pddl_action: line 1, column 71: in an action with duration, specify when: `(at start …)`, `(over all …)` or `(at end …)`
            "]],
        ),
        (
            "(:durative-action go :parameters () :duration (>= ?duration -1))",
            expect![[r"
                error: pool/a: pddl_action: line 1, column 61: a duration is not negative
            "]],
        ),
        (
            "(:action go :parameters () :precondition (> (fuel) much))",
            expect![[r"
            error: pool/a: pddl_action: line 1, column 52: `much` is no number: write one, or a function in brackets
        "]],
        ),
    ] {
        check_findings(&format!("skill a\n{text}"), "", &expect);
    }
    let nested = format!("{}{}", "(".repeat(1_000_000), ")".repeat(1_000_000));
    assert!(read_action(&nested).is_err());
    check_findings(
        "skill a\n(:action go :parameters () :effect (on))\nplanning {\"retries\": -1}",
        "",
        &expect![[r"
            error: pool/a: planning: `retries` is a number from 0 to 1000
        "]],
    );
    check_findings(
        "skill a\n(:action go :parameters () :effect (on))\nplanning {\"then\": \"pray\"}",
        "",
        &expect![[r#"
            error: pool/a: planning: `pray` is no way to recover: there are "give up", "ask" and "replan"
        "#]],
    );
}

#[test]
fn facts_and_goal_fit_the_domain_or_are_told() {
    let pool = pool(RESTAURANT, PERSONS);
    let problem = "(define (problem p) (:objects james - Waiter pizza - Foood kitchen - Location)
        (:init (at kitchen james) (at pizza james) (sleeps james) (at kitchen) (= (money james) 3))
        (:goal (and (wants nobody pizza) (forall (?p - Person) (not (flies ?p))) (has ?p pizza))))";
    expect![[r"
        error: facts: `pizza` is a `foood`, which is no type; there are chef, food, guest, location, person, waiter
        warning: facts: no skill knows `money`: facts with it are left out
        warning: facts: no skill knows `sleeps`: facts with it are left out
        error: facts: `pizza` in `(at pizza james)` is no location
        error: facts: `(at kitchen)` does not fit `(at ?loc - location ?interlocutor1 - person)`
        error: goal: `(wants nobody pizza)` names `nobody`, which is no object: add it to `(:objects …)`
        error: goal: `pizza` in `(wants nobody pizza)` is no food
        error: goal: no skill knows `(flies ?p)`; there are (at ?loc - location ?interlocutor1 - person) (be-full ?person - person) (has ?chef - person ?food - food) (wants ?chef - person ?food - food)
        error: goal: `?p` in `(has ?p pizza)` is not declared
        error: goal: `pizza` in `(has ?p pizza)` is no food
    "]].assert_eq(&lines(task(&pool, problem).1));
    expect![[r""]].assert_eq(&lines(task(&pool, HUNGRY).1));
}
