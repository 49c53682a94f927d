//! A world that drives an engine as real threads would, in any order, and watches that no promise is broken.

use crate::machine::machine;
use crate::random::Random;
use rafcon_engine::{
    Active, Activity, Effect, Engine, Event, FrameId, Input, Job, ModelLiterals, NoGlobals, Outbox,
    PathId, Program, Returned, ScriptResult, Start, Status,
};
use rafcon_model::{KindName, Value, notation};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Inputs at most before the run is stopped.
const INPUTS: usize = 120;
/// Inputs after the first stop, before the second.
const PATIENCE: usize = 60;

/// What a run came to.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Report {
    /// States that were run.
    pub(crate) states: u64,
    /// Everything that happened, as one number.
    pub(crate) fingerprint: u64,
    /// Whether it ended by itself, before any stop.
    pub(crate) by_itself: bool,
}

/// Runs the machine of this seed to its end. The error says which promise was broken, and shows the machine.
pub(crate) fn simulate(seed: u64) -> Result<Report, String> {
    let mut random = Random::new(seed);
    let handlers = random.percent(50);
    let text = machine(&mut random, handlers);
    let machine = notation::parse(&text).map_err(|error| format!("{error}\n{text}"))?;
    let program = Arc::new(Program::compile(&machine, &mut ModelLiterals));
    let mut world = World::new(program, random);
    world.live(handlers).map_err(|broken| format!("seed {seed}: {broken}\n{text}"))?;
    Ok(Report {
        states: world.engine.states_run(),
        fingerprint: world.fingerprint,
        by_itself: world.by_itself,
    })
}

struct World {
    engine: Engine<Value>,
    random: Random,
    out: Outbox<Value>,
    running: Vec<Job<Value>>,
    branches: BTreeSet<u32>,
    active: BTreeSet<PathId>,
    /// A frame that has given its result.
    stale: Option<FrameId>,
    started: usize,
    fingerprint: u64,
    by_itself: bool,
    /// The races that have a winner.
    decided: BTreeSet<PathId>,
    /// How often each place was entered and left.
    visits: BTreeMap<PathId, (u64, u64)>,
}

type Checked = Result<(), String>;

fn promise(kept: bool, what: &str) -> Checked {
    if kept { Ok(()) } else { Err(what.to_owned()) }
}

impl World {
    fn new(program: Arc<Program<Value>>, random: Random) -> Self {
        Self {
            engine: Engine::new(program),
            random,
            out: Outbox::default(),
            running: Vec::new(),
            branches: BTreeSet::from([0]),
            active: BTreeSet::new(),
            stale: None,
            started: 0,
            fingerprint: 0,
            by_itself: false,
            decided: BTreeSet::new(),
            visits: BTreeMap::new(),
        }
    }

    /// From start to end: at random, then a stop, and if handlers go on for long, a second one.
    fn live(&mut self, handlers: bool) -> Checked {
        self.feed(Input::Start(Start::default()))?;
        for _ in 0..self.random.below(INPUTS) {
            if self.is_over() {
                self.by_itself = true;
                return self.end();
            }
            self.something()?;
        }
        self.stop()?;
        let started = self.started;
        for _ in 0..PATIENCE {
            self.one_ends()?;
        }
        promise(
            handlers || self.started == started,
            "a script began after a stop, without a handler",
        )?;
        if !self.is_over() {
            self.last_stop()?;
        }
        self.end()
    }

    fn last_stop(&mut self) -> Checked {
        self.stop()?;
        let started = self.started;
        while !self.running.is_empty() {
            self.one_ends()?;
        }
        promise(self.started == started, "a script began after the second stop")
    }

    fn is_over(&self) -> bool {
        self.engine.status() == Status::Finished
    }

    fn stop(&mut self) -> Checked {
        if self.is_over() { Ok(()) } else { self.feed(Input::Stop) }
    }

    /// What must hold when the run is over.
    fn end(&mut self) -> Checked {
        promise(self.is_over(), "all scripts have ended, and the run has not")?;
        promise(self.running.is_empty(), "the run is over, and scripts run")?;
        promise(self.active.is_empty(), "a state was entered and never left")?;
        promise(self.branches == BTreeSet::from([0]), "a branch began and never ended")?;
        let balanced = self.visits.values().all(|(entered, left)| entered == left);
        promise(balanced, "a state was not left as often as it was entered")?;
        for input in
            [Input::Start(Start::default()), Input::Stop, Input::Pause, Input::Resume(None)]
        {
            promise(self.refuses(input), "a run that is over took an input")?;
        }
        Ok(())
    }

    fn refuses(&mut self, input: Input<Value>) -> bool {
        self.engine.handle(input, &NoGlobals, &mut self.out).is_err()
    }

    fn something(&mut self) -> Checked {
        match self.random.below(100) {
            0..=4 => self.command(Input::Pause),
            5..=12 => self.command(Input::Resume(None)),
            13 if self.random.percent(20) => self.feed(Input::Stop),
            14 => self.late_result(),
            _ => self.one_ends(),
        }
    }

    /// A command that may be out of place, and then changes nothing.
    fn command(&mut self, input: Input<Value>) -> Checked {
        let before = self.engine.snapshot();
        match self.engine.handle(input, &NoGlobals, &mut self.out) {
            Ok(()) => self.take(),
            Err(_) => promise(before == self.engine.snapshot(), "a refusal changed something"),
        }
    }

    fn late_result(&mut self) -> Checked {
        let Some(frame) = self.stale else { return Ok(()) };
        let result = ScriptResult { returned: Returned::Id(0), outputs: Vec::new(), error: None };
        promise(self.refuses(Input::Finished { frame, result }), "a result was taken twice")
    }

    fn one_ends(&mut self) -> Checked {
        if self.running.is_empty() {
            return Ok(());
        }
        let index = self.random.below(self.running.len());
        let job = self.running.swap_remove(index);
        self.stale = Some(job.frame);
        let result = self.result();
        self.feed(Input::Finished { frame: job.frame, result })
    }

    fn result(&mut self) -> ScriptResult<Value> {
        let returned = match self.random.below(20) {
            0 => Returned::Raised,
            1 => Returned::Other("nothing".into()),
            2 => Returned::Id(77),
            3 => Returned::Name("aborted".into()),
            4..=11 => Returned::Id(0),
            _ => Returned::Name("b".into()),
        };
        let output = match self.random.below(4) {
            0 => None,
            1 => Some(Value::None),
            number => Some(Value::Int(i64::try_from(number).unwrap_or_default())),
        };
        let error = (returned == Returned::Raised).then(|| Value::str("boom"));
        ScriptResult { returned, outputs: vec![output], error }
    }

    fn feed(&mut self, input: Input<Value>) -> Checked {
        if let Err(refusal) = self.engine.handle(input, &NoGlobals, &mut self.out) {
            return Err(format!("refused: {refusal}"));
        }
        self.take()
    }

    /// Takes the answer and checks it.
    fn take(&mut self) -> Checked {
        let out = std::mem::take(&mut self.out);
        let mut named = self.active.clone();
        for event in &out.events {
            self.note_down(event);
            self.event(event, &mut named)?;
        }
        for effect in out.effects {
            self.effect(effect, &named)?;
        }
        self.consistent()
    }

    /// Everything that happened becomes part of one number (FNV-1a).
    fn note_down(&mut self, event: &Event<Value>) {
        for byte in format!("{event:?}").bytes() {
            self.fingerprint =
                (self.fingerprint ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    fn event(&mut self, event: &Event<Value>, named: &mut BTreeSet<PathId>) -> Checked {
        match event {
            Event::Entered { path, .. } => {
                named.insert(*path);
                self.visits.entry(*path).or_default().0 += 1;
                self.decided.remove(path);
                let parent = self.engine.path_parent(*path);
                let inside = parent.is_none_or(|parent| self.active.contains(&parent));
                promise(inside, "a state was entered in a state that is not active")?;
                promise(self.active.insert(*path), "a state was entered twice")
            }
            Event::Left { path, .. } => {
                self.visits.entry(*path).or_default().1 += 1;
                let parent = self.engine.path_parent(*path);
                let race = parent.filter(|&path| self.kind(path) == Some(KindName::Preemptive));
                self.decided.extend(race);
                promise(self.active.remove(path), "a state was left that is not active")
            }
            Event::Scoped { path, .. } | Event::Waiting { path, .. } => promise(
                self.active.contains(path),
                "something happened in a state that is not active",
            ),
            Event::Note { .. }
            | Event::Held { .. }
            | Event::Hit { .. }
            | Event::Forced { .. }
            | Event::Dropped { .. }
            | Event::Changed
            | Event::ChangeWaits { .. }
            | Event::Paused(_)
            | Event::Stopping
            | Event::Finished { .. } => Ok(()),
        }
    }

    fn effect(&mut self, effect: Effect<Value>, named: &BTreeSet<PathId>) -> Checked {
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
                promise(
                    self.branches.contains(&job.branch.0),
                    "a job for a branch that is not there",
                )?;
                let idle = self.running.iter().all(|other| other.branch != job.branch);
                promise(idle, "a job for a branch that already runs one")?;
                self.started += 1;
                self.running.push(job);
                Ok(())
            }
            Effect::Preempt(path) => {
                promise(named.contains(&path), "a state was preempted that was not active")
            }
            Effect::Check(_) | Effect::Paused(_) | Effect::Finish(_) => Ok(()),
        }
    }

    /// Whoever lost a race was asked to end, and so is everything inside of what was asked, except in hierarchies, which
    /// may run a handler.
    fn requests_arrive(&self, snapshot: &[Active]) -> Checked {
        let asked = snapshot.iter().filter(|active| active.preempted).map(|active| active.path);
        let asked = asked.collect::<BTreeSet<_>>();
        for active in snapshot {
            let Some(parent) = self.engine.path_parent(active.path) else { continue };
            let all_at_once = !matches!(self.kind(parent), Some(KindName::Hierarchy));
            let must = self.decided.contains(&parent) || all_at_once && asked.contains(&parent);
            promise(active.preempted || !must, "a request to end was lost")?;
        }
        Ok(())
    }

    fn kind(&self, path: PathId) -> Option<KindName> {
        let node = self.engine.path_node(path)?;
        Some(self.engine.program().node(node).state().kind.name())
    }

    /// What must hold between any two inputs: the engine and those who listened agree, and whoever stands still has a reason.
    fn consistent(&self) -> Checked {
        let snapshot = self.engine.snapshot();
        let paths = snapshot.iter().map(|active| active.path).collect::<BTreeSet<_>>();
        promise(paths == self.active, "the snapshot and the events disagree")?;
        let scripts = snapshot.iter().filter(|active| active.activity == Activity::Script).count();
        promise(scripts == self.running.len(), "the snapshot and the jobs disagree")?;
        self.requests_arrive(&snapshot)?;
        let inner = snapshot.iter().filter_map(|active| self.engine.path_parent(active.path));
        let inner = inner.collect::<BTreeSet<_>>();
        let leaves = snapshot.iter().filter(|active| !inner.contains(&active.path));
        for leaf in leaves {
            let reason = match leaf.activity {
                Activity::Script | Activity::Checking => true,
                Activity::Waiting(_) => !leaf.preempted,
                Activity::Held => !leaf.holds.is_empty(),
                Activity::Inside => false,
            };
            promise(reason, "a state stands still without a reason")?;
        }
        Ok(())
    }
}
