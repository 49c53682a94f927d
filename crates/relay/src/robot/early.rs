//! Requests that cannot be carried out, or whose fate is not known, at the moment: of runs whose runners accept no connection yet, or
//! of a server that has not read its runs.

use rafcon_link::ReceivedCommand;

/// Capacity. Further commands are refused.
const EARLY_MAX: usize = 64;

/// Commands in the order of their arrival.
#[derive(Debug, Default)]
pub(super) struct EarlyCommands(Vec<ReceivedCommand>);

impl EarlyCommands {
    /// Adds a command; returns it if there is no room.
    pub(super) fn add(&mut self, command: ReceivedCommand) -> Option<ReceivedCommand> {
        if self.0.len() >= EARLY_MAX {
            return Some(command);
        }
        self.0.push(command);
        None
    }

    /// Removes all. Those that expired by `now_ms` are late from then on; what was late on arrival stays so.
    pub(super) fn take(&mut self, now_ms: u64) -> Vec<ReceivedCommand> {
        let mut commands = std::mem::take(&mut self.0);
        for command in &mut commands {
            command.is_late |= now_ms > command.not_after_ms;
        }
        commands
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rafcon_link::CommandId;

    #[test]
    fn commands_wait_up_to_the_bound_and_expire() {
        let command = |not_after_ms| ReceivedCommand {
            id: CommandId([0; 16]),
            epoch: 0,
            not_after_ms,
            not_before_ms: 0,
            is_late: false,
            body: Vec::new(),
        };
        let mut early = EarlyCommands::default();
        for nth in 0..EARLY_MAX as u64 {
            assert_eq!(early.add(command(nth)), None);
        }
        assert_eq!(early.add(command(1_000)), Some(command(1_000)));
        let taken = early.take(9);
        assert_eq!(taken.iter().filter(|command| command.is_late).count(), 9);
        assert_eq!((taken.len(), early.take(9).len()), (EARLY_MAX, 0));
        // From the previous session, with a higher clock value.
        assert_eq!(early.add(ReceivedCommand { is_late: true, ..command(3_600_000) }), None);
        assert!(early.take(9).iter().all(|command| command.is_late));
    }
}
