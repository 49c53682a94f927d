//! What is on its way to one client, bounded by its bytes: frames in two lanes, each in order. Does not know what they say.

use axum::extract::ws::{CloseFrame, Message, Utf8Bytes};
use rafcon_locks::Mutex;
use std::collections::VecDeque;
use tokio::sync::{AcquireError, Notify, Semaphore, SemaphorePermit, watch};

/// With so many bytes under way nothing more is fetched for a client; what is about to come may go beyond it.
pub(super) const FULL: usize = 256 << 10;

/// After so many frames of the latest truth in a row one of history is sent, however much truth there is.
const STATUS_IN_A_ROW: u32 = 8;

/// Frames are sent, and those who wait for room stand, in one of two lanes, so that the latest truth does not wait for history:
/// neither for it to be read, nor for a slow network to take it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lane {
    /// Told whole.
    History,
    /// The latest truth, and answers.
    Status,
}

/// How many bytes were put in so far, and how many of them the client has taken.
#[derive(Debug, Clone, Copy, Default)]
struct Flow {
    put: usize,
    sent: usize,
}

/// The same for each lane.
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

    /// How many bytes are under way.
    fn bytes(&self) -> usize {
        self.history.put - self.history.sent + self.status.put - self.status.sent
    }
}

/// By which it is known when a frame was taken; none: there was no frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Ticket(Option<(Lane, usize)>);

/// The frames that wait.
#[derive(Debug, Default)]
struct Frames {
    history: VecDeque<Message>,
    status: VecDeque<Message>,
    /// So many frames of the latest truth were sent since the last one of history.
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

    /// Puts a text frame in, whether there is room or not: answers are bounded by what was asked.
    pub(super) fn push(&self, lane: Lane, text: impl Into<Utf8Bytes>) -> Ticket {
        self.put(lane, Message::Text(text.into()))
    }

    /// Asks whether the other side is there.
    pub(super) fn ping(&self) {
        self.put(Lane::Status, Message::Ping(axum::body::Bytes::new()));
    }

    /// Puts the last frames in; what the client has not taken yet is left out.
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

    /// Waits until the client has taken enough of what was put in.
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
        // The sender lives as long as `self`, so that there is always an answer.
        drop(self.flows.subscribe().wait_for(is_so).await);
    }

    /// Waits for room and for one's turn in a lane. Whoever has it puts one thing in and gives it back.
    pub(super) async fn turn(&self, lane: Lane) -> Result<SemaphorePermit<'_>, AcquireError> {
        let turn = match lane {
            Lane::History => self.history.acquire().await?,
            Lane::Status => self.status.acquire().await?,
        };
        self.session().await;
        Ok(turn)
    }

    /// The next frame to be sent, and its lane. It counts until [`Self::sent`] says that it was.
    pub(super) async fn next(&self) -> (Lane, Message) {
        loop {
            if let Some(next) = self.frames.lock().take() {
                return next;
            }
            self.filled.notified().await;
        }
    }

    /// So many bytes of a lane were taken.
    pub(super) fn sent(&self, lane: Lane, bytes: usize) {
        self.flows.send_modify(|flows| flows.of_mut(lane).sent += bytes);
    }

    /// How many bytes are under way.
    #[cfg(test)]
    pub(super) fn bytes(&self) -> usize {
        self.flows.borrow().bytes()
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
