//! Source of data that the robot's session no longer has in memory.

use crate::frame::{StreamId, ValueName};
use rafcon_events::EventBlock;

/// Source of data that the session no longer has in memory.
pub trait RunSource {
    /// Events from `first` on: at least one, at most to `last`, and not more than `bytes_max` unless a single event is longer. Nothing
    /// if they cannot be read now.
    fn events(
        &mut self,
        stream: StreamId,
        first: u64,
        last: u64,
        bytes_max: usize,
    ) -> Option<EventBlock>;

    /// The present state of a run and the number of its last event, readable without the events before.
    fn snapshot(&mut self, stream: StreamId) -> Option<(u64, Vec<u8>)>;

    /// Length of a large value in bytes. `None` if the run does not or no longer contain it.
    fn value_length(&mut self, _value: &ValueName) -> Option<u64> {
        None
    }

    /// Reads bytes of a large value from `offset` on, at most `bytes_max`. `None` if they cannot be read.
    fn value_bytes(
        &mut self,
        _value: &ValueName,
        _offset: u64,
        _bytes_max: usize,
    ) -> Option<Vec<u8>> {
        None
    }
}
