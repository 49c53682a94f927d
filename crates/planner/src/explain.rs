//! Why a step is in a plan: what it needs and who brought it, what it brings and who needs it.

use crate::ground::{Binding, Changes, Fact, Touched};
use crate::plan::Plan;
use crate::task::Task;
use std::collections::BTreeMap;

/// A fact that a step needs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Need {
    /// What.
    pub fact: Fact,
    /// The step that brought it; `None`: it was there from the beginning.
    pub from: Option<usize>,
}

/// A fact that a step brings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Gain {
    /// What.
    pub fact: Fact,
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
    let mut brought: BTreeMap<Fact, usize> = BTreeMap::new();
    for (index, step) in plan.steps.iter().enumerate() {
        reasons.push(Reason::default());
        let Ok((action, binding)) = task.bind(step) else { continue };
        let mut touched = Touched::default();
        action.needs.iter().for_each(|need| ground.touch_condition(need, &binding, &mut touched));
        for fact in touched.reads.into_iter().filter(|fact| world.facts.contains(fact)) {
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
            for fact in &changes.adds {
                if !world.facts.contains(fact) {
                    brought.insert(fact.clone(), index);
                }
            }
            world.apply(&changes);
        }
    }
    let mut wanted = Touched::default();
    ground.touch_condition(&task.problem.goal, &Binding::default(), &mut wanted);
    for fact in wanted.reads.into_iter().filter(|fact| world.facts.contains(fact)) {
        if let Some(from) = brought.get(&fact) {
            note(&mut reasons[*from], &fact, |gain| gain.goal = true);
        }
    }
    reasons
}

fn note(reason: &mut Reason, fact: &Fact, change: impl FnOnce(&mut Gain)) {
    let at = reason.brings.iter().position(|gain| gain.fact == *fact);
    let at = at.unwrap_or_else(|| {
        reason.brings.push(Gain { fact: fact.clone(), steps: Vec::new(), goal: false });
        reason.brings.len() - 1
    });
    change(&mut reason.brings[at]);
}
