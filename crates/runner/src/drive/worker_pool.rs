//! Who runs what: threads, the branches that own them, and work that has no thread yet.
//!
//! A new branch's first script waits in a queue. While the queue is not empty, one thread is on its way to it; the thread that
//! takes the first entry sends for the next one before it begins. So a script that blocks never holds up another, and
//! many short ones cost one thread and no hand-off.

use crate::drive::branch::{BranchMessage, BranchTask, Worker};
use crate::places::active::Active;
use rafcon_engine::BranchId;
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

/// The threads of a run. Only the holder of the engine touches it.
#[derive(Debug)]
pub(crate) struct WorkerPool<D> {
    /// The thread that each active branch owns.
    owners: BTreeMap<BranchId, Arc<Worker<D>>>,
    idle: Vec<Arc<Worker<D>>>,
    /// First scripts of branches without a thread.
    ready: VecDeque<BranchTask<D>>,
    /// Threads on their way to `ready`.
    seekers: usize,
    active: Active,
    /// There is nothing more to do, ever.
    dismissed: bool,
}

impl<D> WorkerPool<D> {
    pub(crate) fn new(active: Active) -> Self {
        Self {
            owners: BTreeMap::new(),
            idle: Vec::new(),
            ready: VecDeque::new(),
            seekers: 0,
            active,
            dismissed: false,
        }
    }

    /// Work for another thread than the one that says so.
    pub(crate) fn post(&mut self, turn: BranchTask<D>) {
        match self.owners.get(&turn.branch()) {
            Some(owner) => {
                self.active.begin(owner.slot, &turn.place);
                owner.mailbox.post(BranchMessage::Run(turn));
            }
            None => self.ready.push_back(turn),
        }
    }

    /// The thread of this branch continues with this script of its own.
    pub(crate) fn go_on(&mut self, turn: &BranchTask<D>) {
        if let Some(owner) = self.owners.get(&turn.branch()) {
            self.active.begin(owner.slot, &turn.place);
        }
    }

    /// The thread of this branch runs no script now.
    pub(crate) fn rest(&mut self, branch: BranchId) {
        if let Some(owner) = self.owners.get(&branch) {
            self.active.end(owner.slot);
        }
    }

    /// A branch has nothing more to do; gives its thread back.
    pub(crate) fn end(&mut self, branch: BranchId) -> Option<Arc<Worker<D>>> {
        let worker = self.owners.remove(&branch)?;
        self.active.end(worker.slot);
        Some(worker)
    }

    /// A thread has no branch any more and asks for the next one; without one it is idle from now on.
    pub(crate) fn take(&mut self, worker: Arc<Worker<D>>) -> Option<BranchTask<D>> {
        let Some(turn) = self.ready.pop_front() else {
            self.retire(worker);
            return None;
        };
        self.active.begin(worker.slot, &turn.place);
        self.owners.insert(turn.branch(), worker);
        Some(turn)
    }

    /// A thread that waits for mail has no branch any more.
    pub(crate) fn retire(&mut self, worker: Arc<Worker<D>>) {
        if self.dismissed {
            worker.mailbox.post(BranchMessage::End);
        } else {
            self.idle.push(worker);
        }
    }

    /// A thread that was sent for has come.
    pub(crate) fn arrive(&mut self) {
        self.seekers = self.seekers.saturating_sub(1);
    }

    /// Sends an idle thread to the queue if someone has to go there; true if a new thread has to be made for it.
    pub(crate) fn needs_thread(&mut self) -> bool {
        if self.ready.is_empty() || self.seekers > 0 {
            return false;
        }
        match self.idle.pop() {
            Some(worker) => {
                self.seekers += 1;
                worker.mailbox.post(BranchMessage::Seek);
                false
            }
            None => true,
        }
    }

    /// A new thread is on its way to the queue.
    pub(crate) fn sent(&mut self) {
        self.seekers += 1;
    }

    /// No thread could be made: the work that was waiting for it.
    pub(crate) fn give_up(&mut self) -> Option<BranchTask<D>> {
        self.ready.pop_front()
    }

    /// Ends every thread; one that was sent for and has not come yet ends when it comes.
    pub(crate) fn dismiss(&mut self) {
        self.dismissed = true;
        let owners = std::mem::take(&mut self.owners).into_values();
        for worker in owners.chain(std::mem::take(&mut self.idle)) {
            worker.mailbox.post(BranchMessage::End);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::WorkerPool;
    use crate::drive::branch::{BranchMessage, Worker};
    use crate::places::active::Active;
    use crate::places::mailbox::Mailbox;
    use rafcon_model::Value;
    use std::sync::Arc;

    #[test]
    fn a_thread_that_comes_after_the_end_ends_too() {
        let mut crew = WorkerPool::<Value>::new(Active::default());
        let [early, late] =
            [0, 1].map(|slot| Arc::new(Worker { slot, mailbox: Mailbox::default() }));
        assert!(crew.take(Arc::clone(&early)).is_none());
        crew.sent();
        crew.dismiss();
        crew.arrive();
        assert!(crew.take(Arc::clone(&late)).is_none());
        for worker in [early, late] {
            assert!(matches!(worker.mailbox.wait(), BranchMessage::End));
        }
    }
}
