//! Publishes status, revision and viewers of an open machine. Knows the listeners; does not know files or edits. Nothing here blocks.

use rafcon_locks::Mutex;
use rafcon_protocol::api::{MachineStatus, MachineSummary, Presence};
use tokio::sync::watch;

/// Channels to the listeners. `None` once the machine is closed.
#[derive(Debug)]
pub(super) struct Broadcast(Mutex<Option<Channels>>);

#[derive(Debug)]
struct Channels {
    status: watch::Sender<MachineStatus>,
    revision: watch::Sender<u64>,
}

impl Broadcast {
    /// Channels of a machine without viewers.
    pub(super) fn new(summary: MachineSummary) -> Self {
        let revision = watch::Sender::new(summary.revision);
        let status = watch::Sender::new(MachineStatus { summary, people: Vec::new() });
        Self(Mutex::new(Some(Channels { status, revision })))
    }

    pub(super) fn is_open(&self) -> bool {
        self.0.lock().is_some()
    }

    /// Its summary. `None` once it is closed.
    pub(super) fn summary(&self) -> Option<MachineSummary> {
        self.0.lock().as_ref().map(|ends| ends.status.borrow().summary.clone())
    }

    pub(super) fn status(&self) -> Option<watch::Receiver<MachineStatus>> {
        self.0.lock().as_ref().map(|ends| ends.status.subscribe())
    }

    pub(super) fn revisions(&self) -> Option<watch::Receiver<u64>> {
        self.0.lock().as_ref().map(|ends| ends.revision.subscribe())
    }

    /// Publishes its summary. The viewers do not change.
    pub(super) fn tell(&self, summary: MachineSummary) {
        if let Some(ends) = &*self.0.lock() {
            let revision = summary.revision;
            ends.status.send_modify(|status| status.summary = summary);
            ends.revision.send_replace(revision);
        }
    }

    /// Sets the states that a connection shows.
    pub(super) fn looks(&self, presence: Presence) {
        if let Some(ends) = &*self.0.lock() {
            ends.status.send_modify(|status| match place_of(&status.people, presence.connection) {
                Ok(at) => status.people[at] = presence,
                Err(at) => status.people.insert(at, presence),
            });
        }
    }

    /// Removes a connection from the viewers.
    pub(super) fn leaves(&self, connection: u64) {
        if let Some(ends) = &*self.0.lock() {
            ends.status.send_if_modified(|status| {
                let at = place_of(&status.people, connection);
                at.is_ok_and(|at| status.people.remove(at).connection == connection)
            });
        }
    }

    /// Closes all channels to the listeners.
    pub(super) fn close(&self) {
        *self.0.lock() = None;
    }

    /// Closes all channels if the machine has neither viewers nor listeners. Returns `true` if it did.
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
