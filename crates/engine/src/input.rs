//! What the engine is told.

use crate::FrameId;
use rafcon_model::StatePath;
use smol_str::SmolStr;

/// A cause of work. Every one is legal or refused in every status.
#[derive(Debug, Clone)]
pub enum Input<D> {
    /// Begin the run.
    Start(Start<D>),
    /// Hold every hierarchy before its next child; scripts see `paused`.
    Pause,
    /// Go on after a pause.
    Resume,
    /// End the run as if it were preempted.
    Stop,
    /// The script of a frame ended.
    Finished {
        /// The frame of the [`crate::Job`].
        frame: FrameId,
        /// How it ended.
        result: ScriptResult<D>,
    },
}

/// How a run begins.
#[derive(Debug, Clone)]
pub struct Start<D> {
    /// Values for input ports of the root by name, instead of their defaults.
    pub inputs: Vec<(SmolStr, D)>,
    /// Begin at this state instead of the start states above it. Values that skipped states would have given are absent.
    pub start_from: Option<StatePath>,
}

impl<D> Default for Start<D> {
    fn default() -> Self {
        Self { inputs: Vec::new(), start_from: None }
    }
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
