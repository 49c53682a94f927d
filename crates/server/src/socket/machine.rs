//! An open machine's history for one client: each revision once, from a cursor on. Knows cursors and texts; does not know the
//! content of revisions.

use super::feed::{Feed, NextMessage};
use super::outbox::Lane;
use super::words;
use crate::Failure;
use crate::documents::{MachineSession, RevisionsPage};
use rafcon_protocol::socket::ToClient;
use std::sync::Arc;
use tokio::sync::watch;
use tokio::time::Instant;

/// The history of an open machine, followed by one client.
#[derive(Debug)]
pub(super) struct MachineHistory {
    session: Arc<MachineSession>,
    last: watch::Receiver<u64>,
    subscription: u32,
    /// The first revision that was not sent.
    next: u64,
    /// True once the machine is closed: no further revisions will come.
    is_over: bool,
}

impl MachineHistory {
    /// A client that has received everything before revision `from`.
    pub(super) fn new(
        session: Arc<MachineSession>,
        subscription: u32,
        from: u64,
    ) -> Result<Self, Failure> {
        let mut last = session.revisions()?;
        last.mark_changed();
        Ok(Self { session, last, subscription, next: from, is_over: false })
    }
}

impl Feed for MachineHistory {
    const LANE: Lane = Lane::History;

    fn next_time(&self) -> Instant {
        Instant::now()
    }

    async fn ready(&mut self) {
        let is_there = self.next <= *self.last.borrow();
        if !is_there {
            self.is_over = self.last.changed().await.is_err();
        }
    }

    async fn take(&mut self) -> NextMessage {
        let subscription = self.subscription;
        match self.session.since(self.next) {
            RevisionsPage::Reset(revision) if !self.is_over => {
                NextMessage::Last(words::text(&ToClient::Reset { subscription, revision }))
            }
            RevisionsPage::Revisions(told) if !told.is_empty() => {
                self.next += told.len() as u64;
                NextMessage::Part(words::revisions(subscription, &told))
            }
            _ if self.is_over => NextMessage::Last(words::text(&words::ended(subscription, None))),
            _ => NextMessage::Nothing,
        }
    }
}
