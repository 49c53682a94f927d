//! The subscription to everything that the server looks after. Knows what wakes it; must never know what a change was.

use super::feed::{Feed, NextMessage};
use super::outbox::Lane;
use super::words;
use crate::ServerState;
use rafcon_protocol::socket::ToClient;
use std::sync::Arc;
use std::time::Duration;
use tokio::select;
use tokio::sync::watch;

/// The whole server, followed by one client.
#[derive(Debug)]
pub(super) struct ServerStatusFeed {
    server: Arc<ServerState>,
    subscription: u32,
    files: watch::Receiver<u64>,
    machines: watch::Receiver<u64>,
    runs: watch::Receiver<u64>,
}

impl ServerStatusFeed {
    /// The first frame tells how things stand now.
    pub(super) fn new(server: Arc<ServerState>, subscription: u32) -> Self {
        let (mut files, machines) = (server.news.of_files(), server.news.of_machines());
        files.mark_changed();
        let runs = server.news.of_runs();
        Self { server, subscription, files, machines, runs }
    }
}

impl Feed for ServerStatusFeed {
    const EVERY: Duration = Duration::from_millis(100);
    const LANE: Lane = Lane::Status;

    async fn ready(&mut self) {
        // The server, which counts, is held here.
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
