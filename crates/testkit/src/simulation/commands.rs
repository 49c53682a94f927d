//! Random commands, most of them valid at the moment.

use super::places::paths;
use crate::random::Random;
use rafcon_engine::{
    Activity, Breakpoint, Engine, Input, Interrupted, Scope, Silence, Start, Status, Stride, Then,
    Unattended, WaitReason, When,
};
use rafcon_model::{KindName, Machine, OutcomeId, StateId, StatePath, Value};

/// A kind of commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Like {
    Steps,
    Breakpoints,
    Changes,
    WaitingChanges,
    Force,
    BeginningAgain,
    /// No contact with the ground for a while.
    Silence,
    /// The engine is lost, and another one resumes the run.
    Losses,
    /// Requests for states to end.
    Requests,
}

/// Kinds of commands in a run. Different rates let some runs progress far before the first command.
#[derive(Debug, Clone)]
pub(crate) struct Mood {
    /// Percentage of inputs that are commands.
    pub(crate) commands: usize,
    likes: Vec<Like>,
}

impl Mood {
    pub(crate) fn new(random: &mut Random) -> Self {
        let chances = [
            (Like::Steps, 60),
            (Like::Breakpoints, 50),
            (Like::Changes, 50),
            (Like::WaitingChanges, 70),
            (Like::Force, 50),
            (Like::BeginningAgain, 25),
            (Like::Silence, 40),
        ];
        Self::among(&chances, random)
    }

    /// A mood without holds, in which two runs can be compared.
    pub(crate) fn plain(random: &mut Random) -> Self {
        Self::among(&[(Like::Changes, 50)], random)
    }

    fn among(chances: &[(Like, usize)], random: &mut Random) -> Self {
        let commands = random.pick(&[5, 15, 15, 50, 80]).unwrap_or(5);
        let chosen = chances.iter().filter(|(_, chance)| random.percent(*chance));
        Self { commands, likes: chosen.map(|(like, _)| *like).collect() }
    }

    /// Adds the kinds of commands that only the wide world has.
    pub(crate) fn widen(&mut self, random: &mut Random) {
        let chances = [(Like::Losses, 50), (Like::Requests, 35)];
        let chosen = chances.into_iter().filter(|(_, chance)| random.percent(*chance));
        self.likes.extend(chosen.map(|(like, _)| like));
    }

    pub(crate) fn likes(&self, like: Like) -> bool {
        self.likes.contains(&like)
    }
}

/// State from which a command is chosen.
pub(crate) struct Moment<'m> {
    pub(crate) engine: &'m Engine<Value>,
    pub(crate) machine: &'m Machine,
}

impl Moment<'_> {
    /// A random path: of an active state, of one inside of it, or any.
    fn path(&self, random: &mut Random) -> StatePath {
        let all = paths(self.machine);
        let active = self.active();
        let near: Vec<_> = all
            .iter()
            .filter(|p| p.parent().is_some_and(|p| active.contains(&p)))
            .cloned()
            .collect();
        let chosen = match random.below(10) {
            0..=3 => random.pick(&active),
            4..=7 => random.pick(&near),
            8 => random.pick(&all),
            _ => None,
        };
        chosen.unwrap_or_else(|| StatePath::root(StateId::new("NOWHERE")))
    }

    /// The path of an active state.
    pub(crate) fn active_path(&self, random: &mut Random) -> Option<StatePath> {
        random.pick(&self.active())
    }

    /// A state inside an active one.
    fn near(&self, random: &mut Random) -> StatePath {
        let active = self.active();
        let mut all = paths(self.machine);
        all.retain(|path| path.parent().is_some_and(|parent| active.contains(&parent)));
        match random.pick(&all).filter(|_| random.percent(80)) {
            Some(path) => path,
            None => self.path(random),
        }
    }

    fn active(&self) -> Vec<StatePath> {
        self.engine.snapshot().iter().map(|active| self.engine.path_text(active.path)).collect()
    }

    /// `None` for all branches, or the path of one.
    fn branch(&self, random: &mut Random) -> Option<StatePath> {
        if random.percent(40) {
            return None;
        }
        let snapshot = self.engine.snapshot();
        let races = snapshot.iter().filter(|active| {
            let kind = self.engine.program().node(active.node).state().kind.name();
            matches!(kind, KindName::Barrier | KindName::Preemptive)
        });
        let races: Vec<_> = races.map(|active| self.engine.path_text(active.path)).collect();
        let all = paths(self.machine);
        let branches = all.into_iter().filter(|p| p.parent().is_some_and(|p| races.contains(&p)));
        let chosen = random.pick(&branches.collect::<Vec<_>>());
        chosen.or_else(|| random.percent(20).then(|| self.path(random)))
    }

    fn has_interrupted(&self) -> bool {
        let waits = Activity::Waiting(WaitReason::Interrupted);
        self.engine.snapshot().iter().any(|active| active.activity == waits)
    }

    /// A held or waiting state, or the one before which a branch is held.
    fn still(&self, random: &mut Random) -> StatePath {
        let snapshot = self.engine.snapshot();
        let still = snapshot
            .iter()
            .filter(|active| matches!(active.activity, Activity::Held | Activity::Waiting(_)));
        let mut places: Vec<_> = still.map(|active| active.path).collect();
        let holds = snapshot.iter().flat_map(|active| &active.holds);
        places.extend(holds.filter_map(|hold| hold.next));
        match random.pick(&places).filter(|_| random.percent(90)) {
            Some(place) => self.engine.path_text(place),
            None => self.path(random),
        }
    }
}

/// A random command, except those that need more knowledge of the world.
pub(crate) fn command(moment: &Moment<'_>, mood: &Mood, random: &mut Random) -> Input<Value> {
    if random.percent(20) {
        return any(moment, mood, random);
    }
    match moment.engine.status() {
        _ if moment.has_interrupted() && random.percent(60) => recover(moment, random),
        Status::Paused | Status::Stepping => while_held(moment, mood, random),
        Status::Running => while_free(moment, mood, random),
        Status::Idle | Status::Stopping | Status::Finished => any(moment, mood, random),
    }
}

fn while_held(moment: &Moment<'_>, mood: &Mood, random: &mut Random) -> Input<Value> {
    match random.below(10) {
        0..=5 if mood.likes(Like::Steps) => step(moment, random),
        6 if mood.likes(Like::Breakpoints) => breakpoints(moment, random),
        7 if mood.likes(Like::Force) => force(moment, random),
        8 if mood.likes(Like::BeginningAgain) => Input::Start(start(moment, random)),
        9 if mood.likes(Like::Silence) => Input::Silence(silence(random)),
        _ => Input::Resume(moment.branch(random)),
    }
}

fn while_free(moment: &Moment<'_>, mood: &Mood, random: &mut Random) -> Input<Value> {
    match random.below(10) {
        0..=2 if mood.likes(Like::Steps) => Input::StepMode,
        3 | 4 if mood.likes(Like::Steps) => Input::RunTo(moment.path(random)),
        5..=7 if mood.likes(Like::Breakpoints) => breakpoints(moment, random),
        8 if mood.likes(Like::Force) => Input::Preempt(moment.path(random)),
        9 if mood.likes(Like::Silence) => Input::Silence(silence(random)),
        _ => Input::Pause,
    }
}

/// A random command that may be invalid.
fn any(moment: &Moment<'_>, mood: &Mood, random: &mut Random) -> Input<Value> {
    match random.below(12) {
        0..=1 if mood.likes(Like::Steps) => step(moment, random),
        2 if mood.likes(Like::Steps) => Input::StepMode,
        3 if mood.likes(Like::Steps) => Input::RunTo(moment.path(random)),
        4..=5 if mood.likes(Like::Breakpoints) => breakpoints(moment, random),
        6 if mood.likes(Like::Breakpoints) => Input::Attended(random.percent(60)),
        7 if mood.likes(Like::Force) => force(moment, random),
        8 if mood.likes(Like::Force) => Input::Preempt(moment.path(random)),
        9 if mood.likes(Like::BeginningAgain) => Input::Start(start(moment, random)),
        10 => recover(moment, random),
        11 => Input::Pause,
        _ => Input::Resume(moment.branch(random)),
    }
}

fn step(moment: &Moment<'_>, random: &mut Random) -> Input<Value> {
    let strides =
        [Stride::Into, Stride::Into, Stride::Over, Stride::Out, Stride::Back, Stride::Back];
    let stride = random.pick(&strides).unwrap_or(Stride::Into);
    Input::Step(stride, moment.branch(random))
}

fn force(moment: &Moment<'_>, random: &mut Random) -> Input<Value> {
    Input::Force(moment.still(random), OutcomeId(random.small(5) - 2))
}

fn recover(moment: &Moment<'_>, random: &mut Random) -> Input<Value> {
    let path = random.percent(40).then(|| moment.still(random));
    Input::Recover(path, interrupted(random))
}

/// A random policy for interrupted scripts.
pub(crate) fn interrupted(random: &mut Random) -> Interrupted {
    let all = [Interrupted::Wait, Interrupted::Abort, Interrupted::Again];
    random.pick(&all).unwrap_or(Interrupted::Again)
}

fn breakpoints(moment: &Moment<'_>, random: &mut Random) -> Input<Value> {
    let id = u64::try_from(random.small(6)).unwrap_or_default();
    if random.percent(20) {
        return Input::Unbreak(id);
    }
    let alone = [Unattended::Hold, Unattended::Continue, Unattended::Stop];
    Input::Break(Breakpoint {
        id,
        path: moment.near(random),
        when: if random.percent(60) { When::Before } else { When::After },
        condition: random.percent(50).then(|| "x > 1".into()),
        hit_count: u32::try_from(random.small(4)).unwrap_or_default(),
        scope: if random.percent(70) { Scope::Branch } else { Scope::Run },
        unattended: random.pick(&alone).unwrap_or(Unattended::Hold),
        enabled: random.percent(90),
        lost_link_ms: random.pick(&[None, Some(10), Some(30)]).flatten(),
    })
}

/// A random silence: as long as those of policies and breakpoints, or over.
fn silence(random: &mut Random) -> Silence {
    let mut ms = || random.pick(&[0, 10, 20, 30]).unwrap_or_default();
    Silence { link_ms: ms(), command_ms: ms() }
}

/// A random start, often at a random state.
pub(crate) fn start(moment: &Moment<'_>, random: &mut Random) -> Start<Value> {
    let all = paths(moment.machine);
    let start_from = random.pick(&all).filter(|_| random.percent(60));
    let mut given = Vec::new();
    if let Some(path) = start_from.clone().filter(|_| random.percent(50)) {
        given.push((path, "x".into(), Value::Int(42)));
    }
    let then = random.pick(&[Then::GoOn, Then::GoOn, Then::Hold, Then::Stop]).unwrap_or_default();
    Start {
        inputs: vec![("x".into(), Value::Int(7))],
        start_from,
        given,
        hold: random.percent(30),
        then,
    }
}
