//! Numbers of branches, and which of them go step by step. A number is reused, but never in the call in which its
//! branch ended.

use crate::BranchId;

#[derive(Debug)]
pub(in crate::engine) struct Branches {
    /// True if the branch is held before its next child; `None` for an unused number. Branch 0 is that of the root.
    steps: Vec<Option<bool>>,
    /// Number of branches in step mode.
    stepping: usize,
    free: Vec<BranchId>,
    /// Numbers that become free after this call.
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

    /// Frees the numbers of branches that ended in this call.
    pub(in crate::engine) fn settle(&mut self) {
        self.free.extend(self.ended.drain(..).rev());
    }

    /// True if any branch goes step by step.
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

    /// True if the number is in use.
    pub(in crate::engine) fn has(&self, branch: BranchId) -> bool {
        self.steps.get(branch.index()).is_some_and(Option::is_some)
    }

    /// The number of live branches.
    pub(in crate::engine) fn live(&self) -> usize {
        self.steps.iter().flatten().count()
    }

    /// True if the count of branches in step mode is correct.
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
