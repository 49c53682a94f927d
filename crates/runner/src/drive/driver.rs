//! Drives an engine with threads. Every input takes one lock, under which its effects are carried out. A branch's next
//! script continues on the thread that finished the last one.

use crate::drive::branch::{self, BranchWork, Worker};
use crate::drive::core::{Core, InputOutcome, Next};
use crate::drive::document::Document;
use crate::drive::ending::{Ending, RunEnd};
use crate::drive::error::CommandError;
use crate::drive::ground::Ground;
use crate::drive::points::Points;
use crate::drive::pulse::Pulse;
use crate::drive::questions::Questions;
use crate::drive::record_events::ExtraRecords;
use crate::drive::roots::Roots;
use crate::places::active::Active;
use crate::places::timers::Timers;
use crate::record::recorder::Recorder;
use crate::record::run_record::RunRecord;
use crate::record::tell;
use crate::{Clock, Places, Scripts};
use rafcon_engine::{BranchId, Input, Program, Refusal};
use rafcon_locks::Mutex;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// A run in progress.
#[derive(Debug)]
pub struct Driver<S: Scripts> {
    scripts: S,
    document: Document<S::Value>,
    places: Arc<Places>,
    record: RunRecord,
    core: Mutex<Core<S::Value>>,
    questions: Questions,
    points: Points,
    timers: Timers,
    pulse: Pulse,
    ground: Ground,
    /// True if the journal paused the run, false if a command did.
    journal_pauses: Mutex<bool>,
    /// True if placeholders for lost values may exist, so that the inputs of scripts must be checked.
    any_lost: AtomicBool,
    roots: Roots,
    ending: Ending<S::Value>,
}

impl<S: Scripts> Driver<S> {
    /// A run that has not begun.
    pub(crate) fn new(
        document: Document<S::Value>,
        scripts: S,
        clock: Clock,
        active: Active,
        recorder: Recorder,
    ) -> Arc<Self> {
        let places = Arc::new(Places::default());
        let mut core = Core::new(document.program(), Arc::clone(&places), active);
        core.numbering = recorder.names().numbering();
        let timers = Timers::default();
        timers.adopt(&document.program());
        Arc::new(Self {
            scripts,
            document,
            places,
            record: RunRecord::new(recorder, clock),
            core: Mutex::new(core),
            questions: Questions::default(),
            points: Points::default(),
            timers,
            pulse: Pulse::default(),
            ground: Ground::default(),
            journal_pauses: Mutex::new(false),
            any_lost: AtomicBool::new(false),
            roots: Roots::default(),
            ending: Ending::default(),
        })
    }

    /// The host of the scripts.
    pub fn scripts(&self) -> &S {
        &self.scripts
    }

    /// The program that currently runs.
    pub fn program(&self) -> Arc<Program<S::Value>> {
        self.document.program()
    }

    pub(crate) fn document(&self) -> &Document<S::Value> {
        &self.document
    }

    /// The places reached until now.
    pub fn places(&self) -> &Arc<Places> {
        &self.places
    }

    pub(crate) fn questions(&self) -> &Questions {
        &self.questions
    }

    pub(crate) fn timers(&self) -> &Timers {
        &self.timers
    }

    pub(crate) fn record(&self) -> &RunRecord {
        &self.record
    }

    pub(crate) fn ending(&self) -> &Ending<S::Value> {
        &self.ending
    }

    pub(crate) fn points(&self) -> &Points {
        &self.points
    }

    pub(crate) fn ground(&self) -> &Ground {
        &self.ground
    }

    pub(crate) fn pulse(&self) -> &Pulse {
        &self.pulse
    }

    /// True if the run is paused because its journal could not be written. Lock it to pause the run or let it continue.
    pub(crate) fn journal_pauses(&self) -> &Mutex<bool> {
        &self.journal_pauses
    }

    pub(crate) fn roots(&self) -> &Roots {
        &self.roots
    }

    pub(crate) fn recorder(&self) -> &Arc<Recorder> {
        self.record.recorder()
    }

    pub(crate) fn clock(&self) -> Clock {
        self.record.clock()
    }

    /// Passes an input from outside the branches to the engine.
    pub fn command(self: &Arc<Self>, input: Input<S::Value>) -> Result<(), Refusal> {
        if matches!(input, Input::Stop) {
            // The holder of the engine may be waiting for a failing disk.
            self.record.recorder().safety().end();
        }
        self.submit(input, None).map(drop)
    }

    /// Passes the result of a script to the engine. Returns the next work of its branch, if any.
    pub(crate) fn finished(
        self: &Arc<Self>,
        input: Input<S::Value>,
        branch: BranchId,
    ) -> Next<S::Value> {
        self.submit(input, Some(branch)).unwrap_or_else(|refusal| {
            self.record.note([tell::defect(&refusal.to_string())]);
            None
        })
    }

    /// Accesses the engine without an input, if its lock is free before a deadline. Called outside the interpreter.
    pub(crate) fn try_core<T>(
        &self,
        until: Instant,
        act: impl FnOnce(&mut Core<S::Value>) -> T,
    ) -> Option<T> {
        let mut core = self.core.try_lock_until(until)?;
        Some(act(&mut core))
    }

    /// Accesses the engine without an input.
    pub(crate) fn with_core<T: Send>(
        &self,
        act: impl FnOnce(&mut Core<S::Value>) -> T + Send,
    ) -> Option<T> {
        if let Some(mut core) = self.core.try_lock() {
            return Some(act(&mut core));
        }
        let (mut act, mut done) = (Some(act), None);
        self.scripts.park(&mut || done = act.take().map(|act| act(&mut self.core.lock())));
        done
    }

    /// Waits for the end of the run.
    pub(crate) fn wait(&self) -> Option<RunEnd<S::Value>> {
        let mut end = None;
        self.scripts.park(&mut || end = self.ending.wait());
        end
    }

    /// Ends all threads of a finished run.
    pub(crate) fn close(&self) {
        let mut threads = Vec::new();
        self.scripts.park(&mut || {
            let mut core = self.core.lock();
            core.worker_pool.dismiss();
            threads = std::mem::take(&mut core.threads);
            drop(core);
            for thread in threads.drain(..) {
                if thread.join().is_err() {
                    self.record.note([tell::defect("a branch's thread panicked")]);
                }
            }
        });
        self.scripts.settle();
    }

    fn submit(
        self: &Arc<Self>,
        input: Input<S::Value>,
        own: Option<BranchId>,
    ) -> Result<Next<S::Value>, Refusal> {
        let answer = match self.core.try_lock() {
            Some(mut core) => self.drive(&mut core, input, own),
            None => self.submit_parked(input, own),
        };
        self.scripts.settle();
        answer
    }

    /// Leaves the interpreter before it waits for the lock, because the lock's holder may need the interpreter.
    fn submit_parked(
        self: &Arc<Self>,
        input: Input<S::Value>,
        own: Option<BranchId>,
    ) -> Result<Next<S::Value>, Refusal> {
        let (mut input, mut answer) = (Some(input), Ok(None));
        self.scripts.park(&mut || {
            if let Some(input) = input.take() {
                answer = self.drive(&mut self.core.lock(), input, own);
            }
        });
        answer
    }

    /// Passes an input from outside the branches to the engine, unless `late` returns true. If the engine accepts it,
    /// `then` runs before any effect. The records that `then` returns are kept with the events of the input, or not at
    /// all.
    pub(crate) fn input_beside(
        self: &Arc<Self>,
        input: Input<S::Value>,
        late: impl FnOnce() -> bool + Send,
        then: impl FnOnce() -> ExtraRecords + Send,
    ) -> Result<(), CommandError> {
        if matches!(input, Input::Stop) {
            // The holder of the engine may be waiting for a failing disk.
            self.record.recorder().safety().end();
        }
        let take = |core: &mut Core<S::Value>| {
            if late() {
                return Err(CommandError::Late);
            }
            let driven = self.drive_beside(core, input, None, then);
            driven.map(drop).map_err(CommandError::Engine)
        };
        let taken = self.with_core(take);
        self.scripts.settle();
        taken.unwrap_or(Err(CommandError::Unreachable))
    }

    pub(crate) fn has_lost_values(&self) -> bool {
        self.any_lost.load(Ordering::Relaxed)
    }

    /// Notes that placeholders for lost values exist, if `any` is true.
    pub(crate) fn note_lost_values(&self, any: bool) {
        self.any_lost.fetch_or(any, Ordering::Relaxed);
    }

    pub(crate) fn drive(
        self: &Arc<Self>,
        core: &mut Core<S::Value>,
        input: Input<S::Value>,
        own: Option<BranchId>,
    ) -> Result<Next<S::Value>, Refusal> {
        self.drive_beside(core, input, own, ExtraRecords::default)
    }

    fn drive_beside(
        self: &Arc<Self>,
        core: &mut Core<S::Value>,
        input: Input<S::Value>,
        own: Option<BranchId>,
        then: impl FnOnce() -> ExtraRecords,
    ) -> Result<Next<S::Value>, Refusal> {
        if core.is_broken {
            return Err(Refusal::Broken);
        }
        let drive = || -> Result<Next<S::Value>, Refusal> {
            let mut turn = InputOutcome::of(own);
            core.engine.handle(input, self.scripts.globals(), &mut core.outbox)?;
            self.carry_out(core, &mut turn, then());
            self.answer_pending(core, &mut turn)?;
            let next = core.settle(turn);
            self.staff(core);
            Ok(next)
        };
        catch_unwind(AssertUnwindSafe(drive)).unwrap_or_else(|_panic| Err(self.breaks(core)))
    }

    /// Handles a panic of the engine or of an effect. The engine may be partly changed, so it accepts no further input.
    /// The run ends with its process, as after any crash.
    fn breaks(&self, core: &mut Core<S::Value>) -> Refusal {
        core.is_broken = true;
        let what = "the engine failed; the process of this run ends, and it can be resumed";
        self.record.note([tell::defect(what)]);
        self.ending.decide(RunEnd::Broken);
        Refusal::Broken
    }

    /// Starts threads for branches that have none, and passes results for scripts that got no thread.
    fn staff(self: &Arc<Self>, core: &mut Core<S::Value>) {
        self.recruit(core);
        while !core.pending.is_empty() {
            let mut outside = InputOutcome::of(None);
            if let Err(refusal) = self.answer_pending(core, &mut outside) {
                self.record.note([tell::defect(&refusal.to_string())]);
            }
            self.recruit(core);
        }
    }

    /// Passes the results for scripts that could not run to the engine.
    fn answer_pending(
        self: &Arc<Self>,
        core: &mut Core<S::Value>,
        turn: &mut InputOutcome<S::Value>,
    ) -> Result<(), Refusal> {
        while let Some(input) = core.pending.pop_front() {
            core.engine.handle(input, self.scripts.globals(), &mut core.outbox)?;
            self.carry_out(core, turn, ExtraRecords::default());
        }
        Ok(())
    }

    fn recruit(self: &Arc<Self>, core: &mut Core<S::Value>) {
        while core.worker_pool.needs_thread() {
            match branch::start(self, core.threads.len()) {
                Ok(thread) => {
                    core.threads.push(thread);
                    core.worker_pool.sent();
                }
                Err(error) => self.give_up(core, &error),
            }
        }
    }

    fn give_up(&self, core: &mut Core<S::Value>, error: &std::io::Error) {
        let Some(turn) = core.worker_pool.give_up() else { return };
        let reason = format!(
            "the system gave no thread for this branch ({error}); let fewer states run side by side"
        );
        core.pending.push_back(match turn.work {
            BranchWork::Script(job) => {
                Input::Finished { frame: job.frame, result: self.scripts.failure(&reason) }
            }
            BranchWork::Condition(check) => {
                Input::Checked { check: check.check, result: Err(reason.into()) }
            }
        });
    }

    /// The next branch without a thread, for a thread that was sent for it. Without such a branch, the thread is idle.
    pub(crate) fn seek(self: &Arc<Self>, worker: &Arc<Worker<S::Value>>) -> Next<S::Value> {
        let seek = |core: &mut Core<S::Value>| {
            core.worker_pool.arrive();
            let turn = core.worker_pool.take(Arc::clone(worker));
            self.staff(core);
            turn
        };
        self.with_core(seek).flatten()
    }
}
