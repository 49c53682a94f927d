//! Which steps of a plan must come before which: those that disturb each other keep their order, all others are free. Then any
//! order that keeps these is as good as the plan.

use crate::ground::Touched;
use crate::plan::{Plan, Step};
use crate::task::Task;

/// For each step of a plan those that must end before it begins, sorted; not only the direct ones.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Order {
    before: Vec<Vec<usize>>,
}

impl Order {
    /// The order of a plan that is valid.
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

    /// An order from pairs, for tests of what is made of it.
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

    /// Whether one must end before the other begins.
    pub fn is_before(&self, earlier: usize, later: usize) -> bool {
        self.before.get(later).is_some_and(|before| before.binary_search(&earlier).is_ok())
    }

    /// How many steps there are.
    pub fn len(&self) -> usize {
        self.before.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.before.is_empty()
    }
}

/// All that a step may look at or change, from its start to its end.
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
