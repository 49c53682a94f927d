//! Comparison of a run with its cut and resumed twin: from then on, equal results must give equal outputs.

use super::commands::Like;
use super::watch::{Amid, Checked};
use super::world::{INPUTS as LIFE, World, result};
use crate::random::Random;
use rafcon_engine::{
    Effect, Engine, Event, Input, Interrupted, Job, NoGlobals, Outbox, PathId, Restore,
    ScriptResult, Start, Status, WaitReason,
};
use rafcon_model::Value;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Maximum number of inputs after the cut.
const INPUTS: usize = 80;

/// One of the two runs, with its scripts by path.
struct Twin {
    engine: Engine<Value>,
    jobs: BTreeMap<String, Job<Value>>,
}

impl World {
    /// Runs for a while, then cuts and resumes the run while the original continues.
    pub(crate) fn live_as_twins(&mut self) -> Checked {
        self.feed(Input::Start(Start::default()))?;
        for _ in 0..self.random.below(LIFE / 4) {
            if !self.is_over() {
                self.something()?;
            }
        }
        if matches!(self.engine.status(), Status::Paused | Status::Stepping) {
            self.feed(Input::Resume(None))?;
        }
        if self.mood.likes(Like::Losses) && self.chance(20) && !self.is_over() {
            self.lose_engine_quietly()?;
        }
        if self.chance(60) && self.engine.status() == Status::Running {
            self.stop()?;
            while self.chance(90) && !self.is_over() && !Amid::of(&self.engine).handling {
                self.one_ends()?;
            }
        }
        let stops = self.engine.status() == Status::Stopping && self.wide.is_some();
        if self.engine.status() == Status::Running || stops {
            return twins(self);
        }
        self.wind_up(true)
    }
}

/// Cuts the run of this world, and drives both runs to their ends.
fn twins(world: &mut World) -> Checked {
    let amid = Amid::of(&world.engine);
    let told = is_told(world, amid);
    let (root, stopping) = if told {
        (world.watch.history.configuration(&world.engine), world.watch.history.stopping())
    } else {
        (world.engine.configuration(), world.engine.stopping())
    };
    let Some(root) = root else { return Ok(()) };
    let counts = &mut world.watch.counts;
    counts.twins_cut_stopping += u64::from(amid.stopping);
    counts.twins_cut_preempting += u64::from(amid.preempting);
    counts.twins_cut_handling += u64::from(amid.handling);
    counts.twins_told_preempting += u64::from(told && amid.preempting);
    let program = Arc::clone(world.engine.program());
    let (counted, begun_at) = (world.engine.counted(), world.engine.begun_at());
    let mut cut = Twin { engine: Engine::new(Arc::clone(&program)), jobs: BTreeMap::new() };
    let interrupted = Interrupted::Again;
    let (crash, hold) = (None, false);
    let restore = Restore { root, interrupted, crash, hold, counted, stopping, begun_at };
    cut.feed(Input::Restore(Box::new(restore)))?;
    let engine = std::mem::replace(&mut world.engine, Engine::new(program));
    let running = std::mem::take(&mut world.watch.running);
    let named = running.into_iter().map(|job| (engine.path_text(job.path).to_string(), job));
    let mut whole = Twin { jobs: named.collect(), engine };
    alike(&whole, &cut)?;
    for turn in 0.. {
        if whole.engine.status() == Status::Finished {
            break;
        }
        let answers = both(&mut whole, &mut cut, &mut world.random, turn)?;
        world.watch.line(answers);
        world.watch.counts.twin_answers += 1;
        alike(&whole, &cut)?;
        if world.chance(8) && cut.lose_engine()? {
            world.watch.counts.twins_cut_again += 1;
            alike(&whole, &cut).map_err(|broken| format!("cut once more: {broken}"))?;
        }
    }
    world.engine = whole.engine;
    let over = cut.engine.status() == Status::Finished;
    if over { Ok(()) } else { Err("the run that was resumed goes on".into()) }
}

/// True if the run is resumed from events alone. Events lack commands to preempt a state, and all state from before the
/// loss of an engine.
fn is_told(world: &mut World, amid: Amid) -> bool {
    let commanded = world.watch.counts.preempt_commands > 0 || world.was_resumed;
    if world.wide.is_some() {
        return !world.has_changed && !commanded && world.chance(90);
    }
    !world.has_changed && !amid.preempting && world.random.percent(50)
}

/// Checks that both runs have equal scripts with equal inputs, and equal held states.
fn alike(whole: &Twin, cut: &Twin) -> Checked {
    same("runs other scripts", &whole.scripts(), &cut.scripts())?;
    same("stands otherwise", &whole.standing(), &cut.standing())
}

fn same(what: &str, whole: &[String], cut: &[String]) -> Checked {
    if whole == cut {
        return Ok(());
    }
    let (whole, cut) = (whole.join("\n"), cut.join("\n"));
    Err(format!("the run resumed {what}; it should be\n{whole}\nbut is\n{cut}\n"))
}

/// Gives both runs an equal input, and compares their outputs.
fn both(
    whole: &mut Twin,
    cut: &mut Twin,
    random: &mut Random,
    turn: usize,
) -> Result<String, String> {
    let idle = whole.jobs.is_empty() || turn > INPUTS && random.percent(50);
    if idle || random.percent(2) {
        return compare(whole.feed(Input::Stop)?, &cut.feed(Input::Stop)?);
    }
    if random.percent(10) && whole.engine.status() != Status::Stopping {
        let input = match whole.engine.status() {
            Status::Paused => Input::Resume(None),
            _ => Input::Pause,
        };
        return compare(whole.feed(input.clone())?, &cut.feed(input)?);
    }
    let names: Vec<_> = whole.jobs.keys().cloned().collect();
    let Some(name) = random.pick(&names) else { return Ok(String::new()) };
    let job = whole.jobs.get(&name).ok_or("a job is gone")?;
    let result = result(random, job);
    compare(whole.finish(&name, result.clone())?, &cut.finish(&name, result)?)
}

fn compare(whole: String, cut: &str) -> Result<String, String> {
    if whole == cut {
        return Ok(whole);
    }
    Err(format!("the run resumed goes on otherwise; it should have said\n{whole}but said\n{cut}"))
}

impl Twin {
    /// Lets another engine resume the run, if it is running or stopping. Returns false otherwise.
    fn lose_engine(&mut self) -> Result<bool, String> {
        if !matches!(self.engine.status(), Status::Running | Status::Stopping) {
            return Ok(false);
        }
        let Some(root) = self.engine.configuration() else { return Ok(false) };
        let (counted, stopping) = (self.engine.counted(), self.engine.stopping());
        let (interrupted, begun_at) = (Interrupted::Again, self.engine.begun_at());
        let (crash, hold) = (None, false);
        let restore = Restore { root, interrupted, crash, hold, counted, stopping, begun_at };
        self.engine = Engine::new(Arc::clone(self.engine.program()));
        self.jobs.clear();
        self.feed(Input::Restore(Box::new(restore)))?;
        Ok(true)
    }

    fn finish(&mut self, name: &str, result: ScriptResult<Value>) -> Result<String, String> {
        let job = self.jobs.remove(name).ok_or("a script does not run in the run resumed")?;
        self.feed(Input::Finished { frame: job.frame, result })
    }

    /// Handles an input, and returns the effects as text with names.
    fn feed(&mut self, input: Input<Value>) -> Result<String, String> {
        let mut out = Outbox::default();
        let taken = self.engine.handle(input, &NoGlobals, &mut out);
        taken.map_err(|refusal| format!("refused: {refusal}"))?;
        self.engine.check()?;
        let mut text = String::new();
        for event in &out.events {
            text += &self.event(event);
            text.push('\n');
        }
        for effect in out.effects {
            text += &self.effect(effect);
            text.push('\n');
        }
        Ok(text)
    }

    fn name(&self, path: PathId) -> String {
        self.engine.path_text(path).to_string()
    }

    /// The running scripts, with their inputs.
    fn scripts(&self) -> Vec<String> {
        self.jobs.iter().map(|(name, job)| format!("{name} {:?}", job.inputs)).collect()
    }

    /// The active states with their activities.
    fn standing(&self) -> Vec<String> {
        let snapshot = self.engine.snapshot();
        let active = snapshot.iter().map(|active| {
            let held = active.holds.iter().map(|hold| hold.next.map(|next| self.name(next)));
            let held = held.collect::<Vec<_>>();
            let flag = active.preempted;
            format!("{} {:?} {held:?} {flag}", self.name(active.path), active.activity.clone())
        });
        // Numbers of places differ between the runs.
        active.map(|line| line.replace(|c: char| c.is_ascii_digit(), "")).collect()
    }

    fn event(&self, event: &Event<Value>) -> String {
        match event {
            Event::Entered { path, inputs, undoes, .. } => {
                format!("enter {} {inputs:?} {undoes:?}", self.name(*path))
            }
            Event::Left { path, outcome, outputs, absent, error, .. } => {
                format!("leave {} {outcome:?} {outputs:?} {absent:?} {error:?}", self.name(*path))
            }
            Event::Scoped { path, port, value } => {
                format!("set {} {port:?} {value:?}", self.name(*path))
            }
            Event::Waiting { path, reason } => {
                let reason = match reason {
                    WaitReason::NoTransition { child, outcome } => {
                        format!("{} {outcome:?}", self.name(*child))
                    }
                    other => format!("{other:?}"),
                };
                format!("wait {} {reason}", self.name(*path))
            }
            Event::Held { path, next, by } => {
                format!("hold {} {:?} {by:?}", self.name(*path), next.map(|next| self.name(next)))
            }
            Event::Note { path, level, note } => {
                format!("note {} {level:?} {note:?}", self.name(*path))
            }
            other => format!("{other:?}"),
        }
    }

    fn effect(&mut self, effect: Effect<Value>) -> String {
        match effect {
            Effect::Run(job) => {
                let Job { inputs, outputs, error, preempted, verdicts, .. } = &job;
                let text = format!("{inputs:?} {outputs:?} {error:?} {preempted} {verdicts:?}");
                let name = self.name(job.path);
                let line = format!("run {name} {text}");
                self.jobs.insert(name, job);
                line
            }
            Effect::Preempt(path) => format!("preempt {}", self.name(path)),
            Effect::Fork { .. } => "fork".to_owned(),
            Effect::EndBranch { .. } => "end".to_owned(),
            other => format!("{other:?}"),
        }
    }
}
