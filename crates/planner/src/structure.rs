//! The sequential and parallel parts of a plan, as a tree. The tree keeps the exact order of steps where that consists
//! of series and parallels. Elsewhere it runs level by level, which keeps the order but takes more time.

use crate::order::Order;
use crate::plan::{Plan, Step};
use crate::task::Task;
use crate::validate::{Invalid, validate};

/// Limit of the tree's depth. Deeper parts run level by level, because nobody reads them.
const DEPTH_MAX: usize = 20;

/// Steps in sequence or in parallel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Structure {
    /// One step, by its index in the plan.
    Step(usize),
    /// Parts in sequence, without overlap.
    Series(Vec<Self>),
    /// Parts in parallel; all must end.
    Parallel(Vec<Self>),
}

impl Structure {
    /// A sequence of all steps.
    pub fn chain(count: usize) -> Self {
        Self::Series((0..count).map(Self::Step).collect())
    }

    /// The most parallel tree that the order allows.
    pub fn of(order: &Order) -> Self {
        let steps: Vec<usize> = (0..order.len()).collect();
        match decompose(order, &steps, 0) {
            Self::Step(step) => Self::Series(vec![Self::Step(step)]),
            other => other,
        }
    }

    /// The total time, if each step takes its planned duration.
    pub fn makespan(&self, plan: &Plan) -> f64 {
        match self {
            Self::Step(step) => {
                plan.steps.get(*step).and_then(|step| step.duration).unwrap_or_default()
            }
            Self::Series(parts) => parts.iter().map(|part| part.makespan(plan)).sum(),
            Self::Parallel(parts) => {
                parts.iter().map(|part| part.makespan(plan)).fold(0.0, f64::max)
            }
        }
    }

    /// The additional time compared with the plan.
    pub fn lost(&self, plan: &Plan) -> f64 {
        let first = plan.steps.iter().map(|step| step.start).fold(f64::INFINITY, f64::min);
        let planned = plan.steps.iter().map(Step::end).fold(0.0, f64::max) - first.min(1e12);
        if plan.temporal { (self.makespan(plan) - planned).max(0.0) } else { 0.0 }
    }

    /// Checks that a machine with this structure does what the plan does. The check fails if steps must overlap in
    /// time, which a machine cannot guarantee. One linearisation represents all, because disturbing steps keep their
    /// order.
    pub fn check(&self, task: &Task, plan: &Plan) -> Result<(), Invalid> {
        let mut time = 0.0;
        let order = self.steps();
        let steps = order.iter().filter_map(|index| plan.steps.get(*index)).map(|step| {
            let step = Step { start: time, ..step.clone() };
            time = step.end() + 1.0;
            step
        });
        let sequence = Plan { steps: steps.collect(), temporal: plan.temporal, cost: None };
        let checked = validate(task, &sequence);
        checked.map(drop).map_err(|invalid| Invalid {
            step: invalid.step.and_then(|at| order.get(at).copied()),
            ..invalid
        })
    }

    /// All steps, in an order that the structure allows.
    pub fn steps(&self) -> Vec<usize> {
        match self {
            Self::Step(step) => vec![*step],
            Self::Series(parts) | Self::Parallel(parts) => {
                parts.iter().flat_map(Self::steps).collect()
            }
        }
    }
}

fn decompose(order: &Order, steps: &[usize], depth: usize) -> Structure {
    if let [one] = steps {
        return Structure::Step(*one);
    }
    if depth >= DEPTH_MAX {
        return levels(order, steps);
    }
    let related = |a: usize, b: usize| order.is_before(a.min(b), a.max(b));
    let parallel = components(steps, related);
    if parallel.len() > 1 {
        return Structure::Parallel(
            parallel.iter().map(|part| decompose(order, part, depth + 1)).collect(),
        );
    }
    // Each pair of steps in different parts is ordered. The lowest index comes first, because an order never points
    // backwards.
    let series = components(steps, |a, b| !related(a, b));
    if series.len() > 1 {
        return Structure::Series(
            series.iter().map(|part| decompose(order, part, depth + 1)).collect(),
        );
    }
    levels(order, steps)
}

/// The connected components, each sorted, by their first members.
fn components(steps: &[usize], linked: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    let mut left: Vec<usize> = steps.to_vec();
    let mut groups = Vec::new();
    while let Some(first) = left.first().copied() {
        left.remove(0);
        let mut group = vec![first];
        let mut at = 0;
        while let Some(member) = group.get(at).copied() {
            at += 1;
            left.retain(|other| {
                let is_linked = linked(member, *other);
                if is_linked {
                    group.push(*other);
                }
                !is_linked
            });
        }
        group.sort_unstable();
        groups.push(group);
    }
    groups
}

/// Puts each step on the earliest level that its predecessors allow.
fn levels(order: &Order, steps: &[usize]) -> Structure {
    let mut levels: Vec<Vec<usize>> = Vec::new();
    let mut level_of: Vec<(usize, usize)> = Vec::new();
    for step in steps {
        let before = level_of.iter().filter(|(other, _)| order.is_before(*other, *step));
        let level = before.map(|(_, level)| level + 1).max().unwrap_or_default();
        level_of.push((*step, level));
        if levels.len() <= level {
            levels.push(Vec::new());
        }
        levels[level].push(*step);
    }
    let level = |steps: Vec<usize>| match steps.as_slice() {
        [one] => Structure::Step(*one),
        several => Structure::Parallel(several.iter().copied().map(Structure::Step).collect()),
    };
    Structure::Series(levels.into_iter().map(level).collect())
}
