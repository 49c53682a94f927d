//! A world that drives an engine like real threads and users, in any order.

use super::commands::{self, Like, Moment, Mood};
use super::counts::Counts;
use super::edits::{edited, reloaded};
use super::machine::machine;
use super::watch::{Checked, Watch, promise};
use crate::notation;
use crate::random::Random;
use rafcon_engine::{
    ActiveStateData, Change, Counted, Engine, FrameId, Input, Job, ModelLiterals, NoGlobals,
    Outbox, Program, Refusal, Restore, Returned, ScriptResult, Start, Status, Stride,
};
use rafcon_model::{Machine, Value};
use std::sync::Arc;

/// Maximum number of inputs before the run is stopped.
pub(crate) const INPUTS: usize = 150;
/// Number of inputs between the first and the second stop.
const INPUTS_AFTER_STOP: usize = 60;

/// Result of a run.
#[derive(Debug, PartialEq, Eq)]
pub struct Report {
    /// Coverage of the run.
    pub counts: Counts,
    /// Hash of all events.
    pub fingerprint: u64,
}

/// Range of possible events in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Width {
    /// Events of the first version of the simulation, in their order, so that failed seeds reproduce.
    First,
    /// All events, including those added after the first version.
    Wide,
}

/// Runs the machine of this seed to its end. The error names the broken guarantee, and shows the machine.
pub fn simulate(seed: u64, width: Width) -> Result<Report, String> {
    let mut random = Random::new(seed);
    let handlers = random.percent(50);
    let text = machine(&mut random, handlers);
    let machine = notation::parse(&text).map_err(|error| format!("{error}\n{text}"))?;
    let mut wide = (width == Width::Wide).then(|| Random::new(!seed));
    let more = wide.as_mut().is_some_and(|wide| wide.percent(25));
    let is_twin = random.percent(20) || more;
    let mut mood = if is_twin { Mood::plain(&mut random) } else { Mood::new(&mut random) };
    if let Some(wide) = &mut wide {
        mood.widen(wide);
    }
    let mut world = World::new(machine, mood, random, wide);
    world.watch.plain &= is_twin || !world.mood.likes(Like::Losses);
    let lived = if is_twin { world.live_as_twins() } else { world.live(handlers) };
    lived.map_err(|broken| {
        format!("seed {seed}: {broken}\n{text}\nand last:\n{}", world.watch.story())
    })?;
    world.watch.counts.states_run = world.engine.states_run();
    Ok(Report { counts: world.watch.counts, fingerprint: world.watch.fingerprint })
}

pub(crate) struct World {
    pub(crate) engine: Engine<Value>,
    pub(crate) random: Random,
    /// Random numbers for events that the first world does not have, so that all others stay unchanged.
    pub(crate) wide: Option<Random>,
    pub(crate) watch: Watch,
    pub(crate) out: Outbox<Value>,
    /// True if the machine has changed since the start.
    pub(crate) has_changed: bool,
    pub(crate) mood: Mood,
    /// True if an earlier engine was lost.
    pub(crate) was_resumed: bool,
    /// The machine of the run.
    pub(crate) machine: Machine,
    /// The last machine and program sent to the engine; they may still wait.
    pub(crate) latest: (Machine, Arc<Program<Value>>),
    /// Number for the next new state.
    pub(crate) fresh: u32,
    /// Moments of the past.
    moments: Vec<ActiveStateData<Value>>,
    /// A frame that has already returned its result.
    pub(crate) stale: Option<FrameId>,
}

impl World {
    fn new(machine: Machine, mood: Mood, random: Random, wide: Option<Random>) -> Self {
        let program = Arc::new(Program::compile(&machine, &mut ModelLiterals));
        let holds = [Like::Steps, Like::Breakpoints, Like::BeginningAgain];
        let plain = !holds.into_iter().any(|like| mood.likes(like));
        Self {
            engine: Engine::new(Arc::clone(&program)),
            random,
            wide,
            watch: Watch::new(plain),
            out: Outbox::default(),
            has_changed: false,
            was_resumed: false,
            mood,
            machine: machine.clone(),
            latest: (machine, program),
            fresh: 0,
            moments: Vec::new(),
            stale: None,
        }
    }

    /// True with a probability of `percent` percent; never in the first world.
    pub(crate) fn chance(&mut self, percent: usize) -> bool {
        self.wide.as_mut().is_some_and(|random| random.percent(percent))
    }

    /// Drives the run to its end: random inputs, a stop, and a second stop if handlers run for long.
    fn live(&mut self, handlers: bool) -> Checked {
        let start =
            if self.mood.likes(Like::BeginningAgain) { self.start() } else { Start::default() };
        self.feed(Input::Start(start))?;
        for _ in 0..self.random.below(INPUTS) {
            if self.is_over() {
                self.watch.counts.ended_by_themselves += 1;
                return self.end();
            }
            self.something()?;
        }
        self.wind_up(handlers)
    }

    pub(crate) fn wind_up(&mut self, handlers: bool) -> Checked {
        if self.random.percent(50) {
            self.let_go()?;
        }
        self.stop()?;
        let started = self.watch.started;
        for _ in 0..INPUTS_AFTER_STOP {
            if self.mood.likes(Like::Losses) && self.chance(3) {
                self.lose_engine()?;
            }
            self.one_ends()?;
        }
        let others = [Like::Changes, Like::BeginningAgain, Like::Losses];
        let handles = handlers || others.into_iter().any(|like| self.mood.likes(like));
        let quiet = handles || self.watch.started == started;
        promise(quiet, "a script began after a stop, without a handler")?;
        if !self.is_over() {
            self.last_stop()?;
        }
        self.end()
    }

    /// Releases all held branches, and answers all conditions.
    fn let_go(&mut self) -> Checked {
        for _ in 0..INPUTS_AFTER_STOP {
            match self.engine.status() {
                Status::Paused | Status::Stepping => self.feed(Input::Resume(None))?,
                Status::Idle | Status::Running | Status::Stopping | Status::Finished => {}
            }
            self.answer()?;
            self.one_ends()?;
        }
        Ok(())
    }

    fn last_stop(&mut self) -> Checked {
        self.stop()?;
        let started = self.watch.started;
        while !self.watch.running.is_empty() {
            self.one_ends()?;
        }
        promise(self.watch.started == started, "a script began after the second stop")
    }

    pub(crate) fn is_over(&self) -> bool {
        self.engine.status() == Status::Finished
    }

    pub(crate) fn stop(&mut self) -> Checked {
        if self.is_over() { Ok(()) } else { self.feed(Input::Stop) }
    }

    /// Invariants after the end of the run.
    fn end(&mut self) -> Checked {
        promise(self.is_over(), "all scripts have ended, and the run has not")?;
        self.watch.end()?;
        let late = [Input::Start(Start::default()), Input::Stop, Input::Pause, Input::Resume(None)];
        let refused = late.into_iter().all(|input| self.handle(input).is_err());
        promise(refused, "a run that is over took an input")
    }

    pub(crate) fn handle(&mut self, input: Input<Value>) -> Result<(), Refusal> {
        self.engine.handle(input, &NoGlobals, &mut self.out)
    }

    pub(crate) fn something(&mut self) -> Checked {
        if self.mood.likes(Like::Requests) && self.chance(4) {
            let moment = Moment { engine: &self.engine, machine: &self.machine };
            let path = self.wide.as_mut().and_then(|random| moment.active_path(random));
            return path.map_or(Ok(()), |path| self.counted(Input::Preempt(path)));
        }
        let often = if self.watch.is_backwards() { 40 } else { 8 };
        if !self.watch.plain && self.mood.likes(Like::Losses) && self.chance(often) {
            return self.lose_engine();
        }
        if self.random.percent(self.mood.commands) {
            return self.command();
        }
        if self.watch.running.is_empty() {
            return if self.watch.checks.is_empty() { self.command() } else { self.answer() };
        }
        if self.random.percent(1) { self.late_result() } else { self.one_ends() }
    }

    fn command(&mut self) -> Checked {
        match self.random.below(100) {
            0 if self.random.percent(30) => self.try_out(Input::Stop).map(|_| ()),
            1..=20 if self.mood.likes(Like::Changes) => self.change(),
            21..=24 if self.mood.likes(Like::BeginningAgain) => self.lose_engine(),
            25..=32 if self.mood.likes(Like::BeginningAgain) => self.go_back(),
            33..=40 => self.answer(),
            _ => {
                let moment = Moment { engine: &self.engine, machine: &self.machine };
                let input = commands::command(&moment, &self.mood, &mut self.random);
                self.counted(input)
            }
        }
    }

    fn start(&mut self) -> Start<Value> {
        let moment = Moment { engine: &self.engine, machine: &self.machine };
        let mut start = commands::start(&moment, &mut self.random);
        if self.random.percent(30) {
            start.given.clear();
        }
        start
    }

    fn counted(&mut self, input: Input<Value>) -> Checked {
        let counted = input.clone();
        if !self.try_out(input)? {
            return Ok(());
        }
        let counts = &mut self.watch.counts;
        match counted {
            Input::Step(Stride::Into | Stride::Over | Stride::Out, None) => counts.steps += 1,
            Input::Step(Stride::Into | Stride::Over | Stride::Out, Some(_)) => {
                counts.branch_steps += 1;
            }
            Input::Step(Stride::Back, _) => counts.steps_back += 1,
            Input::Preempt(_) => counts.preempt_commands += 1,
            Input::Start(_) => counts.started_again += 1,
            Input::Recover(..) => counts.recovered += 1,
            _ => {}
        }
        Ok(())
    }

    /// Sends a command that may be refused without effect. Returns true if it was accepted.
    fn try_out(&mut self, input: Input<Value>) -> Result<bool, String> {
        let before = (self.engine.status(), self.engine.snapshot());
        self.say(&input);
        match self.handle(input) {
            Ok(()) => {
                self.watch.counts.commands_taken += 1;
                self.take()?;
                Ok(true)
            }
            Err(refusal) => {
                self.watch.line(format!("  refused: {refusal}"));
                self.watch.counts.commands_refused += 1;
                let same = before == (self.engine.status(), self.engine.snapshot());
                promise(same, "a refusal changed something")?;
                let silent = self.out.events.is_empty() && self.out.effects.is_empty();
                promise(silent, "a refusal said something")?;
                Ok(false)
            }
        }
    }

    pub(crate) fn say(&mut self, input: &Input<Value>) {
        let line = match input {
            Input::Change(change) => format!("> change, wait: {}", change.wait),
            other => format!("> {other:?}"),
        };
        self.watch.line(line);
    }

    /// Answers a condition, perhaps too late.
    fn answer(&mut self) -> Checked {
        let Some(check) = self.watch.checks.pop() else { return Ok(()) };
        let result = match self.random.below(10) {
            0 => Err("it raised".into()),
            number => Ok(number < 6),
        };
        if self.try_out(Input::Checked { check, result })? {
            self.watch.counts.checks += 1;
        }
        Ok(())
    }

    fn change(&mut self) -> Checked {
        let (latest, random, fresh) = (&self.latest.0, &mut self.random, &mut self.fresh);
        let reloads = random.percent(20);
        let machine =
            if reloads { reloaded(latest, random, fresh) } else { edited(latest, random, fresh) };
        let Some(machine) = machine else { return Ok(()) };
        let program = Arc::new(self.latest.1.change(&machine, &mut ModelLiterals));
        let wait = self.mood.likes(Like::WaitingChanges) && self.random.percent(70);
        let earlier = std::mem::replace(&mut self.latest, (machine, Arc::clone(&program)));
        let taken = self.try_out(Input::Change(Change { program, wait }))?;
        let counts = &mut self.watch.counts;
        if !taken {
            counts.refused_changes += 1;
            self.latest = earlier;
        } else if self.watch.changed {
            counts.applied_changes += 1;
            counts.changes_after_waiting -= 1;
        } else {
            counts.waiting_changes += 1;
        }
        Ok(())
    }

    /// Saves the current moment, or restores an earlier one.
    fn go_back(&mut self) -> Checked {
        if self.moments.len() < 4 && self.random.percent(40) {
            self.moments.extend(self.engine.configuration());
            return Ok(());
        }
        let Some(root) = self.random.pick(&self.moments) else { return Ok(()) };
        let restore = self.restoring(root, Counted::default());
        let restore = Restore { stopping: None, begun_at: None, ..restore };
        if self.try_out(Input::Restore(Box::new(restore)))? {
            self.watch.counts.moments_restored += 1;
        }
        Ok(())
    }

    fn late_result(&mut self) -> Checked {
        let Some(frame) = self.stale else { return Ok(()) };
        let result = ScriptResult { returned: Returned::Id(0), outputs: Vec::new(), error: None };
        let refused = self.handle(Input::Finished { frame, result }).is_err();
        promise(refused, "a result was taken twice")
    }

    pub(crate) fn one_ends(&mut self) -> Checked {
        if self.watch.running.is_empty() {
            return Ok(());
        }
        let index = self.random.below(self.watch.running.len());
        let job: Job<Value> = self.watch.running.swap_remove(index);
        self.stale = Some(job.frame);
        let result = result(&mut self.random, &job);
        self.feed(Input::Finished { frame: job.frame, result })
    }

    /// Sends an input that must be accepted.
    pub(crate) fn feed(&mut self, input: Input<Value>) -> Checked {
        self.say(&input);
        self.handle(input).map_err(|refusal| format!("refused: {refusal}"))?;
        self.take()
    }

    /// Receives the output and checks it.
    pub(crate) fn take(&mut self) -> Checked {
        let out = std::mem::take(&mut self.out);
        self.watch.take(out, &self.engine)?;
        if self.watch.changed {
            self.watch.counts.changes_after_waiting += 1;
            self.machine = self.latest.0.clone();
            self.has_changed = true;
            let same = Arc::ptr_eq(self.engine.program(), &self.latest.1);
            promise(same, "another program runs than was given last")?;
        }
        self.watch.consistent(&self.engine, &self.machine)
    }
}

/// A random result of a script.
pub(crate) fn result(random: &mut Random, job: &Job<Value>) -> ScriptResult<Value> {
    let returned = match random.below(20) {
        0 => Returned::Raised,
        1 => Returned::Other("nothing".into()),
        2 => Returned::Id(77),
        3 => Returned::Name("aborted".into()),
        4..=11 => Returned::Id(0),
        _ => Returned::Name("b".into()),
    };
    let output = |_: &Value| match random.below(4) {
        0 => None,
        1 => Some(Value::None),
        number => Some(Value::Int(i64::try_from(number).unwrap_or_default())),
    };
    let outputs = job.outputs.iter().map(output).collect();
    let error = (returned == Returned::Raised).then(|| Value::str("boom"));
    ScriptResult { returned, outputs, error }
}
