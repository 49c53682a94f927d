//! Names that planning engines accept, and their mapping to the user's names.

use super::{plan, pool, task};
use crate::Task;
use crate::pddl::Renamed;
use expect_test::{Expect, expect};
use proptest::prelude::*;

const CHARGE: &str = "
skill charge robot battery
(:action charge :parameters (?robot - Robot ?battery - Battery)
 :precondition (and (at ?robot) (not (full ?battery))) :effect (full ?battery))
predicates (at ?robot - Robot) (full ?battery - Battery)
types Robot, Battery
";

fn renamed(skills: &str, problem: &str) -> (Task, Renamed) {
    let (task, _) = task(&pool(skills, ""), problem);
    let names = Renamed::new(&task.domain, &task.problem);
    (task, names)
}

fn check(skills: &str, problem: &str, expect: &Expect) -> Renamed {
    let (_, names) = renamed(skills, problem);
    expect.assert_eq(&format!("{}\n{}\n", names.domain, names.problem));
    names
}

#[test]
fn an_object_may_have_the_name_of_a_type() {
    let names = check(
        CHARGE,
        "(define (problem p) (:domain d) (:objects robot - Robot Battery - Battery)
        (:init (at robot)) (:goal (full battery)) (:metric minimize (total-cost)))",
        &expect![[r"
            (define (domain world)
              (:requirements :negative-preconditions :strips :typing)
              (:types battery_type - object robot_type - object)
              (:predicates (at ?robot - robot_type) (full ?battery - battery_type))
              (:action charge
                :parameters (?robot - robot_type ?battery - battery_type)
                :precondition (and (at ?robot) (not (full ?battery)))
                :effect (full ?battery))
            )
            (define (problem task) (:domain world)
              (:objects robot - robot_type battery - battery_type)
              (:init (at robot))
              (:goal (full battery))
              (:metric minimize (total-cost))
            )
        "]],
    );
    let mut found = plan("(charge robot battery)");
    found.restore_names(&names);
    assert_eq!(found, plan("(charge robot battery)"));
}

#[test]
fn letters_of_other_languages_and_words_of_pddl_are_names() {
    let names = check(
        CHARGE,
        "(define (problem küche) (:domain d) (:objects Küche 漢 and 2nd charge robot_2 - Robot b - Battery)
        (:init (at Küche) (at and) (at 2nd) (at 漢)) (:goal (forall (?größe - Battery) (full ?größe))))",
        &expect![[r"
            (define (domain world)
              (:requirements :negative-preconditions :strips :typing)
              (:types battery - object robot - object)
              (:predicates (at ?robot - robot) (full ?battery - battery))
              (:action charge
                :parameters (?robot - robot ?battery - battery)
                :precondition (and (at ?robot) (not (full ?battery)))
                :effect (full ?battery))
            )
            (define (problem task) (:domain world)
              (:objects k_che_object - robot object_2 - robot and_object - robot object_2nd - robot charge_object - robot robot_2 - robot b - battery)
              (:init (at k_che_object) (at and_object) (at object_2nd) (at object_2))
              (:goal (forall (?gr__e_variable - battery) (full ?gr__e_variable)))
            )
        "]],
    );
    let mut found = plan("(charge k_che_object b)");
    found.restore_names(&names);
    assert_eq!(found, plan("(charge küche b)"));
    assert_eq!(
        names.with_originals("line 3: K_che_object, object_2nd-x (and_object)"),
        "line 3: küche, object_2nd-x (and)"
    );
}

proptest! {
    #[test]
    fn any_names_are_understood_and_come_back(objects in proptest::collection::btree_set("[a-zäß漢0-9_@.'+-]{1,6}", 1..12)) {
        let list: Vec<_> = objects.iter().filter(|name| name.as_str() != "-").cloned().collect();
        let typed: Vec<_> = list.iter().map(|name| format!("{name} - Robot")).collect();
        let facts: Vec<_> = list.iter().map(|name| format!("(at {name})")).collect();
        let problem = format!(
            "(define (problem p) (:domain d) (:objects {} b - Battery) (:init {}) (:goal (full b)))",
            typed.join(" "), facts.join(" "),
        );
        let Ok(_) = crate::pddl::read_problem(&problem) else { return Ok(()) };
        let (task, names) = renamed(CHARGE, &problem);
        let text = format!("{}{}", names.domain, names.problem);
        prop_assert!(text.is_ascii(), "{}", text);
        let back: Vec<_> = names.problem.objects.iter().map(|one| names.original(&one.name)).collect();
        let before: Vec<_> = task.problem.objects.iter().map(|one| one.name.clone()).collect();
        prop_assert_eq!(back, before);
        let mut all: Vec<_> = names.problem.objects.iter().map(|one| one.name.as_str()).collect();
        all.extend(names.domain.types.iter().map(|(child, _)| child.as_str()));
        all.extend(names.domain.actions.iter().map(|action| action.name.as_str()));
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        prop_assert_eq!(all.len(), count);
    }
}
