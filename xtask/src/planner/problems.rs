//! Domains and problems of any size, without variation between calls. Knows PDDL only.

use std::fmt::Write as _;

/// Type hierarchy as JSON.
pub(super) const TYPES: &str = r#"{"truck": "vehicle", "airplane": "vehicle", "vehicle": "physobj", "package": "physobj", "airport": "place", "city": "object"}"#;

/// Names of skills, and their actions as PDDL.
pub(super) type Skills = &'static [(&'static str, &'static str)];

/// Blocks that one gripper stacks.
pub(super) const BLOCKS: Skills = &[
    (
        "pick_up",
        "(:action pick-up :parameters (?x - block) :precondition (and (clear ?x) (ontable ?x) (handempty)) :effect (and (not (ontable ?x)) (not (clear ?x)) (not (handempty)) (holding ?x)))",
    ),
    (
        "put_down",
        "(:action put-down :parameters (?x - block) :precondition (holding ?x) :effect (and (not (holding ?x)) (clear ?x) (handempty) (ontable ?x)))",
    ),
    (
        "stack",
        "(:action stack :parameters (?x ?y - block) :precondition (and (holding ?x) (clear ?y)) :effect (and (not (holding ?x)) (not (clear ?y)) (clear ?x) (handempty) (on ?x ?y)))",
    ),
    (
        "unstack",
        "(:action unstack :parameters (?x ?y - block) :precondition (and (on ?x ?y) (clear ?x) (handempty)) :effect (and (holding ?x) (clear ?y) (not (clear ?x)) (not (handempty)) (not (on ?x ?y))))",
    ),
];

/// Packages, trucks in cities, and airplanes between cities.
pub(super) const LOGISTICS: Skills = &[
    (
        "load",
        "(:action load :parameters (?p - package ?v - vehicle ?l - place) :precondition (and (at ?v ?l) (at ?p ?l)) :effect (and (not (at ?p ?l)) (in ?p ?v)))",
    ),
    (
        "unload",
        "(:action unload :parameters (?p - package ?v - vehicle ?l - place) :precondition (and (at ?v ?l) (in ?p ?v)) :effect (and (not (in ?p ?v)) (at ?p ?l)))",
    ),
    (
        "drive",
        "(:action drive :parameters (?t - truck ?a ?b - place ?c - city) :precondition (and (at ?t ?a) (in-city ?a ?c) (in-city ?b ?c)) :effect (and (not (at ?t ?a)) (at ?t ?b)))",
    ),
    (
        "fly",
        "(:action fly :parameters (?t - airplane ?a ?b - airport) :precondition (at ?t ?a) :effect (and (not (at ?t ?a)) (at ?t ?b)))",
    ),
];

/// A deterministic sequence of numbers.
struct Chance(usize);

impl Chance {
    fn below(&mut self, limit: usize) -> usize {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }
}

/// Random towers of blocks, and other towers of these blocks as the goal. `shaken`: other initial towers with an unchanged
/// goal.
pub(super) fn blocks(count: usize, shaken: bool) -> String {
    let chance = &mut Chance(1);
    let (begin, end) = (towers(count, chance), towers(count, chance));
    let begin = if shaken { towers(count, chance) } else { begin };
    let names: Vec<_> = (0..count).map(|block| format!("b{block}")).collect();
    let goal: Vec<_> = end.iter().filter(|fact| fact.starts_with("(on ")).cloned().collect();
    format!(
        "(define (problem blocks) (:domain blocks) (:objects {} - block) (:init (handempty) {}) (:goal (and {})))",
        names.join(" "),
        begin.join(" "),
        goal.join(" ")
    )
}

fn towers(count: usize, chance: &mut Chance) -> Vec<String> {
    let mut blocks: Vec<usize> = (0..count).collect();
    for at in (1..count).rev() {
        blocks.swap(at, chance.below(at + 1));
    }
    let mut facts = Vec::new();
    let mut rest = &blocks[..];
    while !rest.is_empty() {
        let (tower, more) = rest.split_at((1 + chance.below(count / 4)).min(rest.len()));
        facts.push(format!("(ontable b{})", tower[0]));
        facts.extend(tower.windows(2).map(|pair| format!("(on b{} b{})", pair[1], pair[0])));
        facts.push(format!("(clear b{})", tower[tower.len() - 1]));
        rest = more;
    }
    facts
}

/// Packages to move between places in cities, with one truck in each city and two airplanes.
pub(super) fn logistics(cities: usize, packages: usize) -> String {
    let chance = &mut Chance(3);
    let (mut objects, mut init, mut goal) = (
        "plane0 plane1 - airplane".to_owned(),
        "(at plane0 l0_0) (at plane1 l1_0)".to_owned(),
        String::new(),
    );
    for city in 0..cities {
        let truck = chance.below(3);
        // Writing to a string does not fail.
        let _infallible = write!(
            objects,
            " c{city} - city t{city} - truck l{city}_0 - airport l{city}_1 l{city}_2 - place"
        );
        let _infallible = write!(
            init,
            " (at t{city} l{city}_{truck}) (in-city l{city}_0 c{city}) (in-city l{city}_1 c{city}) (in-city l{city}_2 c{city})"
        );
    }
    for package in 0..packages {
        let mut place = || format!("l{}_{}", chance.below(cities), chance.below(3));
        let (from, to) = (place(), place());
        let _infallible = write!(objects, " p{package} - package");
        let _infallible = write!(init, " (at p{package} {from})");
        let _infallible = write!(goal, " (at p{package} {to})");
    }
    format!(
        "(define (problem logistics) (:domain logistics) (:objects {objects}) (:init {init}) (:goal (and{goal})))"
    )
}
