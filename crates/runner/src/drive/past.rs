//! The recent history of the run, for scripts, up to the limit of memory. This module knows events, but not how scripts
//! present them.

use crate::record::blocks::Chunk;
use crate::{Clock, Driver, Scripts};
use rafcon_protocol::Event;
use rafcon_storage::journal::stream::StreamReader;
use std::path::Path;

/// Limit of the events that are searched.
const EVENTS_MAX: u64 = 20_000;

/// A past event that a script can inspect.
#[derive(Debug, Clone, PartialEq)]
pub struct PastEvent {
    /// Number of the event.
    pub sequence: u64,
    /// Time of the event, in ms since 1970 UTC.
    pub epoch_ms: u64,
    /// The event itself, as viewers receive it.
    pub event: Event,
}

impl<S: Scripts> Driver<S> {
    /// The entries and ends of states, oldest first. Called on any thread, outside the interpreter.
    pub fn past(&self) -> Vec<PastEvent> {
        let (recorder, mut chunk) = (self.recorder(), Chunk::default());
        let mut next = (recorder.last() + 1).saturating_sub(EVENTS_MAX).max(1);
        let mut reader = StreamReader::new(next, true, recorder.folder().map(Path::to_path_buf));
        let (began, mut found) = (self.began_ms(), Vec::new());
        let mut show = |sequence, t_ns, event| {
            if matches!(event, Event::Entered { .. } | Event::Left { .. }) {
                found.push(PastEvent { sequence, epoch_ms: began + t_ns / 1_000_000, event });
            }
        };
        let mut places = Vec::new();
        recorder.names().write(&mut places);
        // Reading cannot fail, because this process wrote the data.
        reader.read(&places, &mut show).unwrap_or_default();
        while recorder.recent(&mut next, &mut chunk) {
            for block in chunk.blocks() {
                reader.read_block(&block, &mut show).unwrap_or_default();
            }
        }
        found
    }

    fn began_ms(&self) -> u64 {
        Clock::epoch_ms().saturating_sub(self.clock().now_ms())
    }
}
