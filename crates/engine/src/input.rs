//! The inputs of the engine.

use crate::{ActiveStateData, FrameId, Interrupted, Program};
use rafcon_model::{Loss, OutcomeId, StatePath};
use smol_str::SmolStr;
use std::sync::Arc;

/// A cause of work. Every one is legal or refused in every status.
#[derive(Debug, Clone)]
pub enum Input<D> {
    /// Begin the run; or begin again, while everything is held or waits.
    Start(Start<D>),
    /// Resume a run, or begin again at an earlier moment, while everything is held or waits.
    Restore(Box<Restore<D>>),
    /// Hold every hierarchy before its next child; scripts see `paused`.
    Pause,
    /// Go on after a pause, a step or a breakpoint: on all branches, or on one (path of a child of a concurrency state).
    Resume(Option<StatePath>),
    /// End the run as if it were preempted.
    Stop,
    /// Hold wherever a next state would begin, from now on.
    StepMode,
    /// One step: of all branches that are held, or of one.
    Step(Stride, Option<StatePath>),
    /// Run until before this state.
    RunTo(StatePath),
    /// End a waiting or held state with this outcome; or skip with it the state before which its container is held.
    Force(StatePath, OutcomeId),
    /// Ask one active state, and all in it, to end.
    Preempt(StatePath),
    /// Decide about interrupted scripts: all, or one.
    Recover(Option<StatePath>, Interrupted),
    /// Set a breakpoint; one with the same id is replaced.
    Break(Breakpoint),
    /// Remove a breakpoint.
    Unbreak(u64),
    /// Whether anyone is connected. A run begins attended.
    Attended(bool),
    /// For how long nobody on the ground was heard. A run begins with a ground that was heard just now.
    Silence(Silence),
    /// Go by this program from now on. States keep their numbers where their paths are the same.
    Change(Change<D>),
    /// The script of a frame ended.
    Finished {
        /// The frame of the [`crate::Job`].
        frame: FrameId,
        /// How it ended.
        result: ScriptResult<D>,
    },
    /// A condition was evaluated.
    Checked {
        /// The number of the [`crate::Check`].
        check: u64,
        /// Whether it is true. The error says why it cannot be evaluated, and counts as true.
        result: Result<bool, SmolStr>,
    },
}

/// For how long a run was left alone, in ms. The driver says so when another of the times has passed that policies of states
/// ([`rafcon_model::LossPolicy`]) and breakpoints name, and when it is over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Silence {
    /// Since the ground was heard.
    pub link_ms: u64,
    /// Since someone gave a command.
    pub command_ms: u64,
}

impl Silence {
    /// Whether there is none.
    pub fn is_over(&self) -> bool {
        *self == Self::default()
    }

    /// How long it lasts by one measure.
    pub fn of(&self, loss: Loss) -> u64 {
        match loss {
            Loss::Link => self.link_ms,
            Loss::Command => self.command_ms,
        }
    }
}

/// How far a step goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stride {
    /// One child further, entering it.
    Into,
    /// One child further, running all that is in it.
    Over,
    /// To the end of the container.
    Out,
    /// One step back.
    Back,
}

/// How a run begins.
#[derive(Debug, Clone)]
pub struct Start<D> {
    /// Values for input ports of the root by name, instead of their defaults.
    pub inputs: Vec<(SmolStr, D)>,
    /// Begin at this state instead of the start states above it. Values that skipped states would have given are absent.
    pub start_from: Option<StatePath>,
    /// Values for input ports and scoped variables of the states on the way to `start_from`, that state included.
    pub given: Vec<(StatePath, SmolStr, D)>,
    /// Hold before the first child (before the root itself, if it has none), in step mode.
    pub hold: bool,
    /// What happens once `start_from` was left.
    pub then: Then,
}

/// What happens after the state that a run was begun at. Inside a concurrency state, the outermost one counts as that state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Then {
    /// The run resumes.
    #[default]
    GoOn,
    /// The run is held, in step mode.
    Hold,
    /// The run stops; if that state was the last, the run ends as it did.
    Stop,
}

impl<D> Default for Start<D> {
    fn default() -> Self {
        Self {
            inputs: Vec::new(),
            start_from: None,
            given: Vec::new(),
            hold: false,
            then: Then::GoOn,
        }
    }
}

/// A moment to continue from.
#[derive(Debug, Clone)]
pub struct Restore<D> {
    /// The root, with all that was active.
    pub root: ActiveStateData<D>,
    /// What becomes of scripts that were running.
    pub interrupted: Interrupted,
    /// The error of scripts that are aborted.
    pub crash: Option<D>,
    /// Whether the run is held, in step mode: hierarchies before their next child, and, with [`Interrupted::Again`],
    /// scripts before they run again.
    pub hold: bool,
    /// What was counted in earlier lives of the run; looked at only in an engine that has not started.
    pub counted: Counted,
    /// Set if the run was stopping.
    pub stopping: Option<Stopping>,
    /// Where the run was begun, if that still matters.
    pub begun_at: Option<BegunAt>,
}

/// The state that a run was begun at, while it was not entered or something is to happen behind it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BegunAt {
    /// See [`Start::start_from`].
    pub path: StatePath,
    /// Whether it was entered. If not, what is active on the way to it leads there first.
    pub is_reached: bool,
    /// See [`Start::then`].
    pub then: Then,
}

/// A run that was asked to stop and is not over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stopping {
    /// The order of the last request: every state that was entered before it was asked to end.
    pub order: u64,
    /// It was asked twice: no further handler begins.
    pub twice: bool,
}

/// What an engine counts from the start of a run on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counted {
    /// States that were run; library states are not counted.
    pub states_run: u64,
    /// Entries, those of library states and those that undo others too: the last number that was given to one.
    pub entries: u64,
}

/// A program to continue with.
#[derive(Debug, Clone)]
pub struct Change<D> {
    /// Made by [`Program::change`] from the program that was given last.
    pub program: Arc<Program<D>>,
    /// Whether a change that touches an active state waits until that is left, instead of being refused. A change that
    /// waits is replaced by the next one, which contains it.
    pub wait: bool,
}

/// What a script gave back.
#[derive(Debug, Clone)]
pub struct ScriptResult<D> {
    /// What it returned.
    pub returned: Returned,
    /// One entry for each output port of the node, in its order; `None` where the script left the port out.
    pub outputs: Vec<Option<D>>,
    /// The entry `error` of its outputs, or what it raised; only if it is true in Python's sense.
    pub error: Option<D>,
}

/// What a script returned, before it is looked up among the outcomes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Returned {
    /// A number: the id of an outcome.
    Id(i64),
    /// A string: the name of an outcome.
    Name(SmolStr),
    /// Anything else (`None` too), as shown to people.
    Other(SmolStr),
    /// It raised an exception (which stands in [`ScriptResult::error`]).
    Raised,
}

/// A breakpoint of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Breakpoint {
    /// Chosen by the client that sets it; the same id replaces the earlier breakpoint.
    pub id: u64,
    /// The state. It need not exist (yet).
    pub path: StatePath,
    /// On which side of the state.
    pub when: When,
    /// Text that the driver evaluates ([`crate::Effect::Check`]); without one the breakpoint always holds.
    pub condition: Option<SmolStr>,
    /// Holds from the n-th time on that it is passed and its condition is true; 0 and 1 mean each time.
    pub hit_count: u32,
    /// What is held.
    pub scope: Scope,
    /// What happens while no viewer is connected.
    pub unattended: Unattended,
    /// The same happens once the ground was not heard for so many ms.
    pub lost_link_ms: Option<u64>,
    /// A disabled one does nothing.
    pub enabled: bool,
}

/// On which side of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum When {
    /// Before it is entered.
    Before,
    /// After it was left, before what follows.
    After,
}

/// What a breakpoint holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// The branch that came to it.
    Branch,
    /// All branches, as a pause does.
    Run,
}

/// What a breakpoint does while no viewer is connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unattended {
    /// Holds all the same.
    Hold,
    /// Holds nothing, and releases what it held when the last viewer was lost.
    Continue,
    /// Stops the run.
    Stop,
}
