//! Numbers for branches, and which of them go step by step. A number is used again, but never in the answer in which its
//! branch ended.

use crate::BranchId;

#[derive(Debug)]
pub(in crate::engine) struct Branches {
    /// Whether each branch is held before its next child; `None` for a number that is not in use. Branch 0 is that of the
    /// root.
    steps: Vec<Option<bool>>,
    /// How many branches go step by step.
    stepping: usize,
    free: Vec<BranchId>,
    /// Free after this answer.
    ended: Vec<BranchId>,
}

impl Branches {
    pub(in crate::engine) fn new() -> Self {
        Self { steps: vec![Some(false)], stepping: 0, free: Vec::new(), ended: Vec::new() }
    }

    pub(in crate::engine) fn begin(&mut self, steps: bool) -> BranchId {
        let branch = self.free.pop().unwrap_or_else(|| {
            self.steps.push(None);
            BranchId(u32::try_from(self.steps.len() - 1).unwrap_or(u32::MAX))
        });
        self.write(branch, Some(steps));
        branch
    }

    pub(in crate::engine) fn end(&mut self, branch: BranchId) {
        self.write(branch, None);
        self.ended.push(branch);
    }

    /// An answer is complete.
    pub(in crate::engine) fn settle(&mut self) {
        self.free.extend(self.ended.drain(..).rev());
    }

    /// Whether any branch goes step by step.
    pub(in crate::engine) fn any_steps(&self) -> bool {
        self.stepping > 0
    }

    pub(in crate::engine) fn steps(&self, branch: BranchId) -> bool {
        self.steps.get(branch.index()).copied().flatten().unwrap_or_default()
    }

    pub(in crate::engine) fn set(&mut self, branch: BranchId, steps: bool) {
        if self.has(branch) {
            self.write(branch, Some(steps));
        }
    }

    pub(in crate::engine) fn set_all(&mut self, steps: bool) {
        self.steps.iter_mut().flatten().for_each(|branch| *branch = steps);
        let live = self.steps.iter().flatten().count();
        self.stepping = if steps { live } else { 0 };
    }

    /// Whether a number is in use.
    pub(in crate::engine) fn has(&self, branch: BranchId) -> bool {
        self.steps.get(branch.index()).is_some_and(Option::is_some)
    }

    /// How many there are.
    pub(in crate::engine) fn live(&self) -> usize {
        self.steps.iter().flatten().count()
    }

    /// Whether those that go step by step are counted rightly.
    pub(in crate::engine) fn counts(&self) -> bool {
        self.steps.iter().flatten().filter(|steps| **steps).count() == self.stepping
    }

    fn write(&mut self, branch: BranchId, steps: Option<bool>) {
        let Some(place) = self.steps.get_mut(branch.index()) else { return };
        self.stepping -= usize::from(*place == Some(true));
        self.stepping += usize::from(steps == Some(true));
        *place = steps;
    }
}
