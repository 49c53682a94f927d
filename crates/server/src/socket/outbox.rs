//! The frames queued for one client, limited in bytes: two lanes, each in order. Does not know the content.

use axum::extract::ws::{CloseFrame, Message, Utf8Bytes};
use rafcon_locks::Mutex;
use std::collections::VecDeque;
use tokio::sync::{AcquireError, Notify, Semaphore, SemaphorePermit, watch};

/// Capacity in bytes. At the limit no more frames are made; those already in progress may exceed it.
pub(super) const FULL: usize = 256 << 10;

/// Maximum number of consecutive status frames while history waits.
const STATUS_IN_A_ROW: u32 = 8;

/// Frames, and producers that wait for room, are divided into two lanes, so that a status never waits for history: neither for
/// its read, nor for its transfer over a slow network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lane {
    /// Complete sequences of events or revisions.
    History,
    /// Statuses, and replies to requests.
    Status,
}

/// Bytes queued in a lane, and bytes taken by the client.
#[derive(Debug, Clone, Copy, Default)]
struct Flow {
    put: usize,
    sent: usize,
}

/// The byte counts of both lanes.
#[derive(Debug, Clone, Copy, Default)]
struct Flows {
    history: Flow,
    status: Flow,
}

impl Flows {
    fn of(&self, lane: Lane) -> &Flow {
        match lane {
            Lane::History => &self.history,
            Lane::Status => &self.status,
        }
    }

    fn of_mut(&mut self, lane: Lane) -> &mut Flow {
        match lane {
            Lane::History => &mut self.history,
            Lane::Status => &mut self.status,
        }
    }

    /// Number of bytes in transit.
    fn bytes(&self) -> usize {
        self.history.put - self.history.sent + self.status.put - self.status.sent
    }
}

/// Identifies a frame, to wait until it is taken. Empty without a frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Ticket(Option<(Lane, usize)>);

/// The queued frames of both lanes.
#[derive(Debug, Default)]
struct Frames {
    history: VecDeque<Message>,
    status: VecDeque<Message>,
    /// Number of status frames sent since the last history frame.
    in_a_row: u32,
}

impl Frames {
    fn put(&mut self, lane: Lane, frame: Message) {
        match lane {
            Lane::History => self.history.push_back(frame),
            Lane::Status => self.status.push_back(frame),
        }
    }

    fn take(&mut self) -> Option<(Lane, Message)> {
        let is_turn = self.status.is_empty() || self.in_a_row >= STATUS_IN_A_ROW;
        if is_turn && let Some(frame) = self.history.pop_front() {
            self.in_a_row = 0;
            return Some((Lane::History, frame));
        }
        self.in_a_row = self.in_a_row.saturating_add(1);
        self.status.pop_front().map(|frame| (Lane::Status, frame))
    }

    fn clear(&mut self) {
        *self = Self::default();
    }
}

/// The frames that one client has not taken yet.
#[derive(Debug)]
pub(super) struct Outbox {
    frames: Mutex<Frames>,
    filled: Notify,
    flows: watch::Sender<Flows>,
    history: Semaphore,
    status: Semaphore,
}

impl Outbox {
    pub(super) fn new() -> Self {
        Self {
            frames: Mutex::default(),
            filled: Notify::new(),
            flows: watch::Sender::default(),
            history: Semaphore::new(1),
            status: Semaphore::new(1),
        }
    }

    /// Queues a text frame regardless of the capacity: replies are limited by the number of requests.
    pub(super) fn push(&self, lane: Lane, text: impl Into<Utf8Bytes>) -> Ticket {
        self.put(lane, Message::Text(text.into()))
    }

    /// Queues a ping to the client.
    pub(super) fn ping(&self) {
        self.put(Lane::Status, Message::Ping(axum::body::Bytes::new()));
    }

    /// Discards all queued frames and queues the last ones.
    pub(super) fn farewell(&self, text: String, close: CloseFrame) {
        self.frames.lock().clear();
        self.put(Lane::Status, Message::Text(text.into()));
        self.put(Lane::Status, Message::Close(Some(close)));
    }

    fn put(&self, lane: Lane, frame: Message) -> Ticket {
        let mut frames = self.frames.lock();
        let mut ticket = Ticket::default();
        self.flows.send_modify(|flows| {
            let flow = flows.of_mut(lane);
            flow.put += length(&frame);
            ticket = Ticket(Some((lane, flow.put)));
        });
        frames.put(lane, frame);
        self.filled.notify_one();
        ticket
    }

    /// Waits until the queue is below its capacity.
    pub(super) async fn session(&self) {
        self.until(|flows| flows.bytes() < FULL).await;
    }

    /// Waits until the client has taken a frame.
    pub(super) async fn taken(&self, Ticket(ticket): Ticket) {
        if let Some((lane, end)) = ticket {
            self.until(|flows| flows.of(lane).sent >= end).await;
        }
    }

    async fn until(&self, is_so: impl Fn(&Flows) -> bool) {
        // The sender lives as long as `self`, so the wait cannot fail.
        drop(self.flows.subscribe().wait_for(is_so).await);
    }

    /// Waits for room and for exclusive use of a lane. The holder queues one item and releases it.
    pub(super) async fn turn(&self, lane: Lane) -> Result<SemaphorePermit<'_>, AcquireError> {
        let turn = match lane {
            Lane::History => self.history.acquire().await?,
            Lane::Status => self.status.acquire().await?,
        };
        self.session().await;
        Ok(turn)
    }

    /// The next frame and its lane. It counts as queued until [`Self::sent`] confirms it.
    pub(super) async fn next(&self) -> (Lane, Message) {
        loop {
            if let Some(next) = self.frames.lock().take() {
                return next;
            }
            self.filled.notified().await;
        }
    }

    /// Confirms that the client has taken these bytes of a lane.
    pub(super) fn sent(&self, lane: Lane, bytes: usize) {
        self.flows.send_modify(|flows| flows.of_mut(lane).sent += bytes);
    }

    /// Number of bytes in transit.
    #[cfg(test)]
    pub(super) fn bytes(&self) -> usize {
        self.flows.borrow().bytes()
    }
}

/// Size of a frame in bytes.
pub(super) fn length(frame: &Message) -> usize {
    match frame {
        Message::Text(text) => text.len(),
        Message::Binary(bytes) | Message::Ping(bytes) | Message::Pong(bytes) => bytes.len(),
        Message::Close(_) => 0,
    }
}
