//! Why a step is in a plan: what it needs and who brought it, what it brings and who needs it.

use crate::ground::{Binding, Changes, Literal};
use crate::plan::Plan;
use crate::task::Task;
use std::collections::{BTreeMap, BTreeSet};

/// What a step needs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Need {
    /// What holds, or must not hold.
    pub fact: Literal,
    /// The step that brought it; `None`: it was there from the beginning.
    pub from: Option<usize>,
}

/// What a step brings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Gain {
    /// What holds, or must not hold.
    pub fact: Literal,
    /// The steps that need it.
    pub steps: Vec<usize>,
    /// Whether the goal does.
    pub goal: bool,
}

/// Why a step is there.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Reason {
    /// What it needs.
    pub needs: Vec<Need>,
    /// What it brings that is needed.
    pub brings: Vec<Gain>,
}

/// The reason of each step of a valid plan, in its order.
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
            ground.ask((need, true), &binding, &world, &mut asked);
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
            // What has no value stays out of an explanation; the validator has had its say.
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
    ground.ask((&task.problem.goal, true), &Binding::default(), &world, &mut wanted);
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
