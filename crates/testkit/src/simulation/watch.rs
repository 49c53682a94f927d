//! Checks the outputs and effects of an engine against all its guarantees.

use super::counts::Counts;
use super::history::History;
use rafcon_engine::{
    ActiveState, Activity, Effect, Engine, Event, HeldBy, Job, Outbox, PathId, Status,
};
use rafcon_model::{KindName, Machine, StatePath, Value};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

/// Number of lines to show from before a broken guarantee.
const LINES: usize = 60;

/// Result of a check; the error describes a broken guarantee.
pub(crate) type Checked = Result<(), String>;

pub(crate) fn promise(kept: bool, what: &str) -> Checked {
    if kept { Ok(()) } else { Err(what.to_owned()) }
}

/// State of a run as seen from outside.
#[derive(Debug)]
pub(crate) struct Watch {
    pub(crate) running: Vec<Job<Value>>,
    pub(crate) checks: Vec<u64>,
    pub(crate) history: History,
    pub(crate) counts: Counts,
    /// Hash of all events.
    pub(crate) fingerprint: u64,
    /// Number of scripts started.
    pub(crate) started: usize,
    /// True after an output that reports a change of the machine.
    pub(crate) changed: bool,
    /// True if no branch is ever held between the end of a state and its successor.
    pub(crate) plain: bool,
    branches: BTreeSet<u32>,
    active: BTreeSet<PathId>,
    /// States that are active backwards.
    backwards: BTreeSet<PathId>,
    paused: bool,
    /// Races with a winner.
    decided: BTreeSet<PathId>,
    /// Entries of each place, minus exits and drops.
    inside: BTreeMap<PathId, i64>,
    names: BTreeMap<PathId, StatePath>,
    lines: VecDeque<String>,
}

impl Watch {
    pub(crate) fn new(plain: bool) -> Self {
        Self {
            running: Vec::new(),
            checks: Vec::new(),
            history: History::default(),
            counts: Counts::default(),
            fingerprint: 0,
            started: 0,
            changed: false,
            plain,
            branches: BTreeSet::from([0]),
            active: BTreeSet::new(),
            backwards: BTreeSet::new(),
            paused: false,
            decided: BTreeSet::new(),
            inside: BTreeMap::new(),
            names: BTreeMap::new(),
            lines: VecDeque::new(),
        }
    }

    /// Resets the observed state of the run, after the engine was lost.
    pub(crate) fn begin_anew(&mut self) {
        self.running.clear();
        self.checks.clear();
        self.history = History::default();
        self.branches = BTreeSet::from([0]);
        self.active.clear();
        self.backwards.clear();
        self.paused = false;
        self.decided.clear();
        self.inside.clear();
        self.names.clear();
    }

    /// Stores a line for the report of a broken guarantee.
    pub(crate) fn line(&mut self, line: String) {
        // FNV-1a.
        for byte in line.bytes() {
            self.fingerprint =
                (self.fingerprint ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
        if self.lines.len() == LINES {
            self.lines.pop_front();
        }
        self.lines.push_back(line);
    }

    /// The last events as text.
    pub(crate) fn story(&self) -> String {
        self.lines.iter().flat_map(|line| [line.as_str(), "\n"]).collect()
    }

    pub(crate) fn is_backwards(&self) -> bool {
        !self.backwards.is_empty()
    }

    /// Receives an output and checks it.
    pub(crate) fn take(&mut self, out: Outbox<Value>, engine: &Engine<Value>) -> Checked {
        let mut named = self.active.clone();
        self.changed = false;
        for event in &out.events {
            self.line(format!("  {event:?}"));
            self.history.event(event, engine);
            self.event(event, &mut named, engine)?;
        }
        for effect in out.effects {
            self.effect(effect, &named, engine)?;
        }
        Ok(())
    }

    fn event(
        &mut self,
        event: &Event<Value>,
        named: &mut BTreeSet<PathId>,
        engine: &Engine<Value>,
    ) -> Checked {
        match event {
            Event::Entered { path, undoes, .. } => {
                self.counts.backward_steps += u64::from(undoes.is_some());
                named.insert(*path);
                if undoes.is_some() {
                    self.backwards.insert(*path);
                }
                *self.inside.entry(*path).or_default() += 1;
                self.decided.remove(path);
                let parent = engine.path_parent(*path);
                let inside = parent.is_none_or(|parent| self.active.contains(&parent));
                promise(inside, "a state was entered in a state that is not active")?;
                promise(self.active.insert(*path), "a state was entered twice")
            }
            Event::Left { path, undoes, .. } => {
                let parent = engine.path_parent(*path).filter(|_| undoes.is_none());
                let race = parent.filter(|&path| kind(engine, path) == Some(KindName::Preemptive));
                self.decided.extend(race);
                self.gone(*path, "a state was left that is not active")
            }
            Event::Dropped { path } => {
                self.counts.dropped_states += 1;
                self.gone(*path, "a state was dropped that is not active")
            }
            Event::Scoped { path, .. } | Event::Waiting { path, .. } => promise(
                self.active.contains(path),
                "something happened in a state that is not active",
            ),
            Event::Hit { held, .. } => {
                self.counts.held_breakpoints += u64::from(*held);
                self.counts.passed_breakpoints += u64::from(!held);
                Ok(())
            }
            Event::Held { by, .. } => {
                self.counts.held_at_targets += u64::from(*by == HeldBy::RunTo);
                self.counts.held_by_policies += u64::from(matches!(by, HeldBy::Loss(_)));
                Ok(())
            }
            Event::Forced { .. } => {
                self.counts.forced_outcomes += 1;
                Ok(())
            }
            Event::LossRecovery { path, .. } => {
                self.counts.recovered_states += 1;
                promise(self.active.contains(path), "a state is to recover that is not active")
            }
            Event::Changed => {
                self.changed = true;
                Ok(())
            }
            Event::Paused(paused) => {
                promise(self.paused != *paused, "a pause began or ended twice")?;
                self.paused = *paused;
                Ok(())
            }
            Event::Note { .. }
            | Event::ChangeWaits { .. }
            | Event::Stopping
            | Event::Finished { .. } => Ok(()),
        }
    }

    fn gone(&mut self, path: PathId, otherwise: &str) -> Checked {
        *self.inside.entry(path).or_default() -= 1;
        self.backwards.remove(&path);
        promise(self.active.remove(&path), otherwise)
    }

    fn effect(
        &mut self,
        effect: Effect<Value>,
        named: &BTreeSet<PathId>,
        engine: &Engine<Value>,
    ) -> Checked {
        match effect {
            Effect::Fork { branch } => {
                promise(self.branches.insert(branch.0), "a branch began twice")
            }
            Effect::EndBranch { branch } => {
                let idle = self.running.iter().all(|job| job.branch != branch);
                promise(idle, "a branch ended while its script runs")?;
                promise(self.branches.remove(&branch.0), "a branch ended that never began")
            }
            Effect::Run(job) => {
                let there = self.branches.contains(&job.branch.0);
                promise(there, "a job for a branch that is not there")?;
                let node = engine.program().node(job.node);
                promise(node.is_script(), "a job for a state without a script")?;
                let given = (job.inputs.len(), job.outputs.len());
                let ports = (node.inputs().len(), node.outputs().len());
                promise(given == ports, "a job with other values than its state has ports")?;
                let idle = self.running.iter().all(|other| other.branch != job.branch);
                promise(idle, "a job for a branch that already runs one")?;
                self.counts.backward_scripts += u64::from(job.backward);
                self.started += 1;
                self.line(format!("  run {job:?}"));
                self.running.push(job);
                Ok(())
            }
            Effect::Check(check) => {
                let there = self.branches.contains(&check.branch.0);
                promise(there, "a condition for a branch that is not there")?;
                let idle = self.running.iter().all(|other| other.branch != check.branch);
                promise(idle, "a condition for a branch that runs a script")?;
                self.checks.push(check.check);
                Ok(())
            }
            Effect::Preempt(path) => {
                self.counts.preemptions += 1;
                promise(named.contains(&path), "a state was preempted that was not active")
            }
            Effect::Paused(_) | Effect::Finish(_) => Ok(()),
        }
    }

    /// Invariants at the end of a run.
    pub(crate) fn end(&self) -> Checked {
        promise(self.running.is_empty(), "the run is over, and scripts run")?;
        promise(self.active.is_empty(), "a state was entered and never left")?;
        promise(self.branches == BTreeSet::from([0]), "a branch began and never ended")?;
        let balanced = self.inside.values().all(|inside| *inside == 0);
        promise(balanced, "a state was not left as often as it was entered")
    }

    /// Invariants between any two inputs: the engine and its listeners agree, and every held state has a reason.
    pub(crate) fn consistent(&mut self, engine: &Engine<Value>, machine: &Machine) -> Checked {
        engine.check()?;
        let snapshot = engine.snapshot();
        let paths = snapshot.iter().map(|active| active.path).collect::<BTreeSet<_>>();
        promise(paths == self.active, "the snapshot and the events disagree")?;
        let scripts = snapshot.iter().filter(|active| active.activity == Activity::Script).count();
        promise(scripts == self.running.len(), "the snapshot and the jobs disagree")?;
        let over = engine.status() == Status::Finished;
        let paused = engine.status() == Status::Paused;
        promise(over || self.paused == paused, "no one knows of a pause")?;
        self.names_stay(&snapshot, engine, machine)?;
        self.requests_arrive(&snapshot, engine)?;
        let inner = snapshot.iter().filter_map(|active| engine.path_parent(active.path));
        let inner = inner.collect::<BTreeSet<_>>();
        for leaf in snapshot.iter().filter(|active| !inner.contains(&active.path)) {
            let reason = match leaf.activity {
                Activity::Script => true,
                Activity::Checking => !self.checks.is_empty(),
                Activity::Waiting(_) => !leaf.preempted,
                Activity::Held => !leaf.holds.is_empty(),
                Activity::Inside => !leaf.holds.is_empty() || !self.checks.is_empty(),
            };
            promise(reason, "a state stands still without a reason")?;
        }
        Ok(())
    }

    /// Checks that a place keeps its name, and that all active states exist in the machine.
    fn names_stay(
        &mut self,
        snapshot: &[ActiveState],
        engine: &Engine<Value>,
        machine: &Machine,
    ) -> Checked {
        for active in snapshot {
            let text = engine.path_text(active.path);
            let state = machine.state(&text);
            promise(state.is_some(), "a state is active that the machine does not have")?;
            let node = engine.program().node(active.node);
            let same = state.is_some_and(|state| Arc::ptr_eq(state, node.state()));
            promise(same, "a state is active as it was before a change")?;
            let there = engine.path_node(active.path) == Some(active.node);
            promise(there, "a place has another state than is active there")?;
            let known = self.names.entry(active.path).or_insert_with(|| text.clone());
            promise(*known == text, "a place has another name than before")?;
        }
        Ok(())
    }

    /// Checks that losers of a race are requested to end, and all states inside of requested ones. Hierarchies are exempt,
    /// because they may run a handler.
    fn requests_arrive(&self, snapshot: &[ActiveState], engine: &Engine<Value>) -> Checked {
        let asked = snapshot.iter().filter(|active| active.preempted).map(|active| active.path);
        let asked = asked.collect::<BTreeSet<_>>();
        for active in snapshot {
            let Some(parent) = engine.path_parent(active.path) else { continue };
            let all_at_once = kind(engine, parent) != Some(KindName::Hierarchy);
            let lost = self.plain && self.decided.contains(&parent);
            let must = lost || all_at_once && asked.contains(&parent);
            promise(active.preempted || !must, "a request to end was lost")?;
        }
        Ok(())
    }
}

/// Current activities of a run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Amid {
    pub(crate) stopping: bool,
    /// True if a state was requested to end.
    pub(crate) preempting: bool,
    /// True if a state is active in a hierarchy that was requested to end, without a request itself.
    pub(crate) handling: bool,
}

impl Amid {
    pub(crate) fn of(engine: &Engine<Value>) -> Self {
        let snapshot = engine.snapshot();
        let asked = snapshot.iter().filter(|active| active.preempted).map(|active| active.path);
        let asked = asked.collect::<BTreeSet<_>>();
        let around = |active: &ActiveState| engine.path_parent(active.path);
        let handles =
            |active: &ActiveState| around(active).is_some_and(|path| asked.contains(&path));
        Self {
            stopping: engine.status() == Status::Stopping,
            preempting: !asked.is_empty(),
            handling: snapshot.iter().any(|active| !active.preempted && handles(active)),
        }
    }
}

fn kind(engine: &Engine<Value>, path: PathId) -> Option<KindName> {
    let node = engine.path_node(path)?;
    Some(engine.program().node(node).state().kind.name())
}
