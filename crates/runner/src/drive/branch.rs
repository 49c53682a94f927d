//! Threads that run scripts. A branch owns one for its life; a thread whose branch ended takes the next branch.

use crate::drive::driver::Driver;
use crate::places::mailbox::Mailbox;
use crate::{Place, Scripts};
use rafcon_engine::{BranchId, Check, Input, Job};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread::{self, JoinHandle};

/// Stack size of a script's thread, for deep recursion. It equals that of a main thread, and only used pages take
/// memory.
const STACK_BYTES: usize = 8 << 20;

/// A piece of work for a branch, and its place.
#[derive(Debug)]
pub(crate) struct BranchTask<D> {
    pub(crate) work: BranchWork<D>,
    pub(crate) place: Arc<Place>,
}

/// The work of a branch's thread.
#[derive(Debug)]
pub(crate) enum BranchWork<D> {
    /// Run the script of a state.
    Script(Job<D>),
    /// Evaluate a breakpoint's condition.
    Condition(Check<D>),
}

impl<D> BranchTask<D> {
    /// The branch that the work belongs to.
    pub(crate) fn branch(&self) -> BranchId {
        match &self.work {
            BranchWork::Script(job) => job.branch,
            BranchWork::Condition(check) => check.branch,
        }
    }
}

/// A message to a thread.
#[derive(Debug)]
pub(crate) enum BranchMessage<D> {
    /// Run this script of the thread's branch, and the scripts that follow it.
    Run(BranchTask<D>),
    /// Look for branches without a thread.
    Seek,
    /// End this thread for good.
    End,
}

/// The shared part of one thread.
#[derive(Debug)]
pub(crate) struct Worker<D> {
    /// Index in the list of active scripts.
    pub(crate) slot: usize,
    pub(crate) mailbox: Mailbox<BranchMessage<D>>,
}

/// Starts a thread that enters the interpreter and seeks a branch at once.
pub(crate) fn start<S: Scripts>(
    driver: &Arc<Driver<S>>,
    slot: usize,
) -> io::Result<JoinHandle<()>> {
    let worker = Arc::new(Worker { slot, mailbox: Mailbox::default() });
    let driver = Arc::clone(driver);
    thread::Builder::new()
        .name("branch".to_owned())
        .stack_size(STACK_BYTES)
        .spawn(move || driver.scripts().inhabit(&mut || live(&driver, &worker)))
}

fn live<S: Scripts>(driver: &Arc<Driver<S>>, worker: &Arc<Worker<S::Value>>) {
    let mut mail = BranchMessage::Seek;
    loop {
        let turn = match mail {
            BranchMessage::Run(turn) => Some(turn),
            BranchMessage::Seek => driver.seek(worker),
            BranchMessage::End => return,
        };
        follow(driver, turn);
        mail = BranchMessage::End;
        driver.scripts().park(&mut || mail = worker.mailbox.wait());
    }
}

/// Does a piece of work and everything that follows it on this thread, without a hand-off.
fn follow<S: Scripts>(driver: &Arc<Driver<S>>, mut next: Option<BranchTask<S::Value>>) {
    while let Some(turn) = next {
        let branch = turn.branch();
        driver.wait_for_safety();
        next = driver.finished(answer(driver.scripts(), turn), branch);
    }
}

/// Does a piece of work. A panic of RAFCON becomes its error.
fn answer<S: Scripts>(scripts: &S, turn: BranchTask<S::Value>) -> Input<S::Value> {
    let BranchTask { work, place } = turn;
    match work {
        BranchWork::Script(job) => {
            let frame = job.frame;
            let result = catch_unwind(AssertUnwindSafe(|| scripts.run(job, &place)));
            let result = result
                .unwrap_or_else(|_panic| scripts.failure(&defect("running the script", &place)));
            Input::Finished { frame, result }
        }
        BranchWork::Condition(check) => {
            let result = catch_unwind(AssertUnwindSafe(|| scripts.check(&check, &place)));
            let result = result
                .unwrap_or_else(|_panic| Err(defect("evaluating a condition", &place).into()));
            Input::Checked { check: check.check, result }
        }
    }
}

fn defect(what: &str, place: &Place) -> String {
    format!(
        "{what} of {} failed inside RAFCON itself; this is a defect of RAFCON, please report it",
        place.text
    )
}
