//! Drives an engine with threads: every input goes through one lock, effects are carried out under it, and a branch's next
//! script goes on inline on the thread that finished the last one.

use crate::active::Active;
use crate::branch::{self, Turn, Worker};
use crate::crew::Crew;
use crate::recorder::{Record, Recorder};
use crate::signals::{PAUSED, PREEMPTED, STARTED};
use crate::{Clock, Place, Places, Scripts, tell};
use parking_lot::{Condvar, Mutex};
use rafcon_engine::{
    BranchId, Datum, Effect, Engine, Event, Finish, Input, Job, NodeId, Outbox, PathId, Program,
    Refusal, ScriptResult,
};
use rafcon_model::OutcomeId;
use std::collections::VecDeque;
use std::sync::Arc;
use std::thread::JoinHandle;

/// A run in progress.
#[derive(Debug)]
pub struct Driver<S: Scripts> {
    scripts: S,
    program: Arc<Program<S::Value>>,
    places: Arc<Places>,
    recorder: Arc<Recorder>,
    clock: Clock,
    core: Mutex<Core<S::Value>>,
    end: Mutex<Option<Finish<S::Value>>>,
    ended: Condvar,
}

/// What only the holder of the lock touches.
#[derive(Debug)]
pub(crate) struct Core<D> {
    pub(crate) engine: Engine<D>,
    outbox: Outbox<D>,
    /// Answers for scripts that could not be run.
    pending: VecDeque<(rafcon_engine::FrameId, ScriptResult<D>)>,
    known: Vec<Option<Arc<Place>>>,
    crew: Crew<D>,
    threads: Vec<JoinHandle<()>>,
    /// The flags of every place that no script has been asked to end at.
    flags: u8,
}

/// What one input came to, for the thread that gave it.
type Next<D> = Option<Turn<D>>;

/// What an input comes to, for the thread that gives it.
struct Turning<D> {
    /// The thread's branch; none for a command from outside.
    own: Option<BranchId>,
    /// The next script of that branch.
    next: Next<D>,
    /// The thread itself, if that branch has ended.
    freed: Option<Arc<Worker<D>>>,
}

impl<S: Scripts> Driver<S> {
    /// A run that has not begun.
    pub(crate) fn new(
        program: Arc<Program<S::Value>>,
        scripts: S,
        clock: Clock,
        active: Active,
    ) -> Arc<Self> {
        let core = Core {
            engine: Engine::new(Arc::clone(&program)),
            outbox: Outbox::default(),
            pending: VecDeque::new(),
            known: Vec::new(),
            crew: Crew::new(active),
            threads: Vec::new(),
            flags: 0,
        };
        Arc::new(Self {
            scripts,
            program,
            places: Arc::default(),
            recorder: Arc::default(),
            clock,
            core: Mutex::new(core),
            end: Mutex::new(None),
            ended: Condvar::new(),
        })
    }

    /// The host of the scripts.
    pub fn scripts(&self) -> &S {
        &self.scripts
    }

    /// What is run.
    pub fn program(&self) -> &Arc<Program<S::Value>> {
        &self.program
    }

    /// The places met so far.
    pub fn places(&self) -> &Arc<Places> {
        &self.places
    }

    pub(crate) fn recorder(&self) -> &Arc<Recorder> {
        &self.recorder
    }

    pub(crate) fn clock(&self) -> Clock {
        self.clock
    }

    /// Gives the engine an input from outside its branches.
    pub fn command(self: &Arc<Self>, input: Input<S::Value>) -> Result<(), Refusal> {
        self.submit(input, None).map(drop)
    }

    /// Gives the engine the end of a script; the answer is the next script of the same branch, if there is one now.
    pub(crate) fn finished(
        self: &Arc<Self>,
        input: Input<S::Value>,
        branch: BranchId,
    ) -> Next<S::Value> {
        self.submit(input, Some(branch)).unwrap_or_else(|refusal| {
            self.recorder.push(self.clock.now_ns(), [tell::defect(&refusal.to_string())]);
            None
        })
    }

    /// Does something with the engine that gives it no input.
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
    pub(crate) fn wait(&self) -> Option<Finish<S::Value>> {
        let mut finish = None;
        self.scripts.park(&mut || {
            let mut end = self.end.lock();
            while end.is_none() {
                self.ended.wait(&mut end);
            }
            finish = end.take();
        });
        finish
    }

    /// Ends all threads of the run, which has to be over.
    pub(crate) fn close(&self) {
        let mut threads = Vec::new();
        self.scripts.park(&mut || {
            let mut core = self.core.lock();
            core.crew.dismiss();
            threads = std::mem::take(&mut core.threads);
            drop(core);
            for thread in threads.drain(..) {
                if thread.join().is_err() {
                    self.recorder
                        .push(self.clock.now_ns(), [tell::defect("a branch's thread panicked")]);
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

    /// The lock is taken: whoever holds it may need the interpreter, so it is not waited for from inside.
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

    fn drive(
        self: &Arc<Self>,
        core: &mut Core<S::Value>,
        input: Input<S::Value>,
        own: Option<BranchId>,
    ) -> Result<Next<S::Value>, Refusal> {
        let mut turn = Turning { own, next: None, freed: None };
        core.engine.handle(input, self.scripts.globals(), &mut core.outbox)?;
        self.carry_out(core, &mut turn);
        self.answer_pending(core, &mut turn)?;
        let next = core.settle(turn);
        self.staff(core);
        Ok(next)
    }

    /// Sees to it that a thread is on its way to branches that have none, and that scripts without a thread are answered.
    fn staff(self: &Arc<Self>, core: &mut Core<S::Value>) {
        self.recruit(core);
        while !core.pending.is_empty() {
            let mut outside = Turning { own: None, next: None, freed: None };
            if let Err(refusal) = self.answer_pending(core, &mut outside) {
                self.recorder.push(self.clock.now_ns(), [tell::defect(&refusal.to_string())]);
            }
            self.recruit(core);
        }
    }

    /// Gives the engine the answers for scripts that could not be run.
    fn answer_pending(
        self: &Arc<Self>,
        core: &mut Core<S::Value>,
        turn: &mut Turning<S::Value>,
    ) -> Result<(), Refusal> {
        while let Some((frame, result)) = core.pending.pop_front() {
            let input = Input::Finished { frame, result };
            core.engine.handle(input, self.scripts.globals(), &mut core.outbox)?;
            self.carry_out(core, turn);
        }
        Ok(())
    }

    fn carry_out(&self, core: &mut Core<S::Value>, turn: &mut Turning<S::Value>) {
        self.record(core);
        let mut effects = std::mem::take(&mut core.outbox.effects);
        for effect in effects.drain(..) {
            match effect {
                Effect::Run(job) => {
                    let begun = self.begin(core, job);
                    core.dispatch(begun, turn);
                }
                // A branch gets its thread with its first script.
                Effect::Fork { .. } => {}
                Effect::EndBranch { branch } => core.end_branch(branch, turn),
                Effect::Preempt(path) => core.signal(path),
                Effect::Paused(paused) => core.pause(paused),
                Effect::Finish(finish) => self.finish(finish),
            }
        }
        core.outbox.effects = effects;
    }

    fn recruit(self: &Arc<Self>, core: &mut Core<S::Value>) {
        while core.crew.needs_thread() {
            match branch::start(self, core.threads.len()) {
                Ok(thread) => {
                    core.threads.push(thread);
                    core.crew.sent();
                }
                Err(error) => self.give_up(core, &error),
            }
        }
    }

    fn give_up(&self, core: &mut Core<S::Value>, error: &std::io::Error) {
        if let Some(turn) = core.crew.give_up() {
            let reason = format!(
                "the system gave no thread for this branch ({error}); let fewer states run side by side"
            );
            core.pending.push_back((turn.job.frame, self.scripts.failure(&reason)));
        }
    }

    /// The next branch without a thread, for a thread that was sent for it; without one the thread is idle.
    pub(crate) fn seek(self: &Arc<Self>, worker: &Arc<Worker<S::Value>>) -> Next<S::Value> {
        let seek = |core: &mut Core<S::Value>| {
            core.crew.arrive();
            let turn = core.crew.take(Arc::clone(worker));
            self.staff(core);
            turn
        };
        self.with_core(seek).flatten()
    }

    /// Notes the events down, and makes the places that they are the first to name.
    fn record(&self, core: &mut Core<S::Value>) {
        if core.outbox.events.is_empty() {
            return;
        }
        let now = self.clock.now_ns();
        let events = std::mem::take(&mut core.outbox.events);
        for event in &events {
            match event {
                Event::Entered { path, node, .. } => self.enter(core, *path, *node, now),
                Event::Left { path, outcome, .. } => core.leave(*path, *outcome),
                Event::Stopping => core.set_flags(0),
                _ => {}
            }
        }
        self.recorder.push(now, events.iter().filter_map(|event| told(&core.engine, event)));
        core.outbox.events = events;
        core.outbox.events.clear();
    }

    fn enter(&self, core: &mut Core<S::Value>, path: PathId, node: NodeId, now: u64) {
        let place = Arc::clone(self.place_of(core, path, node));
        place.enter(now, core.around(&place));
    }

    /// The place with this number, made if it is new.
    pub(crate) fn place_of<'c>(
        &self,
        core: &'c mut Core<S::Value>,
        path: PathId,
        node: NodeId,
    ) -> &'c Arc<Place> {
        let index = path.index();
        if core.known.len() <= index {
            core.known.resize(index + 1, None);
        }
        let (known, engine, flags) = (&mut core.known[index], &core.engine, core.flags);
        known.get_or_insert_with(|| {
            let text = engine.path_text(path).to_string();
            let place = Arc::new(Place::new(path, node, engine.path_parent(path), text.into()));
            place.signals.set(flags, true);
            self.places.insert(Arc::clone(&place));
            place
        })
    }

    /// Makes ready what the script's thread needs.
    fn begin(&self, core: &mut Core<S::Value>, job: Job<S::Value>) -> Turn<S::Value> {
        let place = Arc::clone(self.place_of(core, job.path, job.node));
        place.signals.begin(job.preempted);
        Turn { job, place }
    }

    fn finish(&self, finish: Finish<S::Value>) {
        *self.end.lock() = Some(finish);
        self.ended.notify_all();
    }
}

impl<D: Datum> Core<D> {
    /// How many threads there were.
    #[cfg(test)]
    pub(crate) fn threads(&self) -> usize {
        self.threads.len()
    }

    fn at(&self, path: PathId) -> Option<&Arc<Place>> {
        self.known.get(path.index()).and_then(Option::as_ref)
    }

    fn around(&self, place: &Place) -> Option<&Place> {
        self.at(place.parent?).map(|around| &**around)
    }

    fn leave(&self, path: PathId, outcome: OutcomeId) {
        if let Some(place) = self.at(path) {
            place.leave(outcome, self.around(place));
        }
    }

    fn pause(&mut self, paused: bool) {
        self.set_flags(if paused { PAUSED } else { STARTED });
    }

    fn set_flags(&mut self, flags: u8) {
        self.flags = flags;
        for place in self.known.iter().flatten() {
            place.signals.set((PAUSED | STARTED) & !flags, false);
            place.signals.set(flags, true);
        }
    }

    fn signal(&self, path: PathId) {
        if let Some(place) = self.at(path) {
            place.signals.set(PREEMPTED, true);
        }
    }

    fn dispatch(&mut self, begun: Turn<D>, turn: &mut Turning<D>) {
        if turn.own == Some(begun.job.branch) {
            self.crew.go_on(&begun);
            turn.next = Some(begun);
        } else {
            self.crew.post(begun);
        }
    }

    fn end_branch(&mut self, branch: BranchId, turn: &mut Turning<D>) {
        let worker = self.crew.end(branch);
        if turn.own == Some(branch) {
            turn.freed = worker;
        } else if let Some(waiting) = worker {
            self.crew.retire(waiting);
        }
    }

    /// What the thread that gave the input does next.
    fn settle(&mut self, turn: Turning<D>) -> Next<D> {
        match (turn.next, turn.freed, turn.own) {
            (Some(next), _, _) => Some(next),
            (None, Some(freed), _) => self.crew.take(freed),
            (None, None, Some(branch)) => {
                self.crew.rest(branch);
                None
            }
            (None, None, None) => None,
        }
    }
}

fn told<D: Datum>(engine: &Engine<D>, event: &Event<D>) -> Option<Record> {
    match event {
        Event::Entered { path, .. } => Some(Record::Entered(*path)),
        Event::Left { path, outcome, .. } => Some(Record::Left(*path, *outcome)),
        Event::Finished { .. } => None,
        event => tell::rare(event, engine),
    }
}
