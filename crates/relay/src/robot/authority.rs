//! Who may command the runs of a robot: one user at a time, over its own page and all stations.

use rafcon_protocol::Command;
use rafcon_protocol::api::{Control, ControlMove, Right};
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

    /// A user is there: who holds control is not silent.
    fn present(&self, user: &str);

    /// Who holds control of a run; none if the run is not known.
    fn control(&self, run: &str) -> Option<Control>;
}
