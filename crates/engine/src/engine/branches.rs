//! Numbers for branches. A number is used again, but never in the answer in which its branch ended.

use crate::BranchId;

#[derive(Debug, Default)]
pub(super) struct Branches {
    /// The highest number used; branch 0 is that of the root.
    highest: u32,
    free: Vec<BranchId>,
    /// Free after this answer.
    ended: Vec<BranchId>,
}

impl Branches {
    pub(super) fn begin(&mut self) -> BranchId {
        self.free.pop().unwrap_or_else(|| {
            self.highest += 1;
            BranchId(self.highest)
        })
    }

    pub(super) fn end(&mut self, branch: BranchId) {
        self.ended.push(branch);
    }

    /// An answer is complete.
    pub(super) fn settle(&mut self) {
        self.free.extend(self.ended.drain(..).rev());
    }
}
