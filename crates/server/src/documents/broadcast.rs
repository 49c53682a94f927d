//! What everyone is told about an open machine: the latest truth, and who looks at it. Knows who waits for it; knows nothing of
//! files or edits. Nothing here waits for anyone, so that it may be asked from anywhere.

use rafcon_locks::Mutex;
use rafcon_protocol::api::{MachineStatus, MachineSummary, Presence};
use tokio::sync::watch;

/// Whom to wake, as long as the machine is open.
#[derive(Debug)]
pub(super) struct Broadcast(Mutex<Option<Channels>>);

#[derive(Debug)]
struct Channels {
    status: watch::Sender<MachineStatus>,
    revision: watch::Sender<u64>,
}

impl Broadcast {
    /// No one looks at it yet.
    pub(super) fn new(summary: MachineSummary) -> Self {
        let revision = watch::Sender::new(summary.revision);
        let status = watch::Sender::new(MachineStatus { summary, people: Vec::new() });
        Self(Mutex::new(Some(Channels { status, revision })))
    }

    pub(super) fn is_open(&self) -> bool {
        self.0.lock().is_some()
    }

    /// Its status; `None` once it is closed.
    pub(super) fn summary(&self) -> Option<MachineSummary> {
        self.0.lock().as_ref().map(|ends| ends.status.borrow().summary.clone())
    }

    pub(super) fn status(&self) -> Option<watch::Receiver<MachineStatus>> {
        self.0.lock().as_ref().map(|ends| ends.status.subscribe())
    }

    pub(super) fn revisions(&self) -> Option<watch::Receiver<u64>> {
        self.0.lock().as_ref().map(|ends| ends.revision.subscribe())
    }

    /// Sets its status. Its viewers stay as they are.
    pub(super) fn tell(&self, summary: MachineSummary) {
        if let Some(ends) = &*self.0.lock() {
            let revision = summary.revision;
            ends.status.send_modify(|status| status.summary = summary);
            ends.revision.send_replace(revision);
        }
    }

    /// Someone looks at these states.
    pub(super) fn looks(&self, presence: Presence) {
        if let Some(ends) = &*self.0.lock() {
            ends.status.send_modify(|status| match place_of(&status.people, presence.connection) {
                Ok(at) => status.people[at] = presence,
                Err(at) => status.people.insert(at, presence),
            });
        }
    }

    /// Someone looks elsewhere.
    pub(super) fn leaves(&self, connection: u64) {
        if let Some(ends) = &*self.0.lock() {
            ends.status.send_if_modified(|status| {
                let at = place_of(&status.people, connection);
                at.is_ok_and(|at| status.people.remove(at).connection == connection)
            });
        }
    }

    /// Nothing more will come.
    pub(super) fn close(&self) {
        *self.0.lock() = None;
    }

    /// The same unless someone looks at it or waits for what comes; whether it is closed.
    pub(super) fn close_unless_followed(&self) -> bool {
        let mut ends = self.0.lock();
        let is_followed = ends.as_ref().is_some_and(|ends| {
            let listeners = ends.status.receiver_count() + ends.revision.receiver_count();
            listeners > 0 || !ends.status.borrow().people.is_empty()
        });
        if !is_followed {
            *ends = None;
        }
        !is_followed
    }
}

fn place_of(people: &[Presence], connection: u64) -> Result<usize, usize> {
    people.binary_search_by_key(&connection, |presence| presence.connection)
}
