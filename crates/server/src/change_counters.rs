//! That something has changed: three counters that wake those who wait for them. Knows no more than that; the owner of the
//! changed thing is asked for the rest.

use rafcon_supervisor::clock;
use tokio::sync::watch;

/// Counts changes of files, open machines and runs. Counting wakes everyone who waits, and costs nothing if no one does.
#[derive(Debug)]
pub(crate) struct ChangeCounters {
    files: watch::Sender<u64>,
    machines: watch::Sender<u64>,
    runs: watch::Sender<u64>,
}

impl Default for ChangeCounters {
    fn default() -> Self {
        // Clients request files again when this number changes: another server must have another one.
        let files = watch::Sender::new(clock::since_1970_ms());
        Self { files, machines: watch::Sender::default(), runs: watch::Sender::default() }
    }
}

impl ChangeCounters {
    /// A file of a project or a library has changed.
    pub(crate) fn files(&self) {
        count(&self.files);
    }

    /// An open machine has changed: opened, edited, saved, closed, or viewed by others.
    pub(crate) fn machines(&self) {
        count(&self.machines);
    }

    /// How often files have changed; with `changed`, the next time.
    pub(crate) fn of_files(&self) -> watch::Receiver<u64> {
        self.files.subscribe()
    }

    /// How often open machines have changed; with `changed`, the next time.
    pub(crate) fn of_machines(&self) -> watch::Receiver<u64> {
        self.machines.subscribe()
    }

    /// How often runs have changed; with `changed`, the next time.
    pub(crate) fn of_runs(&self) -> watch::Receiver<u64> {
        self.runs.subscribe()
    }

    /// The counter of runs, for each of them to count when it is different: begun, ended, resumed, in other hands.
    pub(crate) fn counter_of_runs(&self) -> watch::Sender<u64> {
        self.runs.clone()
    }

    /// Changes whenever files have changed, also with a restart of the server.
    pub(crate) fn files_revision(&self) -> u64 {
        *self.files.borrow()
    }
}

fn count(news: &watch::Sender<u64>) {
    news.send_modify(|revision| *revision += 1);
}
