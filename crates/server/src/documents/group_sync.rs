//! Syncs a file in groups: a separate thread syncs a moment after a write, so that writers do not wait for the disk. Does not
//! know the content.

use crate::log;
use std::convert::Infallible;
use std::io;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

/// Interval in which writes are synced together.
const GROUP: Duration = Duration::from_millis(50);

/// The thread that syncs a file. When this is dropped, it ends after syncing the last writes.
#[derive(Debug)]
pub(super) struct GroupSync {
    written: SyncSender<()>,
    /// Never carries a message: closing it ends the thread.
    _end: SyncSender<Infallible>,
}

impl GroupSync {
    /// `sync` flushes everything written before its call.
    pub(super) fn begin(sync: impl FnMut() -> io::Result<()> + Send + 'static) -> io::Result<Self> {
        let (written, groups) = sync_channel(1);
        let (end, is_over) = sync_channel(1);
        let sync_groups = move || sync_groups(&groups, &is_over, sync);
        thread::Builder::new().name("draft sync".to_owned()).spawn(sync_groups)?;
        Ok(Self { written, _end: end })
    }

    /// Requests a sync of new writes.
    pub(super) fn written(&self) {
        // A pending sync includes these writes.
        let _waits_already = self.written.try_send(());
    }
}

fn sync_groups(
    groups: &Receiver<()>,
    is_over: &Receiver<Infallible>,
    mut sync: impl FnMut() -> io::Result<()>,
) {
    while groups.recv().is_ok() {
        let _time_or_end = is_over.recv_timeout(GROUP);
        while groups.try_recv().is_ok() {}
        if let Err(error) = sync() {
            log::say(&format!("a draft cannot be synced to disk: {error}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::GroupSync;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU32, Ordering};
    use std::sync::mpsc::sync_channel;

    /// Every write is followed by a sync, also if it happens while a sync runs or fails.
    #[test]
    fn everything_that_was_written_is_synced() {
        let written = Arc::new(AtomicU32::new(0));
        let (told, synced) = sync_channel(100);
        let seen = Arc::clone(&written);
        let group = GroupSync::begin(move || {
            told.send(seen.load(Ordering::SeqCst)).unwrap();
            Err(std::io::Error::other("a disk that fails"))
        });
        let group = group.unwrap();
        for number in 1..=3 {
            written.store(number, Ordering::SeqCst);
            group.written();
            assert_eq!(synced.recv(), Ok(number));
        }
        for number in 4..100 {
            written.store(number, Ordering::SeqCst);
            group.written();
        }
        drop(group);
        assert_eq!(synced.iter().last(), Some(99));
    }
}
