//! Subscriptions to a status: the first change is sent at once, then at most one frame per 100 ms. Also for the status of the
//! whole server. Does not know the kind of a change.

use super::feed::{Feed, NextMessage};
use super::outbox::Lane;
use super::words;
use crate::ServerState;
use rafcon_protocol::socket::ToClient;
use std::sync::Arc;
use std::time::Duration;
use tokio::select;
use tokio::sync::watch;
use tokio::time::Instant;

/// Minimum interval between two frames of a status.
const INTERVAL: Duration = Duration::from_millis(100);

/// The status of the server, followed by one client.
#[derive(Debug)]
pub(super) struct ServerStatusFeed {
    server: Arc<ServerState>,
    subscription: u32,
    files: watch::Receiver<u64>,
    machines: watch::Receiver<u64>,
    runs: watch::Receiver<u64>,
}

impl ServerStatusFeed {
    /// A subscription whose first frame has the current status.
    pub(super) fn new(server: Arc<ServerState>, subscription: u32) -> Self {
        let (mut files, machines) = (server.news.of_files(), server.news.of_machines());
        files.mark_changed();
        let runs = server.news.of_runs();
        Self { server, subscription, files, machines, runs }
    }
}

impl Feed for ServerStatusFeed {
    const LANE: Lane = Lane::Status;

    fn next_time(&self) -> Instant {
        Instant::now() + INTERVAL
    }

    async fn ready(&mut self) {
        // The server holds the senders and is held here.
        select! {
            _ = self.files.changed() => {}
            _ = self.machines.changed() => {}
            _ = self.runs.changed() => {}
        }
    }

    async fn take(&mut self) -> NextMessage {
        for news in [&mut self.files, &mut self.machines, &mut self.runs] {
            news.mark_unchanged();
        }
        let status = self.server.status().await;
        NextMessage::Now(words::text(&ToClient::ServerStatus {
            subscription: self.subscription,
            status,
        }))
    }
}

/// A status with its serialization. Only the latest value counts.
#[derive(Debug)]
pub(super) struct Status<T, F> {
    watch: watch::Receiver<T>,
    tell: F,
    /// True once the sender is dropped: no further values will come.
    is_over: bool,
    subscription: u32,
}

impl<T, F: FnMut(&T) -> String> Status<T, F> {
    /// A subscription whose first frame has the current value.
    pub(super) fn new(subscription: u32, mut watch: watch::Receiver<T>, tell: F) -> Self {
        watch.mark_changed();
        Self { watch, tell, is_over: false, subscription }
    }
}

impl<T: Send + Sync, F: FnMut(&T) -> String + Send> Feed for Status<T, F> {
    const LANE: Lane = Lane::Status;

    fn next_time(&self) -> Instant {
        Instant::now() + INTERVAL
    }

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
