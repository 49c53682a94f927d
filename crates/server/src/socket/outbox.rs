//! What is on its way to one client: frames in order, bounded by their bytes. Must never know what they say.

use axum::extract::ws::{CloseFrame, Message, Utf8Bytes};
use parking_lot::Mutex;
use std::collections::VecDeque;
use tokio::sync::{AcquireError, Notify, Semaphore, SemaphorePermit, watch};

/// With so many bytes under way nothing more is fetched for a client; what is about to come may go beyond it.
pub(super) const FULL: usize = 256 << 10;

/// Those who wait for room stand in one of two lines, so that the latest truth does not wait for history to be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lane {
    /// Told whole.
    History,
    /// The latest truth.
    Status,
}

/// How many bytes were put in so far, and how many of them the client has taken.
#[derive(Debug, Clone, Copy, Default)]
struct Flow {
    put: usize,
    sent: usize,
}

/// By which it is known when a frame was taken.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Ticket(usize);

/// The frames that one client has not taken yet.
#[derive(Debug)]
pub(super) struct Outbox {
    frames: Mutex<VecDeque<Message>>,
    filled: Notify,
    flow: watch::Sender<Flow>,
    history: Semaphore,
    status: Semaphore,
}

impl Outbox {
    pub(super) fn new() -> Self {
        Self {
            frames: Mutex::default(),
            filled: Notify::new(),
            flow: watch::Sender::default(),
            history: Semaphore::new(1),
            status: Semaphore::new(1),
        }
    }

    /// Puts a text frame in, whether there is room or not: answers are bounded by what was asked.
    pub(super) fn push(&self, text: impl Into<Utf8Bytes>) -> Ticket {
        self.put(Message::Text(text.into()))
    }

    /// Asks whether the other side is there.
    pub(super) fn ping(&self) {
        self.put(Message::Ping(axum::body::Bytes::new()));
    }

    /// Puts the last frames in; what the client has not taken yet is left out.
    pub(super) fn farewell(&self, text: String, close: CloseFrame) {
        self.frames.lock().clear();
        self.put(Message::Text(text.into()));
        self.put(Message::Close(Some(close)));
    }

    fn put(&self, frame: Message) -> Ticket {
        let mut frames = self.frames.lock();
        let mut ticket = Ticket::default();
        self.flow.send_modify(|flow| {
            flow.put += length(&frame);
            ticket = Ticket(flow.put);
        });
        frames.push_back(frame);
        self.filled.notify_one();
        ticket
    }

    /// Waits until the client has taken enough of what was put in.
    pub(super) async fn room(&self) {
        self.until(|flow| flow.put - flow.sent < FULL).await;
    }

    /// Waits until the client has taken a frame.
    pub(super) async fn taken(&self, Ticket(end): Ticket) {
        self.until(|flow| flow.sent >= end).await;
    }

    async fn until(&self, is_so: impl Fn(&Flow) -> bool) {
        // The sender lives as long as `self`, so that there is always an answer.
        drop(self.flow.subscribe().wait_for(is_so).await);
    }

    /// Waits for room and for one's turn in a lane. Whoever has it puts one thing in and gives it back.
    pub(super) async fn turn(&self, lane: Lane) -> Result<SemaphorePermit<'_>, AcquireError> {
        let turn = match lane {
            Lane::History => self.history.acquire().await?,
            Lane::Status => self.status.acquire().await?,
        };
        self.room().await;
        Ok(turn)
    }

    /// The next frame to be sent. It counts until [`Self::sent`] is told of it.
    pub(super) async fn next(&self) -> Message {
        loop {
            if let Some(frame) = self.frames.lock().pop_front() {
                return frame;
            }
            self.filled.notified().await;
        }
    }

    /// So many bytes were taken.
    pub(super) fn sent(&self, bytes: usize) {
        self.flow.send_modify(|flow| flow.sent += bytes);
    }

    /// How many bytes are under way.
    #[cfg(test)]
    pub(super) fn bytes(&self) -> usize {
        let flow = *self.flow.borrow();
        flow.put - flow.sent
    }
}

/// What a frame counts.
pub(super) fn length(frame: &Message) -> usize {
    match frame {
        Message::Text(text) => text.len(),
        Message::Binary(bytes) | Message::Ping(bytes) | Message::Pong(bytes) => bytes.len(),
        Message::Close(_) => 0,
    }
}
