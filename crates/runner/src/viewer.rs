//! What one viewer is told, at its own pace: it reads the recorder from its own place, and no branch ever waits for it.

use crate::connection::Sender;
use crate::driver::Driver;
use crate::recorder::{Entry, Read, Record};
use crate::{Clock, Scripts, snapshot};
use rafcon_engine::PathId;
use rafcon_model::OutcomeId;
use rafcon_protocol::{Event, LogLevel, Outcome, Stream, ToViewer, encode};
use std::time::Duration;

/// Records taken at once, so that the recorder is never held for long.
const BATCH: usize = 4096;
/// While things happen, they are told in bundles this far apart.
const BUNDLE_EVERY: Duration = Duration::from_millis(10);
/// Snapshots are at least this far apart, in ms.
const SNAPSHOT_EVERY_MS: u64 = 100;

/// One viewer's view of a run.
#[derive(Debug)]
pub(crate) struct Viewer<'d, S: Scripts> {
    driver: &'d Driver<S>,
    sender: &'d Sender,
    every_event: bool,
    next: u64,
    /// When the last snapshot was sent, in ms since the start.
    last_snapshot_ms: Option<u64>,
    /// Something happened since the last snapshot.
    stale: bool,
    entries: Vec<Entry>,
    lines: Vec<u8>,
}

impl<'d, S: Scripts> Viewer<'d, S> {
    /// A viewer that has seen nothing.
    pub(crate) fn new(driver: &'d Driver<S>, sender: &'d Sender, every_event: bool) -> Self {
        Self {
            driver,
            sender,
            every_event,
            next: 1,
            last_snapshot_ms: None,
            stale: true,
            entries: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Tells everything until the run is over and told, or the viewer is gone.
    pub(crate) fn follow(mut self) {
        while !self.sender.is_lost() {
            if self.tell_new() {
                return;
            }
            self.tell_snapshot();
            self.rest();
        }
    }

    /// Tells what is new; true when nothing more will come.
    fn tell_new(&mut self) -> bool {
        loop {
            let read = self.read();
            if read.missed > 0 {
                self.tell_missed(read.next, read.missed);
            }
            self.stale |= read.next > self.next;
            let caught_up = read.next < self.next + BATCH as u64;
            self.next = read.next;
            self.send_entries();
            if read.closed || self.sender.is_lost() {
                return true;
            }
            if caught_up {
                return false;
            }
        }
    }

    fn read(&mut self) -> Read {
        self.entries.clear();
        let every_event = self.every_event;
        let wanted = |record: &Record| every_event || record.is_rare();
        self.driver.recorder().read(self.next, BATCH, wanted, &mut self.entries)
    }

    fn tell_missed(&mut self, next: u64, missed: u64) {
        let message = format!(
            "this viewer reads too slowly: {missed} events were left out before event {next}"
        );
        let event = Event::Log {
            path: String::new(),
            level: LogLevel::Warning,
            stream: Stream::Engine,
            message,
        };
        let t_ns = self.driver.clock().now_ns();
        self.push(&ToViewer::Event { sequence: next.saturating_sub(1), t_ns, event });
    }

    fn send_entries(&mut self) {
        for Entry { sequence, t_ns, record } in std::mem::take(&mut self.entries) {
            let event = match record {
                Record::Entered(path) => {
                    Event::Entered { path: self.path(path), inputs: None, undoes: None }
                }
                Record::Left(path, outcome) => Event::Left {
                    path: self.path(path),
                    outcome: self.outcome(path, outcome),
                    outputs: None,
                    error: None,
                    undoes: None,
                },
                Record::Told(event) => (*event).clone(),
            };
            self.push(&ToViewer::Event { sequence, t_ns, event });
        }
        self.sender.send_lines(&self.lines);
        self.lines.clear();
    }

    fn push(&mut self, message: &ToViewer) {
        if let Ok(line) = encode(message) {
            self.lines.extend_from_slice(&line);
        }
    }

    fn path(&self, path: PathId) -> String {
        self.driver.places().with(path, |place| place.text.to_string()).unwrap_or_default()
    }

    fn outcome(&self, path: PathId, outcome: OutcomeId) -> Outcome {
        let node = self.driver.places().with(path, |place| place.node);
        let name = node.and_then(|node| {
            Some(self.driver.program().node(node).outcome(outcome)?.name.to_string())
        });
        Outcome { id: outcome.0, name: name.unwrap_or_default() }
    }

    fn tell_snapshot(&mut self) {
        let now = self.driver.clock().now_ms();
        if !self.stale || self.snapshot_due_ms() > now {
            return;
        }
        if let Some(snapshot) = snapshot::take(self.driver) {
            self.sender.send(&ToViewer::Snapshot(snapshot));
        }
        (self.stale, self.last_snapshot_ms) = (false, Some(now));
    }

    fn snapshot_due_ms(&self) -> u64 {
        self.last_snapshot_ms.map_or(0, |last| last + SNAPSHOT_EVERY_MS)
    }

    /// Waits until something is to be told: at least the time between two bundles, and without end while nothing happens.
    fn rest(&self) {
        if let Some(moment) = Clock::moment(BUNDLE_EVERY) {
            self.driver.recorder().wait_closed(moment);
        }
        let due = self.snapshot_due_ms().saturating_sub(self.driver.clock().now_ms());
        let deadline = if self.stale { Clock::moment(Duration::from_millis(due)) } else { None };
        self.driver.recorder().wait(self.next, deadline);
    }
}
