//! Whether the engine of a run takes inputs, asked of its runner from time to time. Pure.

use rafcon_protocol::{EnginePulse, ToRunner};
use std::time::Duration;

/// From one question to the next.
const RHYTHM: Duration = Duration::from_secs(1);

/// What was asked and heard.
#[derive(Debug, Default)]
pub(super) struct Pulse {
    next: Duration,
    asked: u64,
    is_stuck: bool,
}

impl Pulse {
    /// When the next question is due.
    pub(super) fn due(&self) -> Duration {
        self.next
    }

    /// The question, if it is due.
    pub(super) fn question(&mut self, now: Duration) -> Option<ToRunner> {
        if now < self.next {
            return None;
        }
        self.next = now + RHYTHM;
        self.asked += 1;
        Some(ToRunner::Ping { id: self.asked })
    }

    /// Whether the engine is reached again or not any more, if the answer changes that.
    pub(super) fn answered(&mut self, engine: EnginePulse) -> Option<bool> {
        let is_reached = engine.is_reached(!self.is_stuck);
        if is_reached != self.is_stuck {
            return None;
        }
        self.is_stuck = !is_reached;
        Some(is_reached)
    }
}
