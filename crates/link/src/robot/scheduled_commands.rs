//! Commands that the robot has and whose time has not come. They are lost with the robot's session: what was for an earlier start is void.

use super::ReceivedCommand;
use crate::frame::CommandId;
use crate::session_time::SessionTime;
use std::collections::BTreeMap;

/// Capacity in commands.
pub(crate) const SCHEDULED_MAX: usize = 64;
pub(super) const TOO_MANY: &str =
    "the robot keeps 64 commands for later already: wait until their time has come";

/// In the order of their times.
#[derive(Debug, Default)]
pub(super) struct ScheduledCommands {
    commands: BTreeMap<(u64, CommandId), ReceivedCommand>,
}

impl ScheduledCommands {
    /// Adds a command; false if there are too many.
    pub(super) fn add(&mut self, command: ReceivedCommand) -> bool {
        let has_room = self.commands.len() < SCHEDULED_MAX;
        if has_room {
            self.commands.insert((command.not_before_ms, command.id), command);
        }
        has_room
    }

    pub(super) fn has(&self, id: CommandId) -> bool {
        self.commands.keys().any(|(_, other)| *other == id)
    }

    /// The first whose time has come.
    pub(super) fn take(&mut self, now_ms: u64) -> Option<ReceivedCommand> {
        let first = self.commands.first_entry()?;
        (first.key().0 <= now_ms).then(|| first.remove())
    }

    /// When the next one is due.
    pub(super) fn due_at(&self) -> Option<SessionTime> {
        self.commands.keys().next().map(|(at_ms, _)| SessionTime::from_millis(*at_ms))
    }
}
