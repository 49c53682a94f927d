//! Publishers: each has a queue before its writer, so that a stuck subscriber does not block others.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use futures::FutureExt as _;
use rustdds::bytes::Bytes;
use rustdds::dds::result::WriteError;
use rustdds::{GUID, RTPSEntity as _, Timestamp};
use tokio::sync::Notify;

use super::participant::{Node, Writer};
use super::payload::Payload;

/// Timeout for the acknowledgment of a closed publisher's last messages.
const FAREWELL: Duration = Duration::from_millis(800);
/// Capacity of the queue in messages, also if a smaller depth is requested.
const WAITING: usize = 1000;
/// Capacity of the queue in bytes, without the newest message.
const WAITING_BYTES: usize = 64 << 20;

/// Publishes on a topic.
pub(crate) struct Publisher {
    pub(crate) id: GUID,
    writer: Arc<Writer>,
    queue: Arc<Queue>,
    task: tokio::task::JoinHandle<()>,
}

struct Queue {
    waiting: Mutex<Waiting>,
    more: Notify,
}

#[derive(Default)]
struct Waiting {
    messages: VecDeque<Bytes>,
    bytes: usize,
    /// True while a message that was taken out is not yet written.
    writing: bool,
    ended: bool,
}

impl Waiting {
    /// Adds a message. Returns the number of older messages dropped for it.
    fn push(&mut self, message: Bytes) -> usize {
        let mut dropped = 0;
        while self.messages.len() >= WAITING || self.bytes > WAITING_BYTES {
            let Some(oldest) = self.messages.pop_front() else { break };
            self.bytes -= oldest.len();
            dropped += 1;
        }
        self.bytes += message.len();
        self.messages.push_back(message);
        dropped
    }

    fn pop(&mut self) -> Option<Bytes> {
        let next = self.messages.pop_front();
        self.bytes -= next.as_ref().map_or(0, Bytes::len);
        next
    }
}

impl Queue {
    fn waiting(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Publisher {
    /// Starts a task that publishes queued messages by `writer`.
    pub(crate) fn new(node: Node, writer: Writer) -> Self {
        let queue = Arc::new(Queue { waiting: Mutex::default(), more: Notify::new() });
        let (id, writer) = (writer.guid(), Arc::new(writer));
        let task = tokio::spawn(publish(node, Arc::clone(&writer), Arc::clone(&queue)));
        Self { id, writer, queue, task }
    }

    /// Sends a message. Returns the number of older messages dropped because subscribers are too slow.
    pub(crate) fn send(&self, message: Bytes) -> usize {
        let mut waiting = self.queue.waiting();
        // Write directly if nothing is queued, to keep the order with other messages of this process.
        if waiting.messages.is_empty() && !waiting.writing {
            let written = write(&self.writer, message.clone()).now_or_never();
            if !matches!(written, None | Some(Err(WriteError::WouldBlock { .. }))) {
                return 0;
            }
        }
        let dropped = waiting.push(message);
        drop(waiting);
        self.queue.more.notify_one();
        dropped
    }

    /// Closes the publisher after its last messages are acknowledged, or after a timeout.
    pub(crate) fn end(self) -> tokio::task::JoinHandle<()> {
        self.queue.waiting().ended = true;
        self.queue.more.notify_one();
        self.task
    }
}

async fn write(writer: &Writer, bytes: Bytes) -> Result<(), WriteError<Payload>> {
    writer.async_write(Payload { bytes, little: true }, Some(Timestamp::now())).await
}

async fn publish(node: Node, writer: Arc<Writer>, queue: Arc<Queue>) {
    loop {
        let next = {
            let mut waiting = queue.waiting();
            let next = waiting.pop();
            waiting.writing = next.is_some();
            if next.is_none() && waiting.ended {
                break;
            }
            next
        };
        let Some(bytes) = next else {
            queue.more.notified().await;
            continue;
        };
        // Wait for a subscriber with thousands of unacknowledged messages.
        while let Err(WriteError::WouldBlock { .. }) = write(&writer, bytes.clone()).await
            && !queue.waiting().ended
        {}
    }
    arrived(&writer, FAREWELL).await;
    node.forget(writer.guid());
}

/// Waits until all sent messages are acknowledged, or until the timeout.
pub(crate) async fn arrived(writer: &Writer, longest: Duration) {
    let _ = tokio::time::timeout(longest, writer.async_wait_for_acknowledgments()).await;
}

#[cfg(test)]
mod tests {
    use rustdds::bytes::Bytes;

    use super::{WAITING, WAITING_BYTES, Waiting};

    /// Pushes messages of these lengths, and returns the number dropped for the last one.
    fn pushed(queue: &mut Waiting, lengths: impl IntoIterator<Item = usize>) -> usize {
        let content = Bytes::from(vec![7; WAITING_BYTES + 1]);
        lengths.into_iter().fold(0, |_, length| queue.push(content.slice(..length)))
    }

    #[test]
    fn of_too_many_messages_the_oldest_is_dropped_and_the_others_stay_in_order() {
        let mut queue = Waiting::default();
        assert_eq!(pushed(&mut queue, 0..WAITING), 0);
        assert_eq!(pushed(&mut queue, [WAITING]), 1);
        let first = [queue.pop(), queue.pop()].map(|message| message.unwrap().len());
        assert_eq!(first, [1, 2]);
        assert_eq!(pushed(&mut queue, [0, 0]), 0);
        assert_eq!((pushed(&mut queue, [0]), queue.messages.len()), (1, WAITING));
    }

    #[test]
    fn of_too_many_bytes_the_oldest_messages_are_dropped_and_the_newest_is_kept() {
        let mut queue = Waiting::default();
        assert_eq!(pushed(&mut queue, [1, WAITING_BYTES - 1, 1]), 0);
        assert_eq!(pushed(&mut queue, [WAITING_BYTES + 1]), 1);
        assert_eq!(pushed(&mut queue, [5]), 3);
        assert_eq!((queue.messages.len(), queue.bytes), (1, 5));
        assert_eq!(queue.pop().map(|message| message.len()), Some(5));
        assert_eq!((queue.pop(), queue.bytes), (None, 0));
    }
}
