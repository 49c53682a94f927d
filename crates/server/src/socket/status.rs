//! Subscriptions to the latest truth: the first change at once, then at most one frame in a tenth of a second, whatever
//! happened in between. Knows watches; must never know what is watched.

use super::feed::{Feed, NextMessage};
use super::outbox::Lane;
use super::words;
use std::time::Duration;
use tokio::sync::watch;

/// Something of which only the latest counts, and how it is told.
#[derive(Debug)]
pub(super) struct Status<T, F> {
    watch: watch::Receiver<T>,
    tell: F,
    /// Whoever changed it is gone: nothing more will come.
    is_over: bool,
    subscription: u32,
}

impl<T, F: FnMut(&T) -> String> Status<T, F> {
    /// The first frame tells how things stand now.
    pub(super) fn new(subscription: u32, mut watch: watch::Receiver<T>, tell: F) -> Self {
        watch.mark_changed();
        Self { watch, tell, is_over: false, subscription }
    }
}

impl<T: Send + Sync, F: FnMut(&T) -> String + Send> Feed for Status<T, F> {
    const EVERY: Duration = Duration::from_millis(100);
    const LANE: Lane = Lane::Status;

    async fn ready(&mut self) {
        self.is_over = self.watch.changed().await.is_err();
    }

    async fn take(&mut self) -> NextMessage {
        if self.is_over {
            return NextMessage::Last(words::text(&words::ended(self.subscription, None)));
        }
        NextMessage::Now((self.tell)(&self.watch.borrow_and_update()))
    }
}
