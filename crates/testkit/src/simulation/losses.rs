//! Random losses of engines, and resumption of their runs by other engines.

use super::commands;
use super::edits::{edited, reloaded};
use super::watch::{Amid, Checked, promise};
use super::world::World;
use rafcon_engine::{
    ActiveStateData, Counted, Engine, Event, Input, Interrupted, ModelLiterals, Outbox, Program,
    Restore,
};
use rafcon_model::{Machine, StatePath, Value};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Remains of a run whose process died.
struct Left {
    breakpoints: Vec<Input<Value>>,
    restore: Restore<Value>,
    /// Active states, with a flag for a request to end.
    asked: BTreeMap<StatePath, bool>,
    /// True if nothing was held or undone before. Otherwise a branch that was held behind its end, or had ended when
    /// another was undone, wins its race when the run is resumed.
    went_on: bool,
}

impl World {
    /// Kills the process; another engine resumes the run in its last state.
    pub(crate) fn lose_engine(&mut self) -> Checked {
        let Some(root) = self.engine.configuration() else { return Ok(()) };
        let counted = self.engine.counted();
        let restore = self.restoring(root, counted);
        self.count_loss();
        let left = self.left(restore);
        if self.chance(40) && self.resume_changed(&left)? {
            return Ok(());
        }
        let program = match self.wide {
            Some(_) => Arc::new(Program::compile(&self.machine, &mut ModelLiterals)),
            None => Arc::clone(self.engine.program()),
        };
        self.begin_engine(self.machine.clone(), program, &left.breakpoints)?;
        self.resume(left)
    }

    /// Kills the process while nothing is held, so that the run continues without a difference.
    pub(crate) fn lose_engine_quietly(&mut self) -> Checked {
        let Some(root) = self.engine.configuration() else { return Ok(()) };
        let counted = self.engine.counted();
        self.count_loss();
        let interrupted = Interrupted::Again;
        let (stopping, begun_at) = (self.engine.stopping(), self.engine.begun_at());
        let (crash, hold) = (None, false);
        let restore = Restore { root, interrupted, crash, hold, counted, stopping, begun_at };
        let left = self.left(restore);
        let program = Arc::new(Program::compile(&self.machine, &mut ModelLiterals));
        self.begin_engine(self.machine.clone(), program, &left.breakpoints)?;
        self.resume(left)
    }

    pub(crate) fn restoring(
        &mut self,
        root: ActiveStateData<Value>,
        counted: Counted,
    ) -> Restore<Value> {
        let interrupted = commands::interrupted(&mut self.random);
        let crash = Some(Value::str("crash"));
        let stopping = self.engine.stopping().filter(|_| self.wide.is_some());
        let hold = self.random.percent(50);
        let begun_at = self.engine.begun_at().filter(|_| self.wide.is_some());
        Restore { root, interrupted, crash, hold, counted, stopping, begun_at }
    }

    fn count_loss(&mut self) {
        let amid = Amid::of(&self.engine);
        let with_breakpoints = self.engine.breakpoints().next().is_some();
        let backwards = self.watch.is_backwards();
        let counts = &mut self.watch.counts;
        counts.resumed += 1;
        counts.resumed_again += u64::from(self.was_resumed);
        counts.resumed_stopping += u64::from(amid.stopping);
        counts.resumed_preempting += u64::from(amid.preempting);
        counts.resumed_handling += u64::from(amid.handling);
        counts.resumed_backwards += u64::from(backwards);
        counts.resumed_with_breakpoints += u64::from(with_breakpoints);
        self.was_resumed = true;
    }

    fn left(&self, restore: Restore<Value>) -> Left {
        let breakpoints = self.engine.breakpoints().filter(|_| self.wide.is_some());
        let breakpoints = breakpoints.map(|(breakpoint, _)| Input::Break(breakpoint.clone()));
        let snapshot = self.engine.snapshot();
        let held = snapshot.iter().any(|active| !active.holds.is_empty());
        let forwards = self.watch.counts.steps_back == 0;
        let went_on = !held && self.watch.checks.is_empty() && forwards;
        let asked = snapshot.into_iter();
        let asked = asked.map(|active| (self.engine.path_text(active.path), active.preempted));
        let (breakpoints, asked) = (breakpoints.collect(), asked.collect());
        Left { breakpoints, restore, asked, went_on }
    }

    /// Resumes the run with a changed machine. Returns false if the machine does not fit the run.
    fn resume_changed(&mut self, left: &Left) -> Result<bool, String> {
        let Some(random) = &mut self.wide else { return Ok(false) };
        let mut machine = self.machine.clone();
        for _ in 0..=random.below(4) {
            let reloads = random.percent(20);
            let fresh = &mut self.fresh;
            let other = if reloads {
                reloaded(&machine, random, fresh)
            } else {
                edited(&machine, random, fresh)
            };
            machine = other.unwrap_or(machine);
        }
        let program = Arc::new(Program::compile(&machine, &mut ModelLiterals));
        let mut trial = Engine::new(Arc::clone(&program));
        let input = Input::Restore(Box::new(left.restore.clone()));
        let taken = trial.handle(input, &rafcon_engine::NoGlobals, &mut Outbox::default());
        if taken.is_err() {
            self.watch.counts.refused_changed += 1;
            return Ok(false);
        }
        self.watch.counts.resumed_changed += 1;
        self.has_changed = true;
        self.begin_engine(machine, program, &left.breakpoints)?;
        self.feed(Input::Restore(Box::new(left.restore.clone())))?;
        Ok(true)
    }

    fn begin_engine(
        &mut self,
        machine: Machine,
        program: Arc<Program<Value>>,
        breakpoints: &[Input<Value>],
    ) -> Checked {
        self.machine = machine.clone();
        self.latest = (machine, Arc::clone(&program));
        self.engine = Engine::new(program);
        self.stale = None;
        self.watch.begin_anew();
        breakpoints.iter().try_for_each(|breakpoint| self.feed(breakpoint.clone()))
    }

    /// Resumes the run, and checks that exactly the earlier requests to end remain.
    fn resume(&mut self, left: Left) -> Checked {
        let input = Input::Restore(Box::new(left.restore));
        self.say(&input);
        self.handle(input).map_err(|refusal| format!("refused: {refusal}"))?;
        let mut entered = BTreeMap::new();
        let mut quiet = left.went_on;
        for event in &self.out.events {
            match event {
                Event::Entered { path, .. } => *entered.entry(*path).or_insert(0) += 1,
                Event::Left { .. } => quiet = false,
                _ => {}
            }
        }
        self.take()?;
        for active in self.engine.snapshot() {
            let asked = left.asked.get(&self.engine.path_text(active.path));
            let Some(&asked) = asked.filter(|_| entered.get(&active.path) == Some(&1)) else {
                continue;
            };
            promise(active.preempted || !asked, "a request to end was lost with an engine")?;
            let more = active.preempted && !asked && quiet;
            promise(!more, "a state was asked to end by taking it up")?;
        }
        Ok(())
    }
}
