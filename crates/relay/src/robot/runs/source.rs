//! Reads runs for the session: events, descriptions, files, snapshots and large values.

use super::RobotRuns;
use crate::ids;
use crate::meter::millis;
use crate::sent_snapshot;
use crate::words::RunFate;
use rafcon_link::{EventBlock, LENGTH_MAX, RunSource, StreamId, ValueName};

impl RunSource for RobotRuns {
    fn events(
        &mut self,
        stream: StreamId,
        first: u64,
        last: u64,
        bytes_max: usize,
    ) -> Option<EventBlock> {
        if stream.is_files() {
            return Some(part(first, self.parcels.part(stream, first)?));
        }
        if ids::is_about(stream) {
            let about = self.run(stream)?.about.get(usize::try_from(first - 1).ok()?)?;
            return Some(part(first, about.clone()));
        }
        let id = self.streams.run(stream)?.clone();
        let read = self.open(&id)?.read(first, last, bytes_max).ok()??;
        if read.bytes.len() > LENGTH_MAX as usize {
            self.run(stream)?.too_long = Some((read.first_sequence, read.bytes.len()));
            return None;
        }
        Some(read)
    }

    fn snapshot(&mut self, stream: StreamId) -> Option<(u64, Vec<u8>)> {
        let now = self.place.clock.now();
        let run = self.run(stream).filter(|_| !ids::is_about(stream))?;
        let (snapshot, told) = run.snapshot.as_ref()?;
        // The runner sends changes only, so that the elapsed time is added.
        let since_ms = if run.fate == RunFate::Live { millis(now.since(*told)) } else { 0 };
        Some((snapshot.sequence, sent_snapshot::write(snapshot, since_ms)?))
    }

    fn value_length(&mut self, value: &ValueName) -> Option<u64> {
        let folder = self.folder_of(value.stream)?;
        self.values.length(&folder, value)
    }

    fn value_bytes(&mut self, value: &ValueName, offset: u64, bytes_max: usize) -> Option<Vec<u8>> {
        let folder = self.folder_of(value.stream)?;
        self.values.bytes(&folder, value, offset, bytes_max)
    }
}

/// A part of a description or of files, in the place of an event.
fn part(number: u64, bytes: Vec<u8>) -> EventBlock {
    EventBlock { first_sequence: number, count: 1, time_before: 0, bytes }
}
