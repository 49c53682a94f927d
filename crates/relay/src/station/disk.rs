//! The disk of a station has a thread for each robot, so that commands and status pass while it is slow, stuck or full. What waits
//! for it is bounded; what does not fit is not taken, and has to come again.

use super::in_order;
use super::kept_runs::KeptRuns;
use super::viewers::Shared;
use crate::pairing::Pairing;
use parking_lot::{Condvar, Mutex};
use rafcon_link::{EventHash, Horizon, KeyId, StreamId};
use rafcon_storage::journal::EventBlock;
use std::collections::VecDeque;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

/// Capacity of the queue in bytes of events.
const EVENTS_MAX: usize = 16 << 20;
/// Capacity including descriptions of runs. Events cannot be stored before them.
const ALL_MAX: usize = 32 << 20;
/// Longest wait for the disk at the end of a station.
const END_WITHIN: Duration = Duration::from_secs(5);

/// Task of the disk, in order for each run.
#[derive(Debug)]
pub(super) enum Work {
    /// Keep the next part of what is to be known about a run, or of a parcel.
    Part(EventBlock),
    /// Keep the next events of a run.
    Events(EventBlock),
    /// Compare the hash of the events with the robot's.
    Check(EventHash),
    /// Close the run, which is over and complete.
    Close,
    /// Close the run as it is: its runner died, or it was deleted on the robot.
    Leave {
        /// The robot has nothing more of it.
        is_final: bool,
    },
}

impl Work {
    pub(super) fn cost(&self) -> usize {
        match self {
            Self::Part(items) | Self::Events(items) => in_order::cost(items),
            Self::Check(_) | Self::Close | Self::Leave { .. } => 0,
        }
    }
}

/// Task for a pairing.
#[derive(Debug)]
pub(super) enum KeyWork {
    /// It is used from now on, and does not replace the one before yet.
    Next(Pairing),
    /// It replaces the one before.
    Replace(Pairing),
}

/// Event of the disk's thread, about one run or all.
#[derive(Debug)]
pub(crate) enum FromDisk {
    /// A run is open to viewers.
    Opened(StreamId, OpenRun),
    /// The events of a run are safe up to this one.
    Safe(StreamId, u64),
    /// A run is closed.
    Closed(StreamId),
    /// Nothing of a run is under way on the disk.
    Settled(SettledRun),
    /// Nothing more of a run is kept: why.
    Refused(StreamId, String),
    /// Nothing of these parcels is here any more.
    ParcelsGone(Vec<StreamId>),
    /// A pairing is kept, and can be used.
    KeyKept(Pairing),
    /// Fault of the disk. `None` after the recovery.
    Problem(Option<String>),
}

/// A run of which nothing is under way on the disk.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SettledRun {
    /// The stream of its events.
    pub(super) stream: StreamId,
    /// Its events, if they changed.
    pub(super) events: Option<u64>,
    pub(super) parts: u64,
}

/// A run that is open to viewers.
#[derive(Debug)]
pub(crate) struct OpenRun {
    pub(super) id: String,
    pub(super) safe: u64,
    pub(super) shared: Arc<Shared>,
}

/// The disk as the rest of the station sees it.
#[derive(Debug)]
pub(super) struct Disk {
    queue: Arc<Queue>,
}

#[derive(Debug, Default)]
struct Queue {
    todo: Mutex<Todo>,
    changed: Condvar,
    /// The bytes of what is not written.
    bytes: Arc<AtomicUsize>,
}

#[derive(Debug, Default)]
struct Todo {
    works: VecDeque<(StreamId, Work)>,
    heard: Option<(KeyId, Horizon)>,
    key: Option<KeyWork>,
    ends: bool,
    has_ended: bool,
}

impl Disk {
    /// Starts the thread that stores these runs. Its events go to `tell`.
    pub(super) fn begin(mut runs: KeptRuns) -> io::Result<Self> {
        let queue = Arc::<Queue>::default();
        let theirs = Arc::clone(&queue);
        let work = move || {
            keep(&theirs, &mut runs);
            drop(runs);
            theirs.todo.lock().has_ended = true;
            theirs.changed.notify_all();
        };
        thread::Builder::new().name("disk".to_owned()).spawn(work)?;
        Ok(Self { queue })
    }

    /// Gives events of a run, by their stream; gives them back if too much waits.
    pub(super) fn give_events(&self, run: StreamId, items: EventBlock) -> Result<(), EventBlock> {
        if !self.has_room(&items, EVENTS_MAX) {
            return Err(items);
        }
        self.give_task(run, Work::Events(items));
        Ok(())
    }

    /// Gives a part of the description of a run, by the stream of its events, or of a parcel; gives it back if too much waits.
    pub(super) fn give_part(&self, run: StreamId, items: EventBlock) -> Result<(), EventBlock> {
        if !self.has_room(&items, ALL_MAX) {
            return Err(items);
        }
        self.give_task(run, Work::Part(items));
        Ok(())
    }

    fn has_room(&self, items: &EventBlock, most: usize) -> bool {
        self.queue.bytes.load(Ordering::Acquire) + in_order::cost(items) <= most
    }

    /// Gives a task for a run, by the stream of its events.
    pub(super) fn give_task(&self, run: StreamId, work: Work) {
        self.queue.bytes.fetch_add(work.cost(), Ordering::AcqRel);
        self.queue.todo.lock().works.push_back((run, work));
        self.queue.changed.notify_all();
    }

    /// Stores the state of the link for the next start.
    pub(super) fn keep_heard(&self, key: KeyId, heard: Option<Horizon>) {
        self.queue.todo.lock().heard = heard.map(|heard| (key, heard));
        self.queue.changed.notify_all();
    }

    /// Keeps a pairing.
    pub(super) fn keep_key(&self, work: KeyWork) {
        self.queue.todo.lock().key = Some(work);
        self.queue.changed.notify_all();
    }

    /// Writes what waits and ends; does not wait for long for a disk that is stuck.
    pub(super) fn end(&self) {
        let mut todo = self.queue.todo.lock();
        todo.ends = true;
        self.queue.changed.notify_all();
        let is_busy = |todo: &mut Todo| !todo.has_ended;
        // Unwritten events are not reported as safe, so that the robot sends them again.
        let _stuck = self.queue.changed.wait_while_for(&mut todo, is_busy, END_WITHIN);
    }
}

#[cfg(test)]
impl Disk {
    /// A disk that takes work and does nothing.
    pub(super) fn without_thread() -> Self {
        Self { queue: Arc::default() }
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        self.queue.todo.lock().ends = true;
        self.queue.changed.notify_all();
    }
}

/// Does what is given until the end.
fn keep(queue: &Queue, runs: &mut KeptRuns) {
    let mut is_unsafe = false;
    loop {
        let mut todo = queue.todo.lock();
        let is_idle = |todo: &mut Todo| {
            todo.works.is_empty() && todo.heard.is_none() && todo.key.is_none() && !todo.ends
        };
        if is_unsafe {
            let _synced = queue.changed.wait_while_for(&mut todo, is_idle, runs.rest());
        } else {
            queue.changed.wait_while(&mut todo, is_idle);
        }
        let (works, heard) = (std::mem::take(&mut todo.works), todo.heard.take());
        let (key, ends) = (todo.key.take(), todo.ends);
        drop(todo);
        for (run, work) in works {
            runs.add(run, work);
        }
        let written = runs.go_on(ends);
        queue.bytes.fetch_sub(written, Ordering::AcqRel);
        if let Some((key, heard)) = heard {
            runs.keep_heard(key, heard);
        }
        if let Some(key) = key {
            runs.keep_key(key);
        }
        if ends {
            return;
        }
        is_unsafe = runs.is_unsafe();
    }
}
