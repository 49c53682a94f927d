//! A pool of threads: the branches that own them, and tasks that have no thread yet.
//!
//! The first task of a new branch waits in a queue. While the queue is not empty, one thread is on its way to it. A
//! thread that takes an entry sends for the next thread before it begins. So a blocking script never delays another,
//! and many short ones need only one thread and no hand-off.

use crate::drive::branch::{BranchMessage, BranchTask, Worker};
use crate::places::active::Active;
use rafcon_engine::BranchId;
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

/// The threads of a run. Only the holder of the engine accesses it.
#[derive(Debug)]
pub(crate) struct WorkerPool<D> {
    /// The thread that each active branch owns.
    owners: BTreeMap<BranchId, Arc<Worker<D>>>,
    idle: Vec<Arc<Worker<D>>>,
    /// First tasks of branches without a thread.
    ready: VecDeque<BranchTask<D>>,
    /// Number of threads on their way to `ready`.
    seekers: usize,
    active: Active,
    /// True if all threads must end.
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

    /// Queues a task for another thread than the current one.
    pub(crate) fn post(&mut self, task: BranchTask<D>) {
        match self.owners.get(&task.branch()) {
            Some(owner) => {
                self.active.begin(owner.slot, &task.place);
                owner.mailbox.post(BranchMessage::Run(task));
            }
            None => self.ready.push_back(task),
        }
    }

    /// Marks the next script of this branch as active on the branch's own thread.
    pub(crate) fn go_on(&mut self, task: &BranchTask<D>) {
        if let Some(owner) = self.owners.get(&task.branch()) {
            self.active.begin(owner.slot, &task.place);
        }
    }

    /// Marks that the thread of this branch runs no script.
    pub(crate) fn rest(&mut self, branch: BranchId) {
        if let Some(owner) = self.owners.get(&branch) {
            self.active.end(owner.slot);
        }
    }

    /// Ends a branch and returns its thread.
    pub(crate) fn end(&mut self, branch: BranchId) -> Option<Arc<Worker<D>>> {
        let worker = self.owners.remove(&branch)?;
        self.active.end(worker.slot);
        Some(worker)
    }

    /// Gives a free thread the next queued task. Without one, the thread becomes idle.
    pub(crate) fn take(&mut self, worker: Arc<Worker<D>>) -> Option<BranchTask<D>> {
        let Some(task) = self.ready.pop_front() else {
            self.retire(worker);
            return None;
        };
        self.active.begin(worker.slot, &task.place);
        self.owners.insert(task.branch(), worker);
        Some(task)
    }

    /// Makes a waiting thread idle, or ends it if the pool is dismissed.
    pub(crate) fn retire(&mut self, worker: Arc<Worker<D>>) {
        if self.dismissed {
            worker.mailbox.post(BranchMessage::End);
        } else {
            self.idle.push(worker);
        }
    }

    /// Counts the arrival of a thread at the queue.
    pub(crate) fn arrive(&mut self) {
        self.seekers = self.seekers.saturating_sub(1);
    }

    /// Sends an idle thread to the queue if one is needed. Returns true if a new thread must be started instead.
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

    /// Counts a new thread on its way to the queue.
    pub(crate) fn sent(&mut self) {
        self.seekers += 1;
    }

    /// Takes the task of a thread that could not be started.
    pub(crate) fn give_up(&mut self) -> Option<BranchTask<D>> {
        self.ready.pop_front()
    }

    /// Ends all threads. A thread on its way to the queue ends on arrival.
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
        let mut pool = WorkerPool::<Value>::new(Active::default());
        let [early, late] =
            [0, 1].map(|slot| Arc::new(Worker { slot, mailbox: Mailbox::default() }));
        assert!(pool.take(Arc::clone(&early)).is_none());
        pool.sent();
        pool.dismiss();
        pool.arrive();
        assert!(pool.take(Arc::clone(&late)).is_none());
        for worker in [early, late] {
            assert!(matches!(worker.mailbox.wait(), BranchMessage::End));
        }
    }
}
