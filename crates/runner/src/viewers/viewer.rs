//! Sends events to one viewer, at the viewer's pace. It reads the recorder at its own position, and no branch ever
//! waits for it.

use crate::drive::driver::Driver;
use crate::drive::snapshot;
use crate::record::blocks::{Archive, Chunk};
use crate::record::record_encoder::is_rare;
use crate::viewers::connection::{IncomingLine, Receiver, Sender};
use crate::{Clock, Scripts};
use rafcon_protocol::{
    EnginePulse, FRAME_HEAD, FrameKind, Join, LogLevel, Stream, ToRunner, ToViewer, decode,
    frame_head,
};
use rafcon_storage::journal::stream::StreamBlock;
use rafcon_storage::journal::{Item, Record};
use std::sync::mpsc::{self, SyncSender};
use std::time::Duration;

/// Interval between bundles of events.
const BUNDLE_EVERY: Duration = Duration::from_millis(10);
/// Minimum interval between snapshots, in ms.
const SNAPSHOT_EVERY_MS: u64 = 100;

/// The state of one viewer's event stream.
#[derive(Debug)]
pub(crate) struct Viewer<'d, S: Scripts> {
    driver: &'d Driver<S>,
    sender: &'d Sender,
    join: Join,
    next: u64,
    /// Time of the last snapshot, in ms since the start.
    last_snapshot_ms: Option<u64>,
    /// True if an event happened since the last snapshot.
    stale: bool,
    /// The last record that a snapshot contains, or that the next one will contain.
    seen: u64,
    chunk: Chunk,
    archive: Archive,
    /// The next frame of events: room for its head, then blocks.
    frame: Vec<u8>,
}

impl<'d, S: Scripts> Viewer<'d, S> {
    /// A viewer that has received everything before the requested event.
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
            frame: vec![0; FRAME_HEAD],
        }
    }

    /// Sends all events until the run is over, or the viewer is lost.
    pub(crate) fn follow(mut self) {
        self.driver.recorder().names().write(&mut self.frame);
        self.flush();
        while !self.sender.is_lost() {
            if self.tell_new() {
                return;
            }
            self.rest();
        }
    }

    /// Sends new events, and snapshots between them, because events may come faster than they can be sent. True when no
    /// more events will follow.
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

    /// Sends events that only the journal contains, before event `end`. If they are unavailable, reports the gap.
    fn tell_old(&mut self, end: u64) {
        while self.next < end && !self.sender.is_lost() {
            let Some(page) = self.archive.page(self.driver.recorder().folder(), self.next, end)
            else {
                self.tell_missed(end, end - self.next);
                self.next = end;
                return;
            };
            self.next = page.last().map_or(end, |(sequence, ..)| sequence + 1);
            for (sequence, t_ns, record) in page {
                if self.join.every_event || is_rare(&record) {
                    self.push(sequence, t_ns, record);
                }
            }
            self.flush();
            self.tell_snapshot();
        }
    }

    fn tell_missed(&mut self, next: u64, missed: u64) {
        let message = format!(
            "this viewer reads too slowly: {missed} events were left out before event {next}"
        );
        let (level, stream) = (LogLevel::Warning, Stream::Engine);
        let record = Record::Log { place: None, level, stream, message };
        self.push(next.saturating_sub(1), self.driver.clock().now_ns(), record);
        self.flush();
    }

    fn send_chunk(&mut self) {
        self.chunk.blocks().for_each(|block| block.write(&mut self.frame));
        self.flush();
    }

    /// Adds one event to the next frame.
    fn push(&mut self, sequence: u64, t_ns: u64, record: Record) {
        let mut items = Vec::new();
        Item::Record(t_ns, record).write(&mut t_ns.clone(), &mut items);
        StreamBlock { first: sequence, t_before: t_ns, items: &items }.write(&mut self.frame);
    }

    /// Sends the frame unless it is empty.
    fn flush(&mut self) {
        let length = self.frame.len() - FRAME_HEAD;
        if length > 0 {
            self.frame[..FRAME_HEAD].copy_from_slice(&frame_head(FrameKind::Events, length));
            self.sender.send_frame(&self.frame);
            self.frame.truncate(FRAME_HEAD);
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

    /// Waits for something to send: at least the bundle interval, and without limit while nothing happens.
    fn rest(&self) {
        self.driver.recorder().wait_closed(Clock::moment(BUNDLE_EVERY));
        let due = self.snapshot_due_ms().saturating_sub(self.driver.clock().now_ms());
        let deadline = if self.stale { Clock::moment(Duration::from_millis(due)) } else { None };
        self.driver.recorder().wait(self.next, self.seen, deadline);
    }
}

/// Capacity of the queue of one viewer's lines. While it is full, the viewer is not read.
const WAITING: usize = 64;

/// The queue from the thread that reads a viewer to the thread that handles its lines.
pub(crate) fn way() -> (SyncSender<IncomingLine>, mpsc::Receiver<IncomingLine>) {
    mpsc::sync_channel(WAITING)
}

/// Reads one viewer until it disconnects, or its lines are no longer handled; `pulse` checks the engine.
pub(crate) fn hear(
    mut receiver: Receiver,
    sender: &Sender,
    rest: &SyncSender<IncomingLine>,
    pulse: impl Fn() -> EnginePulse,
) {
    while let Some(words) = receiver.line() {
        match ping(&words) {
            Some(id) => {
                let engine = Some(pulse());
                sender.send(&ToViewer::Pong { id, now_ms: Clock::epoch_ms(), engine, link: None });
            }
            None if rest.send(words).is_err() => return,
            None => {}
        }
    }
}

fn ping(words: &IncomingLine) -> Option<u64> {
    let IncomingLine::Text(text) = words else { return None };
    match decode(text) {
        Ok(ToRunner::Ping { id }) => Some(id),
        _ => None,
    }
}
