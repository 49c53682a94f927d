//! How a subscription is told: when there is something, when it is due, and when there is room. Knows frames as text and the
//! outbox; must never know what they are about.

use super::outbox::{Lane, Outbox};
use std::time::Duration;
use tokio::time::{Instant, sleep_until};

/// What there is to tell of a subscription.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Told {
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
    /// Two frames are at least so far apart, unless the first was a part.
    const EVERY: Duration;
    /// Where it stands in line.
    const LANE: Lane;

    /// Waits until there may be something to tell.
    fn ready(&mut self) -> impl Future<Output = ()> + Send;

    /// What there is to tell now. Asked when there is room: nothing is held while a client does not take it.
    fn take(&mut self) -> impl Future<Output = Told> + Send;
}

/// Tells a subscription until nothing more will come.
pub(super) async fn tell(mut feed: impl Feed, outbox: &Outbox) {
    let mut due = Instant::now();
    while step(&mut feed, outbox, &mut due).await {}
}

/// One frame, or none; false after the last.
async fn step<F: Feed>(feed: &mut F, outbox: &Outbox, due: &mut Instant) -> bool {
    feed.ready().await;
    sleep_until(*due).await;
    let Ok(_turn) = outbox.turn(F::LANE).await else { return false };
    match feed.take().await {
        Told::Now(frame) => {
            *due = Instant::now() + F::EVERY;
            outbox.push(frame);
        }
        Told::Part(frame) => outbox.push(frame),
        Told::Nothing => {}
        Told::Last(frame) => {
            outbox.push(frame);
            return false;
        }
    }
    true
}
