//! One run of a program: accepts inputs, keeps the active configuration, returns effects and events.

/// Steps back: the undo log is followed step by step.
mod backward {
    pub(super) mod reverse;
    pub(super) mod reverse_enter;
    pub(super) mod reverse_leave;
}
/// Changes of the program during a run.
mod changes {
    pub(super) mod change;
    pub(super) mod fitting;
    pub(super) mod migrate;
    pub(super) mod undo_log_change;
}
/// Commands: hold, resume, breakpoints, forced outcomes.
mod commands {
    pub(super) mod checks;
    pub(super) mod control;
    pub(super) mod force;
    pub(super) mod resume;
    pub(super) mod silence;
    pub(super) mod suspend;
}
/// Export, inspection, restore after a crash, and the invariants of a run.
mod life {
    pub(super) mod begun;
    pub(super) mod export;
    pub(super) mod inspect;
    pub(super) mod invariants;
    pub(super) mod recover;
    pub(super) mod restore;
}
/// The state of a run: active states, suspended branches and the undo log.
mod state {
    pub(super) mod branches;
    pub(super) mod breakpoints;
    pub(super) mod frames;
    pub(super) mod phase;
    pub(super) mod places;
    pub(super) mod refusal;
    pub(super) mod snapshot;
    pub(super) mod step;
    pub(super) mod suspended;
    pub(super) mod undo_log;
}
/// Steps forward: states are entered and left, data is passed on, branches begin and end.
mod stepping {
    pub(super) mod concurrency;
    pub(super) mod data;
    pub(super) mod enter;
    pub(super) mod hierarchy;
    pub(super) mod leave;
    pub(super) mod library;
    pub(super) mod preempt;
    pub(super) mod start;
}

pub use life::inspect::Inspection;
pub use state::refusal::{ChangeEffect, Command, Refusal, Status};
pub use state::snapshot::{ActiveState, Activity, Hold};

use crate::{
    Breakpoint, Counted, Datum, Finish, Globals, Input, NodeId, Outbox, PathId, Program, Silence,
    Stopping,
};
use rafcon_model::StatePath;
use smol_str::SmolStr;
use state::branches::Branches;
use state::frames::Frames;
use state::places::Places;
use state::step::{Step, View, Work};
use state::suspended::Control;
use std::sync::Arc;
use stepping::start::Given;

/// One run of a program, from idle to finished.
#[derive(Debug)]
pub struct Engine<D> {
    program: Arc<Program<D>>,
    run: Run<D>,
}

/// The mutable state of a run.
#[derive(Debug)]
struct Run<D> {
    status: Status,
    frames: Frames<D>,
    places: Places,
    /// Work to do before `handle` returns. Empty between two calls.
    work: Vec<Work<D>>,
    /// The frame of the root while it is active.
    root: Option<u32>,
    /// The child to begin at, for each container on the start path.
    start_from: Vec<u32>,
    /// Inputs of the root until it begins.
    inputs: Vec<(SmolStr, D)>,
    /// Values for states on the start path, until those begin.
    given: Vec<Given<D>>,
    /// The end of the run while it is held.
    finish: Option<Box<Finish<D>>>,
    control: Control<D>,
    sequence: u64,
    branches: Branches,
    /// Stopped twice: no further handlers begin.
    stopped_twice: bool,
    /// Number of inputs accepted.
    turn: u64,
    /// Number of states entered, without library states.
    entered: u64,
    /// Error of interrupted scripts that are aborted.
    crash: Option<D>,
    /// Number of all entries, including backward ones.
    entries: u64,
    /// Limit of the steps kept for stepping back, and the number kept, which is updated late.
    steps_max: usize,
    steps_kept: usize,
    /// A changed program that waits until no active state prevents it.
    change: Option<Arc<Program<D>>>,
}

impl<D: Datum> Engine<D> {
    /// A run that has not started.
    pub fn new(program: Arc<Program<D>>) -> Self {
        let run = Run {
            status: Status::Idle,
            frames: Frames::new(),
            places: Places::new(Program::<D>::ROOT),
            work: Vec::new(),
            root: None,
            start_from: Vec::new(),
            inputs: Vec::new(),
            given: Vec::new(),
            finish: None,
            control: Control::new(),
            sequence: 0,
            branches: Branches::new(),
            stopped_twice: false,
            turn: 0,
            entered: 0,
            crash: None,
            entries: 0,
            steps_max: state::undo_log::STEPS_MAX,
            steps_kept: 0,
            change: None,
        };
        Self { program, run }
    }

    /// Accepts one input and appends its effects and events to `out`, in order. A refused input changes and appends
    /// nothing.
    pub fn handle(
        &mut self,
        input: Input<D>,
        globals: &dyn Globals<D>,
        out: &mut Outbox<D>,
    ) -> Result<(), Refusal> {
        if let Input::Change(change) = input {
            return self.change(change, globals, out);
        }
        self.step(globals, out).take(input)?;
        self.run.turn += 1;
        self.work(globals, out);
        while self.step(globals, out).preempt_lost() {
            self.work(globals, out);
        }
        self.run.control.starting = false;
        Ok(())
    }

    fn view(&self) -> View<'_, '_, D> {
        View { program: &self.program, run: &self.run }
    }

    fn step<'e>(&'e mut self, globals: &'e dyn Globals<D>, out: &'e mut Outbox<D>) -> Step<'e, D> {
        Step { program: &self.program, run: &mut self.run, globals, out }
    }

    /// The program that runs.
    pub fn program(&self) -> &Arc<Program<D>> {
        &self.program
    }

    /// The current status of the run.
    pub fn status(&self) -> Status {
        self.run.status()
    }

    /// The breakpoints by rising id, each with its number of hits.
    pub fn breakpoints(&self) -> impl Iterator<Item = (&Breakpoint, u32)> {
        self.run.control.breakpoints.iter()
    }

    /// The duration of the ground's silence, from the last input.
    pub fn silence(&self) -> Silence {
        self.run.control.silence
    }

    /// The current counts. A resumed run continues them.
    pub fn counted(&self) -> Counted {
        Counted { states_run: self.run.entered, entries: self.run.entries }
    }

    /// The request to stop, while the run is stopping. Each state of [`Self::configuration`] records whether it
    /// was asked to end, so the order here does not matter.
    pub fn stopping(&self) -> Option<Stopping> {
        let twice = self.run.stopped_twice;
        (self.run.status == Status::Stopping).then_some(Stopping { order: 0, twice })
    }

    /// Number of states entered. Library states are not counted; the roots of their content are.
    pub fn states_run(&self) -> u64 {
        self.run.entered
    }

    /// The ids from the root down to this place; empty for a number that no event has named.
    pub fn path_text(&self, path: PathId) -> StatePath {
        self.run.places.text(path, &self.program)
    }

    /// The place around this one; `None` for the root.
    pub fn path_parent(&self, path: PathId) -> Option<PathId> {
        self.run.places.parent(path)
    }

    /// The state at this place.
    pub fn path_node(&self, path: PathId) -> Option<NodeId> {
        self.run.places.node(path)
    }

    /// The place of the child with this index; `None` if it does not exist, or the state at `path` was never entered.
    pub fn path_child(&self, path: PathId, index: usize) -> Option<PathId> {
        self.run.places.child(path, index, &self.program)
    }
}
