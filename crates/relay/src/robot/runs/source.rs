//! Reads runs for the session: events, descriptions, files, snapshots and large values.

use super::RobotRuns;
use crate::ids;
use crate::meter::millis;
use crate::sent_snapshot;
use crate::words::RunFate;
use rafcon_link::{EventBuffer, LENGTH_MAX, RunSource, StreamId, ValueName};
use rafcon_storage::journal::EventItems;

impl RunSource for RobotRuns {
    fn events(
        &mut self,
        stream: StreamId,
        first: u64,
        last: u64,
        bytes_max: usize,
    ) -> Option<EventBuffer> {
        if stream.is_files() {
            let items = self.parcels.part(stream, first)?;
            return Some(EventBuffer { first, count: 1, t_before: 0, items });
        }
        if ids::is_about(stream) {
            let part = self.run(stream)?.about.get(usize::try_from(first - 1).ok()?)?;
            return Some(EventBuffer { first, count: 1, t_before: 0, items: part.clone() });
        }
        let id = self.streams.run(stream)?.clone();
        let read = self.open(&id)?.read(first, last, bytes_max).ok()??;
        let EventItems { first, count, t_before, bytes: items } = read;
        if items.len() > LENGTH_MAX as usize {
            self.run(stream)?.too_long = Some((first, items.len()));
            return None;
        }
        Some(EventBuffer { first, count, t_before, items })
    }

    fn snapshot(&mut self, stream: StreamId) -> Option<(u64, Vec<u8>)> {
        let now = self.place.clock.now();
        let run = self.run(stream).filter(|_| !ids::is_about(stream))?;
        let (snapshot, told) = run.snapshot.as_ref()?;
        // The runner sends changes only, so that the elapsed time is added.
        let since_ms =
            if run.fate == RunFate::Live { millis(now.saturating_sub(*told)) } else { 0 };
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
