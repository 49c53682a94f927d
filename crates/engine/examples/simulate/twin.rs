//! A run that is cut and taken up by another engine goes on as the run that was not cut: the same answers to the same
//! results, from then on.

use crate::random::Random;
use crate::watch::{Checked, promise};
use crate::world::{World, result};
use rafcon_engine::{
    Effect, Engine, Event, Input, Interrupted, Job, NoGlobals, Outbox, PathId, Restore,
    ScriptResult, Status, WaitReason,
};
use rafcon_model::Value;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Inputs at most after the cut.
const INPUTS: usize = 80;

/// One of the two runs, with its scripts by their places.
struct Side {
    engine: Engine<Value>,
    jobs: BTreeMap<String, Job<Value>>,
}

/// Cuts the run of this world, and drives both until they end.
pub(crate) fn twins(world: &mut World) -> Checked {
    // Events do not tell which states were asked to end.
    let asked = world.engine.snapshot().iter().any(|active| active.preempted);
    let told = !world.has_changed && !asked && world.random.percent(50);
    let root = if told {
        world.watch.history.configuration(&world.engine)
    } else {
        world.engine.configuration()
    };
    let Some(root) = root else { return Ok(()) };
    let program = Arc::clone(world.engine.program());
    let counted = world.engine.counted();
    let mut cut = Side { engine: Engine::new(Arc::clone(&program)), jobs: BTreeMap::new() };
    let interrupted = Interrupted::Again;
    let restore = Restore { root, interrupted, crash: None, hold: false, counted };
    cut.feed(Input::Restore(Box::new(restore)))?;
    let engine = std::mem::replace(&mut world.engine, Engine::new(program));
    let running = std::mem::take(&mut world.watch.running);
    let named = running.into_iter().map(|job| (engine.path_text(job.path).to_string(), job));
    let mut whole = Side { jobs: named.collect(), engine };
    alike(&whole, &cut)?;
    for turn in 0.. {
        if whole.engine.status() == Status::Finished {
            break;
        }
        let answers = both(&mut whole, &mut cut, &mut world.random, turn)?;
        world.watch.line(answers);
        world.watch.counts.twin_answers += 1;
        alike(&whole, &cut)?;
    }
    world.engine = whole.engine;
    promise(cut.engine.status() == Status::Finished, "the run that was taken up goes on")
}

/// The same scripts run, with the same inputs, and the same stands still.
fn alike(whole: &Side, cut: &Side) -> Checked {
    promise(whole.jobs.keys().eq(cut.jobs.keys()), "other scripts run in the run taken up")?;
    let jobs = whole.jobs.values().zip(cut.jobs.values());
    let mut same = jobs.map(|(a, b)| a.inputs == b.inputs);
    promise(same.all(|same| same), "a script has other inputs in the run taken up")?;
    promise(whole.standing() == cut.standing(), "the run taken up stands otherwise")
}

/// Gives both the same input, and compares what they say.
fn both(
    whole: &mut Side,
    cut: &mut Side,
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
    Err(format!("the run taken up goes on otherwise; it should have said\n{whole}but said\n{cut}"))
}

impl Side {
    fn finish(&mut self, name: &str, result: ScriptResult<Value>) -> Result<String, String> {
        let job = self.jobs.remove(name).ok_or("a script does not run in the run taken up")?;
        self.feed(Input::Finished { frame: job.frame, result })
    }

    /// What follows from an input, by names.
    fn feed(&mut self, input: Input<Value>) -> Result<String, String> {
        let mut out = Outbox::default();
        let taken = self.engine.handle(input, &NoGlobals, &mut out);
        taken.map_err(|refusal| format!("refused: {refusal}"))?;
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

    /// What is active and what it does.
    fn standing(&self) -> Vec<String> {
        let snapshot = self.engine.snapshot();
        let active = snapshot.iter().map(|active| {
            let held = active.holds.iter().map(|hold| hold.next.map(|next| self.name(next)));
            let held = held.collect::<Vec<_>>();
            let flag = active.preempted;
            format!("{} {:?} {held:?} {flag}", self.name(active.path), active.activity.clone())
        });
        // The numbers of places differ.
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
