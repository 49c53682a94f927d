//! The inputs of the engine.

use crate::{ActiveStateData, FrameId, Interrupted, Program};
use rafcon_model::{Loss, OutcomeId, StatePath};
use smol_str::SmolStr;
use std::sync::Arc;

/// An input. Each input is either legal or refused, depending on the status of the run.
#[derive(Debug, Clone)]
pub enum Input<D> {
    /// Start the run; or start it again while everything is held or waits.
    Start(Start<D>),
    /// Resume a run, or restart it at an earlier moment while everything is held or waits.
    Restore(Box<Restore<D>>),
    /// Hold every hierarchy before its next child; scripts see `paused`.
    Pause,
    /// Continue after a pause, a step or a breakpoint: all branches, or one (the path of a concurrency state's child).
    Resume(Option<StatePath>),
    /// End the run as if it were preempted.
    Stop,
    /// Hold each branch before its next state from now on.
    StepMode,
    /// Make one step, with all held branches or with one.
    Step(Stride, Option<StatePath>),
    /// Continue until just before this state.
    RunTo(StatePath),
    /// End a waiting or held state with this outcome, or skip the state before which its container is held.
    Force(StatePath, OutcomeId),
    /// Ask one active state and everything in it to end.
    Preempt(StatePath),
    /// Choose the recovery of interrupted scripts: of all, or of one.
    Recover(Option<StatePath>, Interrupted),
    /// Set a breakpoint. It replaces one with an equal id.
    Break(Breakpoint),
    /// Remove the breakpoint with this id.
    Unbreak(u64),
    /// Report whether a viewer is connected. A run begins attended.
    Attended(bool),
    /// Report the duration of the ground's silence. A run begins without silence.
    Silence(Silence),
    /// Switch to this program. States keep their numbers where their paths are unchanged.
    Change(Change<D>),
    /// Report the result of a frame's script.
    Finished {
        /// The frame of the [`crate::Job`].
        frame: FrameId,
        /// Result of the script.
        result: ScriptResult<D>,
    },
    /// Report the result of a condition.
    Checked {
        /// The number of the [`crate::Check`].
        check: u64,
        /// Value of the condition. An error contains the reason why it cannot be evaluated, and counts as true.
        result: Result<bool, SmolStr>,
    },
}

/// Duration of the silence around a run, in ms. The driver reports it when it passes a time that a policy of a state
/// ([`rafcon_model::LossPolicy`]) or a breakpoint names, and when the silence ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Silence {
    /// Time without a message from the ground.
    pub link_ms: u64,
    /// Time without a command.
    pub command_ms: u64,
}

impl Silence {
    /// True if the ground is not silent.
    pub fn is_over(&self) -> bool {
        *self == Self::default()
    }

    /// The duration of one kind of silence.
    pub fn of(&self, loss: Loss) -> u64 {
        match loss {
            Loss::Link => self.link_ms,
            Loss::Command => self.command_ms,
        }
    }
}

/// The extent of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stride {
    /// To the next child, entering it.
    Into,
    /// Past the next child, running everything in it.
    Over,
    /// To the end of the container.
    Out,
    /// Back to before the last child.
    Back,
}

/// Parameters of a start.
#[derive(Debug, Clone)]
pub struct Start<D> {
    /// Values for input ports of the root by name, instead of their defaults.
    pub inputs: Vec<(SmolStr, D)>,
    /// Begin at this state instead of the start states above it. Values that skipped states would have given are
    /// absent.
    pub start_from: Option<StatePath>,
    /// Values for input ports and scoped variables of the states on the path to `start_from`, including that state.
    pub given: Vec<(StatePath, SmolStr, D)>,
    /// Hold before the first child, in step mode; or before the root itself, if it has none.
    pub hold: bool,
    /// The action after the end of `start_from`.
    pub then: Then,
}

/// The action after the state at which a run started. Inside a concurrency state, the outermost one counts as that
/// state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Then {
    /// The run continues as usual.
    #[default]
    GoOn,
    /// The run is held, in step mode.
    Hold,
    /// The run stops. If that state was the last, the run ends as usual.
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

/// A moment from which a run continues.
#[derive(Debug, Clone)]
pub struct Restore<D> {
    /// The root with everything that was active.
    pub root: ActiveStateData<D>,
    /// Recovery of scripts that were running.
    pub interrupted: Interrupted,
    /// The error of scripts that are aborted.
    pub crash: Option<D>,
    /// True to hold the run, in step mode: hierarchies before their next child, and, with [`Interrupted::Again`],
    /// scripts before they run again.
    pub hold: bool,
    /// Counts of earlier lives of the run. Used only by an engine that has not started.
    pub counted: Counted,
    /// Set if the run was stopping.
    pub stopping: Option<Stopping>,
    /// State at which the run started, if that still matters.
    pub begun_at: Option<BegunAt>,
}

/// The state at which a run started, while it is not yet entered or an action follows its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BegunAt {
    /// As [`Start::start_from`] of that start.
    pub path: StatePath,
    /// True if the state was entered. If not, the active states above it lead to it first.
    pub is_reached: bool,
    /// As [`Start::then`] of that start.
    pub then: Then,
}

/// A run that was asked to stop and is not over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stopping {
    /// The order of the last request: every state entered before it was asked to end.
    pub order: u64,
    /// True if the run was asked to stop twice, so that no further handler begins.
    pub twice: bool,
}

/// Counts from the start of a run on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counted {
    /// Number of states that ran, without library states.
    pub states_run: u64,
    /// The number of the last entry. All entries count, including those of library states and backward ones.
    pub entries: u64,
}

/// A program with which the run continues.
#[derive(Debug, Clone)]
pub struct Change<D> {
    /// Result of [`Program::change`] on the program of the previous change, or of the engine.
    pub program: Arc<Program<D>>,
    /// True if a change that affects an active state waits for its end, instead of being refused. The next change
    /// replaces a waiting one and contains it.
    pub wait: bool,
}

/// The result of a script.
#[derive(Debug, Clone)]
pub struct ScriptResult<D> {
    /// Value that the script returned.
    pub returned: Returned,
    /// One entry for each output port of the node, in its order; `None` where the script left the port out.
    pub outputs: Vec<Option<D>>,
    /// The entry `error` of the script's outputs, or its exception; only if it is true in Python's sense.
    pub error: Option<D>,
}

/// The returned value of a script, before it is matched to an outcome.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Returned {
    /// A number: the id of an outcome.
    Id(i64),
    /// A string: the name of an outcome.
    Name(SmolStr),
    /// Any other value, including `None`, as text.
    Other(SmolStr),
    /// The script raised an exception, which [`ScriptResult::error`] contains.
    Raised,
}

/// A breakpoint of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Breakpoint {
    /// Id chosen by the client. It replaces an earlier breakpoint with this id.
    pub id: u64,
    /// Path of the state, which need not exist (yet).
    pub path: StatePath,
    /// Side of the state.
    pub when: When,
    /// Condition, which the driver evaluates ([`crate::Effect::Check`]). Without one, each pass is a hit.
    pub condition: Option<SmolStr>,
    /// Number of the hit from which the breakpoint holds; 0 and 1 mean the first.
    pub hit_count: u32,
    /// Extent of the hold.
    pub scope: Scope,
    /// Action while no viewer is connected.
    pub unattended: Unattended,
    /// Silence of the ground, in ms, after which the action for no viewer applies.
    pub lost_link_ms: Option<u64>,
    /// True if the breakpoint is active.
    pub enabled: bool,
}

/// The side of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum When {
    /// Before the state is entered.
    Before,
    /// After the state is left, before the next step.
    After,
}

/// The extent of a breakpoint's hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// The branch that reached the breakpoint.
    Branch,
    /// All branches, as by a pause.
    Run,
}

/// The action of a breakpoint while no viewer is connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unattended {
    /// Holds as if a viewer were connected.
    Hold,
    /// Holds nothing, and releases its holds when the last viewer disconnects.
    Continue,
    /// Stops the whole run.
    Stop,
}
