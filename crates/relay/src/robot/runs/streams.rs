//! The streams of a robot's runs at one station.

use super::super::numbers::RunNumbers;
use crate::ids;
use rafcon_link::StreamId;
use std::collections::BTreeMap;

/// Streams of runs that are sent, and numbers of all runs.
#[derive(Debug)]
pub(in crate::robot) struct RunStreams {
    sent: BTreeMap<StreamId, String>,
    numbers: RunNumbers,
}

impl RunStreams {
    pub(super) fn new(numbers: RunNumbers) -> Self {
        Self { sent: BTreeMap::new(), numbers }
    }

    /// Entries for the end of the file with the numbers.
    pub(super) fn take_unsaved(&mut self) -> Vec<u8> {
        self.numbers.take_unsaved()
    }

    /// The streams of a run from now on: its events, and its description.
    pub(super) fn begin(&mut self, id: &str) -> [StreamId; 2] {
        let events = self.numbers.take(id);
        let streams = [events, ids::about_beside(events)];
        self.sent.extend(streams.map(|stream| (stream, id.to_owned())));
        streams
    }

    pub(super) fn end(&mut self, stream: StreamId) {
        self.sent.remove(&stream);
    }

    /// The run that is sent in a stream.
    pub(super) fn run(&self, stream: StreamId) -> Option<&String> {
        self.sent.get(&stream)
    }

    /// True if a run has this stream for its events, whether it is sent now or not.
    pub(super) fn is_of(&self, events: StreamId, id: &str) -> bool {
        self.numbers.find(id) == Some(events)
    }
}
