//! That something is different now: three counters that whoever waits is woken by. Knows no more than that; what is
//! different is asked of whoever owns it.

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
        // Clients ask for files again when this is another number: it must be, of another server.
        let files = watch::Sender::new(clock::since_1970_ms());
        Self { files, machines: watch::Sender::default(), runs: watch::Sender::default() }
    }
}

impl ChangeCounters {
    /// A file of a project or a library is different.
    pub(crate) fn files(&self) {
        count(&self.files);
    }

    /// An open machine is different: opened, edited, saved, closed, looked at.
    pub(crate) fn machines(&self) {
        count(&self.machines);
    }

    /// How often files changed; with `changed`, the next time.
    pub(crate) fn of_files(&self) -> watch::Receiver<u64> {
        self.files.subscribe()
    }

    /// How often open machines changed; with `changed`, the next time.
    pub(crate) fn of_machines(&self) -> watch::Receiver<u64> {
        self.machines.subscribe()
    }

    /// How often runs changed; with `changed`, the next time.
    pub(crate) fn of_runs(&self) -> watch::Receiver<u64> {
        self.runs.subscribe()
    }

    /// The counter of runs, for each of them to count when it is different: begun, ended, resumed, in other hands.
    pub(crate) fn counter_of_runs(&self) -> watch::Sender<u64> {
        self.runs.clone()
    }

    /// Another number whenever files have changed, also after a restart of the server.
    pub(crate) fn files_revision(&self) -> u64 {
        *self.files.borrow()
    }
}

fn count(news: &watch::Sender<u64>) {
    news.send_modify(|revision| *revision += 1);
}
