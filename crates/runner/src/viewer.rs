//! What one viewer is told, at its own pace: it reads the recorder from its own place, and no branch ever waits for it.

use crate::archive::Archive;
use crate::blocks::Chunk;
use crate::connection::Sender;
use crate::driver::Driver;
use crate::record_encoder::is_rare;
use crate::record_renderer::RecordRenderer;
use crate::{Clock, Scripts, snapshot};
use rafcon_protocol::{Event, Join, LogLevel, Stream, ToViewer, encode};
use rafcon_storage::journal::Record;
use std::time::Duration;

/// While things happen, they are told in bundles this far apart.
const BUNDLE_EVERY: Duration = Duration::from_millis(10);
/// Snapshots are at least this far apart, in ms.
const SNAPSHOT_EVERY_MS: u64 = 100;

/// One viewer's view of a run.
#[derive(Debug)]
pub(crate) struct Viewer<'d, S: Scripts> {
    driver: &'d Driver<S>,
    sender: &'d Sender,
    join: Join,
    next: u64,
    /// When the last snapshot was sent, in ms since the start.
    last_snapshot_ms: Option<u64>,
    /// Something happened since the last snapshot.
    stale: bool,
    /// The last record that is in a snapshot, or will be in the next.
    seen: u64,
    chunk: Chunk,
    archive: Archive,
    lines: Vec<u8>,
}

impl<'d, S: Scripts> Viewer<'d, S> {
    /// A viewer that has seen everything before what it asks for.
    pub(crate) fn new(driver: &'d Driver<S>, sender: &'d Sender, join: &Join) -> Self {
        let next = if join.from == 0 { driver.recorder().tellable() } else { join.from };
        Self {
            driver,
            sender,
            join: join.clone(),
            next,
            last_snapshot_ms: None,
            stale: true,
            seen: 0,
            chunk: Chunk::default(),
            archive: Archive::default(),
            lines: Vec::new(),
        }
    }

    /// Tells everything until the run is over and told, or the viewer is gone.
    pub(crate) fn follow(mut self) {
        while !self.sender.is_lost() {
            if self.tell_new() {
                return;
            }
            self.rest();
        }
    }

    /// Tells what is new, and how things stand in between: events may come faster than they can be told, without end. True when
    /// nothing more will come.
    fn tell_new(&mut self) -> bool {
        loop {
            let rare = !self.join.every_event;
            let read = self.driver.recorder().read(self.next, rare, &mut self.chunk);
            let caught_up = read.next == self.next;
            self.stale |= !caught_up;
            if read.missed > 0 {
                self.tell_old(self.next + read.missed);
                continue;
            }
            self.next = read.next;
            self.send_chunk();
            if read.closed || self.sender.is_lost() {
                return true;
            }
            self.tell_snapshot();
            if caught_up {
                return false;
            }
        }
    }

    /// Tells what only the journal still has, before event `end`; all of it, or that it is lost.
    fn tell_old(&mut self, end: u64) {
        while self.next < end && !self.sender.is_lost() {
            let Some(page) = self.archive.page(self.driver.recorder().folder(), self.next, end)
            else {
                self.tell_missed(end, end - self.next);
                self.next = end;
                return;
            };
            self.next = page.last().map_or(end, |(sequence, ..)| sequence + 1);
            let rare = !self.join.every_event;
            self.send(page.into_iter().filter(|(.., record)| !rare || is_rare(record)));
            self.tell_snapshot();
        }
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

    fn send_chunk(&mut self) {
        let chunk = std::mem::take(&mut self.chunk);
        self.send(chunk.records());
        self.chunk = chunk;
    }

    /// Sends records that the viewer wants, with number and time.
    fn send(&mut self, records: impl Iterator<Item = (u64, u64, Record)>) {
        let mut archive = std::mem::take(&mut self.archive);
        let wording = RecordRenderer::new(self.driver.recorder(), &mut archive, self.join.values);
        for (sequence, t_ns, record) in records {
            if let Some(event) = wording.event(sequence, record) {
                self.push(&ToViewer::Event { sequence, t_ns, event });
            }
        }
        self.archive = archive;
        self.flush();
    }

    fn flush(&mut self) {
        if !self.lines.is_empty() {
            self.sender.send_lines(&self.lines);
            self.lines.clear();
        }
    }

    fn push(&mut self, message: &ToViewer) {
        if let Ok(line) = encode(message) {
            self.lines.extend_from_slice(&line);
        }
    }

    fn tell_snapshot(&mut self) {
        let last = self.driver.recorder().last();
        self.stale |= last > self.seen;
        self.seen = last;
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
        self.driver.recorder().wait_closed(Clock::moment(BUNDLE_EVERY));
        let due = self.snapshot_due_ms().saturating_sub(self.driver.clock().now_ms());
        let deadline = if self.stale { Clock::moment(Duration::from_millis(due)) } else { None };
        self.driver.recorder().wait(self.next, self.seen, deadline);
    }
}
