//! Sends a subscription's frames when there is data, its interval has passed, and the outbox has room. Knows frames as text and
//! the outbox, but not the content.

use super::outbox::{Lane, Outbox, Ticket};
use tokio::time::{Instant, sleep_until};

/// The next frame of a subscription.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum NextMessage {
    /// A frame; the next one waits for its time.
    Now(String),
    /// A frame, followed by more without delay.
    Part(String),
    /// No frame is available yet.
    Nothing,
    /// The last frame. The subscription then ends.
    Last(String),
}

/// The source of a subscription's frames.
pub(super) trait Feed: Send {
    /// Lane of its frames in the outbox.
    const LANE: Lane;

    /// Earliest time of the next frame after one that was not a part.
    fn next_time(&self) -> Instant;

    /// Waits until there may be a frame.
    fn ready(&mut self) -> impl Future<Output = ()> + Send;

    /// The next frame. Called only when the outbox has room, so that no data is held for a slow client.
    fn take(&mut self) -> impl Future<Output = NextMessage> + Send;
}

/// Sends the frames of a subscription until its end.
pub(super) async fn tell(feed: impl Feed, outbox: &Outbox) {
    let (due, last) = (Instant::now(), Ticket::default());
    let mut telling = Telling { feed, outbox, due, last };
    while telling.step().await {}
}

struct Telling<'o, F> {
    feed: F,
    outbox: &'o Outbox,
    /// Earliest time of the next frame.
    due: Instant,
    /// The last frame. The next one is made only after the client has taken it.
    last: Ticket,
}

impl<F: Feed> Telling<'_, F> {
    /// Sends at most one frame. Returns `false` after the last one.
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
