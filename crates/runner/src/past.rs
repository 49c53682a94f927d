//! What has happened so far, for scripts that ask: as far back as memory goes. Knows records and their words; must never know
//! how a script sees them.

use crate::archive::Archive;
use crate::blocks::Chunk;
use crate::record_renderer::RecordRenderer;
use crate::{Clock, Driver, Scripts};
use rafcon_protocol::Event;

/// Events looked back at, at most.
const EVENTS_MAX: u64 = 20_000;

/// One event that a script is told of.
#[derive(Debug, Clone, PartialEq)]
pub struct PastEvent {
    /// Its number.
    pub sequence: u64,
    /// When it happened, in ms since 1970 UTC.
    pub epoch_ms: u64,
    /// What happened; values are missing that are not on disk yet.
    pub event: Event,
}

impl<S: Scripts> Driver<S> {
    /// The states that were entered and left, oldest first. Called on any thread, outside the interpreter.
    pub fn past(&self) -> Vec<PastEvent> {
        let (recorder, mut chunk, mut archive) =
            (self.recorder(), Chunk::default(), Archive::default());
        let wording = RecordRenderer::new(recorder, &mut archive, true);
        let (began, mut found) = (self.began_ms(), Vec::new());
        let mut next = (recorder.last() + 1).saturating_sub(EVENTS_MAX).max(1);
        while recorder.recent(&mut next, &mut chunk) {
            for (sequence, t_ns, record) in chunk.records() {
                let event = wording.event(sequence, record);
                let wanted =
                    |event: &Event| matches!(event, Event::Entered { .. } | Event::Left { .. });
                found.extend(event.filter(wanted).map(|event| PastEvent {
                    sequence,
                    epoch_ms: began + t_ns / 1_000_000,
                    event,
                }));
            }
        }
        found
    }

    fn began_ms(&self) -> u64 {
        Clock::epoch_ms().saturating_sub(self.clock().now_ms())
    }
}
