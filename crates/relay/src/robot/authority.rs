//! Authority over the runs of a robot: one user at a time, over its own page and all stations.

use crate::requests::Answered;
use rafcon_protocol::Command;
use rafcon_protocol::api::{Control, ControlMove, ResumeRequest, Right, RobotAnswer, StartRequest};
use std::fmt;

/// Decides who commands. Users of a station have `@` and its name after theirs.
pub trait Authority: fmt::Debug + Send + Sync {
    /// Whether a user may command this run now, having decided under this epoch of authority; else why not, and the way out. Who
    /// brings a robot to rest is not asked.
    fn command(&self, run: &str, user: &str, id: &str, epoch: u64) -> Result<(), String>;

    /// The run refused the command with this id: if its author took control by it, nobody has it.
    fn refused(&self, run: &str, id: &str);

    /// Right that a command needs.
    fn right_of(&self, command: &Command) -> Right;

    /// Moves control of a run for a user, or returns the reason of the refusal.
    fn move_control(&self, run: &str, user: &str, wanted: &ControlMove) -> Result<(), String>;

    /// True once the runs in the folder are known.
    fn is_ready(&self) -> bool;

    /// Begins to resume a run whose runner died, once for each id of a user. `answered` is called with the result: `Expired` if nothing
    /// was done by the end of its validity.
    fn resume(&self, request: ResumeRequest, answered: Answered) -> Result<(), String>;

    /// Fate of a request to resume a run.
    fn fate_of_resume(&self, run: &str, user: &str, id: &str) -> RobotAnswer;

    /// Begins to start a run, once for each id of a user. `answered` is called with the result: `Expired` if nothing was done by the
    /// end of its validity.
    fn start(&self, request: StartRequest, answered: Answered) -> Result<(), String>;

    /// Fate of a request to start a run.
    fn fate_of_start(&self, user: &str, id: &str) -> RobotAnswer;

    /// Records that a user is present: a present holder of control is not silent.
    fn present(&self, user: &str);

    /// Control of a run. `None` for an unknown run.
    fn control(&self, run: &str) -> Option<Control>;
}
