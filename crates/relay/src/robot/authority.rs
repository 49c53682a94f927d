//! Who may command the runs of a robot: one user at a time, over its own page and all stations.

use crate::resumes::Answered;
use rafcon_protocol::Command;
use rafcon_protocol::api::{Control, ControlMove, ResumeRequest, Right};
use std::fmt;

/// Decides who commands. Users of a station have `@` and its name after theirs.
pub trait Authority: fmt::Debug + Send + Sync {
    /// Whether a user may command this run now, having decided under this epoch of authority; else why not, and the way out. Who
    /// brings a robot to rest is not asked.
    fn command(&self, run: &str, user: &str, epoch: u64) -> Result<(), String>;

    /// Right that a command needs.
    fn right_of(&self, command: &Command) -> Right;

    /// Moves control of a run as a user wants, or says why not.
    fn move_control(&self, run: &str, user: &str, wanted: &ControlMove) -> Result<(), String>;

    /// True once the runs in the folder are known.
    fn is_ready(&self) -> bool;

    /// Begins to resume a run whose runner died, once for each id of a user. `answered` is called with the result: `Expired` if nothing
    /// was done by the end of its validity.
    fn resume(&self, request: ResumeRequest, answered: Answered) -> Result<(), String>;

    /// True if this request resumed the run, false if not; none if the fate is unknown.
    fn was_resumed(&self, run: &str, user: &str, id: &str) -> Option<bool>;

    /// A user is there: who holds control is not silent.
    fn present(&self, user: &str);

    /// Who holds control of a run; none if the run is not known.
    fn control(&self, run: &str) -> Option<Control>;
}
