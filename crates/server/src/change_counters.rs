//! Three change counters that wake their listeners. They carry no data: listeners read the changed thing from its owner.

use rafcon_supervisor::clock;
use tokio::sync::watch;

/// Counts changes of files, open machines and runs. A count wakes all listeners and costs almost nothing without any.
#[derive(Debug)]
pub(crate) struct ChangeCounters {
    files: watch::Sender<u64>,
    machines: watch::Sender<u64>,
    runs: watch::Sender<u64>,
}

impl Default for ChangeCounters {
    fn default() -> Self {
        // Clients reload files when this number changes, so each server must start with a different one.
        let files = watch::Sender::new(clock::since_1970_ms());
        Self { files, machines: watch::Sender::default(), runs: watch::Sender::default() }
    }
}

impl ChangeCounters {
    /// Counts a change of a file in a project or a library.
    pub(crate) fn files(&self) {
        count(&self.files);
    }

    /// Counts a change of an open machine: it was opened, edited, saved or closed, or has other viewers.
    pub(crate) fn machines(&self) {
        count(&self.machines);
    }

    /// Counter of file changes; `changed` waits for the next one.
    pub(crate) fn of_files(&self) -> watch::Receiver<u64> {
        self.files.subscribe()
    }

    /// Counter of changes of open machines; `changed` waits for the next one.
    pub(crate) fn of_machines(&self) -> watch::Receiver<u64> {
        self.machines.subscribe()
    }

    /// Counter of changes of runs; `changed` waits for the next one.
    pub(crate) fn of_runs(&self) -> watch::Receiver<u64> {
        self.runs.subscribe()
    }

    /// The counter of runs. Each run increments it when it begins, ends, resumes, or changes hands.
    pub(crate) fn counter_of_runs(&self) -> watch::Sender<u64> {
        self.runs.clone()
    }

    /// Changes with every change of files, and with a restart of the server.
    pub(crate) fn files_revision(&self) -> u64 {
        *self.files.borrow()
    }
}

fn count(news: &watch::Sender<u64>) {
    news.send_modify(|revision| *revision += 1);
}
