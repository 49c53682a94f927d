//! Random tests: every linearisation of a machine's steps is a valid plan.

use crate::pddl::{Condition, Domain, Problem, read_action, read_condition, read_problem};
use crate::{Order, Plan, Step, Structure, Task, validate};

/// The generator known as `SplitMix64`.
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        usize::try_from((mixed ^ (mixed >> 31)) % (limit.max(1) as u64)).unwrap()
    }

    fn some(&mut self, part: impl Fn(&mut Self) -> String) -> String {
        (0..self.below(3)).map(|_| part(self)).collect::<Vec<_>>().join(" ")
    }
}

/// Actions over five facts and two numbers, with all kinds of conditions and effects.
fn domain(chance: &mut Chance) -> Domain {
    let fact = |chance: &mut Chance| {
        format!("(f{} {})", chance.below(3), ["a", "b", "?x"][chance.below(3)])
    };
    let need = |chance: &mut Chance| {
        let one = fact(chance);
        match chance.below(6) {
            0 => format!("(not {one})"),
            1 => format!("(or {one} (>= (n) {}))", chance.below(4)),
            2 => format!("(exists (?y) (f{} ?y))", chance.below(3)),
            _ => one,
        }
    };
    let effect = |chance: &mut Chance| {
        let one = fact(chance);
        match chance.below(7) {
            0 => format!("(not {one})"),
            1 => "(increase (n) 1)".to_owned(),
            2 => "(assign (m) (n))".to_owned(),
            3 => format!("(when {} {one})", fact(chance)),
            4 => format!("(forall (?y) (not (f{} ?y)))", chance.below(3)),
            _ => one,
        }
    };
    let actions = (0..6).map(|index| {
        let (needs, effects) = (chance.some(need), chance.some(effect));
        let text = format!("(:action act{index} :parameters (?x) :precondition (and {needs}) :effect (and {effects}))");
        read_action(&text).unwrap()
    });
    Domain { name: "random".into(), actions: actions.collect(), ..Domain::default() }
}

fn problem(chance: &mut Chance) -> Problem {
    let facts: Vec<_> = (0..3)
        .flat_map(|fact| ["a", "b"].map(|object| format!("(f{fact} {object})")))
        .filter(|_| chance.below(2) == 0)
        .collect();
    read_problem(&format!(
        "(define (problem p) (:objects a b) (:init {} (= (n) 1) (= (m) 0)) (:goal (and)))",
        facts.join(" ")
    ))
    .unwrap()
}

/// Steps that can run one after the other, found by trial. The facts and numbers after them become the goal.
fn walk(chance: &mut Chance, task: &mut Task) -> Plan {
    let mut plan = Plan { steps: Vec::new(), temporal: false, cost: None };
    for _ in 0..40 {
        #[expect(clippy::cast_precision_loss, reason = "a few steps")]
        let start = plan.steps.len() as f64;
        let action = format!("act{}", chance.below(6)).into();
        plan.steps.push(Step {
            action,
            objects: vec![["a", "b"][chance.below(2)].into()],
            start,
            duration: None,
        });
        if validate(task, &plan).is_err() {
            plan.steps.pop();
        }
        if plan.steps.len() >= 8 {
            break;
        }
    }
    let world = validate(task, &plan).unwrap();
    let facts = world.facts.iter().map(|fact| read_condition(&fact.to_string()).unwrap());
    let numbers = world
        .numbers
        .iter()
        .map(|(fact, value)| read_condition(&format!("(= {fact} {value})")).unwrap());
    task.problem.goal = Condition::And(facts.chain(numbers).collect());
    plan
}

/// A random order in which a machine of this structure may begin and end its steps.
fn linearise(chance: &mut Chance, structure: &Structure) -> Vec<usize> {
    match structure {
        Structure::Step(step) => vec![*step],
        Structure::Series(parts) => parts.iter().flat_map(|part| linearise(chance, part)).collect(),
        Structure::Parallel(parts) => {
            let mut branches: Vec<_> = parts.iter().map(|part| linearise(chance, part)).collect();
            let mut merged = Vec::new();
            while !branches.is_empty() {
                let at = chance.below(branches.len());
                merged.push(branches[at].remove(0));
                branches.retain(|branch| !branch.is_empty());
            }
            merged
        }
    }
}

#[test]
fn every_linearisation_of_a_machine_is_a_valid_plan() {
    let (mut parallel, mut steps) = (0, 0);
    for seed in 0..400 {
        let chance = &mut Chance(seed);
        let domain = domain(chance);
        let mut task = Task { domain, problem: problem(chance) };
        let plan = walk(chance, &mut task);
        let structure = Structure::of(&Order::of(&task, &plan));
        steps += plan.steps.len();
        for _ in 0..10 {
            let order = linearise(chance, &structure);
            parallel += usize::from(order != (0..plan.steps.len()).collect::<Vec<_>>());
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..plan.steps.len()).collect::<Vec<_>>(), "seed {seed}");
            let mut other = plan.clone();
            other.steps = order.iter().map(|step| plan.steps[*step].clone()).collect();
            #[expect(clippy::cast_precision_loss, reason = "a few steps")]
            other.steps.iter_mut().enumerate().for_each(|(at, step)| step.start = at as f64);
            let verdict = validate(&task, &other);
            assert!(verdict.is_ok(), "seed {seed}, order {order:?}: {}", verdict.unwrap_err());
        }
    }
    assert!(steps > 1000 && parallel > 400, "{steps} steps, {parallel} orders that differ");
}
