//! The reason for each step of a plan: the facts that it needs and their sources, the facts that it brings and their
//! users.

use crate::ground::{Binding, Changes, Expected, Literal};
use crate::plan::Plan;
use crate::task::Task;
use std::collections::{BTreeMap, BTreeSet};

/// A fact that a step needs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Need {
    /// The fact, or its negation.
    pub fact: Literal,
    /// The step that brought the fact; `None` if it holds from the beginning.
    pub from: Option<usize>,
}

/// A fact that a step brings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Gain {
    /// The fact, or its negation.
    pub fact: Literal,
    /// Later steps that need the fact.
    pub steps: Vec<usize>,
    /// True if the goal needs the fact.
    pub goal: bool,
}

/// The reason why a step is in a plan.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Reason {
    /// Facts that the step needs.
    pub needs: Vec<Need>,
    /// Needed facts that the step brings.
    pub brings: Vec<Gain>,
}

/// Returns the reason for each step of a valid plan, in plan order.
pub fn explain(task: &Task, plan: &Plan) -> Vec<Reason> {
    let ground = task.ground();
    let mut world = task.world();
    let mut reasons: Vec<Reason> = Vec::with_capacity(plan.steps.len());
    let mut brought: BTreeMap<Literal, usize> = BTreeMap::new();
    for (index, step) in plan.steps.iter().enumerate() {
        reasons.push(Reason::default());
        let Ok((action, binding)) = task.bind(step) else { continue };
        let mut asked = BTreeSet::new();
        for need in &action.needs {
            ground.ask(Expected::holds(need), &binding, &world, &mut asked);
        }
        for fact in asked {
            let from = brought.get(&fact).copied();
            if let Some(from) = from {
                note(&mut reasons[from], &fact, |gain| gain.steps.push(index));
            }
            reasons[index].needs.push(Need { fact, from });
        }
        for effect in &action.effects {
            let mut changes = Changes::default();
            // An explanation omits numbers without a value; the validator reports them.
            let _missing = ground.changes(effect, &binding, &world, &mut changes);
            let changed = changes.adds.iter().chain(&changes.deletes).cloned();
            let before: Vec<_> =
                changed.map(|fact| Literal { holds: world.facts.contains(&fact), fact }).collect();
            world.apply(&changes);
            for Literal { fact, holds } in before {
                if world.facts.contains(&fact) != holds {
                    brought.insert(Literal { fact, holds: !holds }, index);
                }
            }
        }
    }
    let mut wanted = BTreeSet::new();
    ground.ask(Expected::holds(&task.problem.goal), &Binding::default(), &world, &mut wanted);
    for fact in wanted {
        if let Some(from) = brought.get(&fact) {
            note(&mut reasons[*from], &fact, |gain| gain.goal = true);
        }
    }
    reasons
}

fn note(reason: &mut Reason, fact: &Literal, change: impl FnOnce(&mut Gain)) {
    let at = reason.brings.iter().position(|gain| gain.fact == *fact);
    let at = at.unwrap_or_else(|| {
        reason.brings.push(Gain { fact: fact.clone(), steps: Vec::new(), goal: false });
        reason.brings.len() - 1
    });
    change(&mut reason.brings[at]);
}
