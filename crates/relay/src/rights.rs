//! Rights of a station on a robot. The robot enforces them: a stolen key of an observing station changes nothing.

use rafcon_protocol::api::Right;
use rafcon_protocol::{Command, LinkRights};
use std::fmt;
use std::str::FromStr;

/// Rights of the users of a paired station.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PairingRights {
    /// See runs.
    Observe,
    /// Command runs as well.
    #[default]
    Command,
    /// Change what runs execute as well: scripts, machines, conditions.
    Change,
}

/// A text that names no rights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the rights are `observe`, `command` or `change`")]
pub struct BadRights;

impl PairingRights {
    /// Checks a command that needs this right in general.
    pub(crate) fn check(self, command: &Command, right: Right) -> Result<(), String> {
        if let Command::Control { .. } = command {
            return Err("control is requested, handed over and released, not set".to_owned());
        }
        self.check_right(right)
    }

    /// Checks an action that needs this right in general.
    pub(crate) fn check_right(self, right: Right) -> Result<(), String> {
        let (is_allowed, needed) = match right {
            Right::Anyone | Right::Observe => (true, Self::Observe),
            Right::Command | Right::Start => (self != Self::Observe, Self::Command),
            Right::Edit | Right::Administer => (self == Self::Change, Self::Change),
        };
        let refused = || {
            format!(
                "the pairing of this station allows `{self}`, and this needs `{needed}`: pair again with `rafcon pair NAME --rights \
                 {needed}` on the robot"
            )
        };
        is_allowed.then_some(()).ok_or_else(refused)
    }
}

impl From<PairingRights> for LinkRights {
    fn from(rights: PairingRights) -> Self {
        match rights {
            PairingRights::Observe => Self::Observe,
            PairingRights::Command => Self::Command,
            PairingRights::Change => Self::Change,
        }
    }
}

impl fmt::Display for PairingRights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Observe => "observe",
            Self::Command => "command",
            Self::Change => "change",
        })
    }
}

impl FromStr for PairingRights {
    type Err = BadRights;

    fn from_str(text: &str) -> Result<Self, BadRights> {
        let all = [Self::Observe, Self::Command, Self::Change];
        all.into_iter().find(|rights| rights.to_string() == text).ok_or(BadRights)
    }
}

#[cfg(test)]
mod tests {
    use super::PairingRights::{Change, Command as Commands, Observe};
    use rafcon_protocol::Command;
    use rafcon_protocol::api::Right;

    #[test]
    fn a_station_does_what_its_pairing_allows_and_no_more() {
        let allowed = |right| {
            [Observe, Commands, Change].map(|rights| rights.check(&Command::Pause, right).is_ok())
        };
        assert_eq!(allowed(Right::Observe), [true; 3]);
        assert_eq!(allowed(Right::Command), [false, true, true]);
        assert_eq!(allowed(Right::Start), [false, true, true]);
        assert_eq!(allowed(Right::Edit), [false, false, true]);
        let refused = Observe.check(&Command::Pause, Right::Command).unwrap_err();
        assert!(refused.contains("needs `command`"), "{refused}");
    }

    #[test]
    fn no_pairing_lets_a_station_set_who_is_in_control() {
        let control = Command::Control { holder: Some("eve".to_owned()) };
        assert!(Change.check(&control, Right::Command).is_err());
    }
}
