//! The order in which the steps of a plan must run. Steps that disturb each other keep their order; all others are
//! free. Each linearisation of this order is as good as the plan.

use crate::ground::Touched;
use crate::plan::{Plan, Step};
use crate::task::Task;

/// For each step of a plan, the sorted steps that must end before it begins, directly or indirectly.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Order {
    before: Vec<Vec<usize>>,
}

impl Order {
    /// The order of a valid plan.
    pub fn of(task: &Task, plan: &Plan) -> Self {
        let touched: Vec<Touched> = plan.steps.iter().map(|step| touched(task, step)).collect();
        let mut before: Vec<Vec<usize>> = Vec::with_capacity(touched.len());
        for (later, touch) in touched.iter().enumerate() {
            let mut is_before = vec![false; later];
            for earlier in (0..later).rev() {
                if !is_before[earlier] && touched[earlier].disturbs(touch) {
                    is_before[earlier] = true;
                    before[earlier].iter().for_each(|above| is_before[*above] = true);
                }
            }
            before.push((0..later).filter(|earlier| is_before[*earlier]).collect());
        }
        Self { before }
    }

    /// Creates an order from pairs, for tests of its users.
    #[cfg(test)]
    pub(crate) fn from_pairs(count: usize, pairs: &[(usize, usize)]) -> Self {
        let mut before: Vec<Vec<usize>> = Vec::new();
        for later in 0..count {
            let direct = pairs.iter().filter(|(_, to)| *to == later).map(|(from, _)| *from);
            let mut all: Vec<usize> =
                direct.flat_map(|from| before[from].iter().copied().chain([from])).collect();
            all.sort_unstable();
            all.dedup();
            before.push(all);
        }
        Self { before }
    }

    /// True if `earlier` must end before `later` begins.
    pub fn is_before(&self, earlier: usize, later: usize) -> bool {
        self.before.get(later).is_some_and(|before| before.binary_search(&earlier).is_ok())
    }

    /// The number of steps.
    pub fn len(&self) -> usize {
        self.before.len()
    }

    /// True if the plan has no steps.
    pub fn is_empty(&self) -> bool {
        self.before.is_empty()
    }
}

/// Everything that a step may read or change, from its start to its end.
fn touched(task: &Task, step: &Step) -> Touched {
    let mut touched = Touched::default();
    if let Ok((action, binding)) = task.bind(step) {
        let ground = task.ground();
        action.needs.iter().for_each(|need| ground.touch_condition(need, &binding, &mut touched));
        action
            .effects
            .iter()
            .for_each(|effect| ground.touch_effect(effect, &binding, &mut touched));
    }
    touched
}
