//! The threads that run scripts: a branch owns one for its life, and a thread whose branch ended takes the next one.

use crate::driver::Driver;
use crate::mailbox::Mailbox;
use crate::{Place, Scripts};
use rafcon_engine::{Input, Job, ScriptResult};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread::{self, JoinHandle};

/// Room for deep recursion in scripts, the same that a main thread has. Only what is used takes memory.
const STACK_BYTES: usize = 8 << 20;

/// One script to run, and where.
#[derive(Debug)]
pub(crate) struct Turn<D> {
    pub(crate) job: Job<D>,
    pub(crate) place: Arc<Place>,
}

/// What a thread is told.
#[derive(Debug)]
pub(crate) enum Mail<D> {
    /// Run this script of your branch, and what follows it.
    Run(Turn<D>),
    /// Branches without a thread may be waiting.
    Seek,
    /// There is nothing more to do, ever.
    End,
}

/// One thread, as others see it.
#[derive(Debug)]
pub(crate) struct Worker<D> {
    /// Its place in the list of active scripts.
    pub(crate) slot: usize,
    pub(crate) mailbox: Mailbox<Mail<D>>,
}

/// Starts a thread that lives in the interpreter and looks for a branch at once.
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
    let mut mail = Mail::Seek;
    loop {
        let turn = match mail {
            Mail::Run(turn) => Some(turn),
            Mail::Seek => driver.seek(worker),
            Mail::End => return,
        };
        follow(driver, turn);
        mail = Mail::End;
        driver.scripts().park(&mut || mail = worker.mailbox.wait());
    }
}

/// Runs a script and every one that follows it: no hand-off on the way.
fn follow<S: Scripts>(driver: &Arc<Driver<S>>, mut next: Option<Turn<S::Value>>) {
    while let Some(turn) = next {
        let (frame, branch) = (turn.job.frame, turn.job.branch);
        let result = run(driver.scripts(), turn);
        next = driver.finished(Input::Finished { frame, result }, branch);
    }
}

fn run<S: Scripts>(scripts: &S, turn: Turn<S::Value>) -> ScriptResult<S::Value> {
    let Turn { job, place } = turn;
    catch_unwind(AssertUnwindSafe(|| scripts.run(job, &place))).unwrap_or_else(|_panic| {
        scripts.failure(&format!(
            "running the script of {} failed inside RAFCON itself; this is a defect of RAFCON, please report it",
            place.text
        ))
    })
}
