//! The subscription to everything that the server looks after. Knows what wakes it; must never know what a change was.

use super::feed::{Feed, Told};
use super::outbox::Lane;
use super::words;
use crate::House;
use rafcon_protocol::socket::ToClient;
use std::sync::Arc;
use std::time::Duration;
use tokio::select;
use tokio::sync::watch;

/// The whole house, followed by one client.
#[derive(Debug)]
pub(super) struct HouseStatus {
    house: Arc<House>,
    subscription: u32,
    files: watch::Receiver<u64>,
    machines: watch::Receiver<u64>,
    runs: watch::Receiver<u64>,
}

impl HouseStatus {
    /// The first frame tells how things stand now.
    pub(super) fn new(house: Arc<House>, subscription: u32) -> Self {
        let (mut files, machines) = (house.news.of_files(), house.news.of_machines());
        files.mark_changed();
        let runs = house.news.of_runs();
        Self { house, subscription, files, machines, runs }
    }
}

impl Feed for HouseStatus {
    const EVERY: Duration = Duration::from_millis(100);
    const LANE: Lane = Lane::Status;

    async fn ready(&mut self) {
        // The house, which counts, is held here.
        select! {
            _ = self.files.changed() => {}
            _ = self.machines.changed() => {}
            _ = self.runs.changed() => {}
        }
    }

    async fn take(&mut self) -> Told {
        for news in [&mut self.files, &mut self.machines, &mut self.runs] {
            news.mark_unchanged();
        }
        let status = self.house.status().await;
        Told::Now(words::text(&ToClient::HouseStatus { subscription: self.subscription, status }))
    }
}
