//! The record of one run with the run's clock, until the run is over. Called on any thread, also by the holder of the
//! engine: it takes the lock of the recorder, and no other lock for which a writer of the record waits.

use crate::Clock;
use crate::record::recorder::Recorder;
use crate::record::tell;
use rafcon_locks::Mutex;
use rafcon_protocol::Event;
use rafcon_storage::journal::Record;
use std::sync::Arc;

/// The record of one run with its clock.
#[derive(Debug)]
pub(crate) struct RunRecord {
    recorder: Arc<Recorder>,
    clock: Clock,
    /// True once the run's last event is recorded. Locked while another record that may come later is written.
    is_over: Mutex<bool>,
}

impl RunRecord {
    pub(crate) fn new(recorder: Recorder, clock: Clock) -> Self {
        Self { recorder: Arc::new(recorder), clock, is_over: Mutex::new(false) }
    }

    pub(crate) fn recorder(&self) -> &Arc<Recorder> {
        &self.recorder
    }

    pub(crate) fn clock(&self) -> Clock {
        self.clock
    }

    /// Records what has happened now, in one group.
    pub(crate) fn note(&self, records: impl IntoIterator<Item = Record>) {
        self.recorder.push(self.clock.now_ns(), records);
    }

    /// Records one event now.
    pub(crate) fn tell(&self, event: Event) {
        self.note([tell::told(event)]);
    }

    /// Writes a record that may come after the run's last event, and then is dropped.
    pub(crate) fn note_until_over(&self, record: Record) {
        let is_over = self.is_over.lock();
        if !*is_over {
            self.note([record]);
        }
    }

    /// Records the run's last event.
    pub(crate) fn end(&self, last: Event) {
        let mut is_over = self.is_over.lock();
        *is_over = true;
        self.tell(last);
    }
}
