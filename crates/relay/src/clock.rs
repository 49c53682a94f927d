//! The one clock of this crate: it begins with its process and never goes back.

use rafcon_link::SessionTime;
use std::time::Instant;

/// The time of one session.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SessionClock(Instant);

#[expect(clippy::disallowed_methods, reason = "this is the crate's one clock")]
impl SessionClock {
    pub(crate) fn begin() -> Self {
        Self(Instant::now())
    }

    pub(crate) fn now(&self) -> SessionTime {
        SessionTime::after(self.0.elapsed())
    }
}
