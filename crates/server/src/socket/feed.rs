//! How a subscription is told: when there is something, when it is due, and when there is room. Knows frames as text and the
//! outbox, but not what they are about.

use super::outbox::{Lane, Outbox, Ticket};
use tokio::time::{Instant, sleep_until};

/// What there is to tell of a subscription.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum NextMessage {
    /// A frame; the next one may wait until it is due.
    Now(String),
    /// A frame, and more behind it.
    Part(String),
    /// Nothing yet.
    Nothing,
    /// The last frames: nothing more will come.
    Last(String),
}

/// What a subscription is told from.
pub(super) trait Feed: Send {
    /// Where it stands in line.
    const LANE: Lane;

    /// When the next frame may come after one that was no part.
    fn next_time(&self) -> Instant;

    /// Waits until there may be something to tell.
    fn ready(&mut self) -> impl Future<Output = ()> + Send;

    /// What there is to tell now. Asked when there is room: nothing is held while a client does not take it.
    fn take(&mut self) -> impl Future<Output = NextMessage> + Send;
}

/// Tells a subscription until nothing more will come.
pub(super) async fn tell(feed: impl Feed, outbox: &Outbox) {
    let (due, last) = (Instant::now(), Ticket::default());
    let mut telling = Telling { feed, outbox, due, last };
    while telling.step().await {}
}

struct Telling<'o, F> {
    feed: F,
    outbox: &'o Outbox,
    /// When the next frame may come.
    due: Instant,
    /// The last frame: the next one is made when the client has taken it.
    last: Ticket,
}

impl<F: Feed> Telling<'_, F> {
    /// One frame, or none; false after the last.
    async fn step(&mut self) -> bool {
        self.feed.ready().await;
        sleep_until(self.due).await;
        self.outbox.taken(self.last).await;
        let Ok(_turn) = self.outbox.turn(F::LANE).await else { return false };
        match self.feed.take().await {
            NextMessage::Now(frame) => {
                self.due = self.feed.next_time();
                self.last = self.outbox.push(F::LANE, frame);
            }
            NextMessage::Part(frame) => self.last = self.outbox.push(F::LANE, frame),
            NextMessage::Nothing => {}
            NextMessage::Last(frame) => {
                self.outbox.push(F::LANE, frame);
                return false;
            }
        }
        true
    }
}

#[cfg(test)]
mod tests;
