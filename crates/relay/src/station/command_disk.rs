//! Stores the requests to a robot: a thread of its own writes them, so that neither datagrams nor a stop wait for the disk. The work is
//! bounded by the requests that the session sends: one entry for each.

use super::stored_command::{StoredCommand, remove};
use crate::inbox::Input;
use crate::station::ToStation;
use parking_lot::{Condvar, Mutex};
use rafcon_link::CommandId;
use std::collections::{BTreeMap, VecDeque};
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::thread;
use std::time::Duration;

/// Retry interval of requests that the disk did not take.
const RETRY_EVERY: Duration = Duration::from_secs(1);
/// Longest wait for the disk at the end of a station.
const END_WITHIN: Duration = Duration::from_secs(5);

/// Event of the disk about requests.
#[derive(Debug)]
pub(crate) enum FromCommandDisk {
    /// A request is durable.
    Kept(CommandId),
    /// A request is not stored yet, with the reason. The disk tries again until the request is removed.
    NotKept(CommandId, String),
}

/// The disk as the rest of the station sees it.
#[derive(Debug)]
pub(super) struct CommandDisk {
    queue: Arc<CommandQueue>,
}

#[derive(Debug, Default)]
struct CommandQueue {
    todo: Mutex<CommandTasks>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct CommandTasks {
    /// Last task for each request: what to store, or `None` to remove it.
    tasks: BTreeMap<CommandId, Option<Box<StoredCommand>>>,
    /// Ids in `tasks`, in the order of the tasks.
    order: VecDeque<CommandId>,
    ends: bool,
    has_ended: bool,
}

impl CommandTasks {
    fn set(&mut self, id: CommandId, task: Option<Box<StoredCommand>>) {
        if self.tasks.insert(id, task).is_none() {
            self.order.push_back(id);
        }
    }

    /// A request that waits to be stored is cancelled, so that the tasks of a stuck disk are bounded.
    fn remove(&mut self, id: CommandId) {
        if matches!(self.tasks.get(&id), Some(Some(_))) {
            self.tasks.remove(&id);
            self.order.retain(|other| *other != id);
        } else {
            self.set(id, None);
        }
    }

    fn next(&mut self) -> Option<(CommandId, Option<Box<StoredCommand>>)> {
        let id = self.order.pop_front()?;
        self.tasks.remove_entry(&id)
    }
}

impl CommandDisk {
    /// Begins the thread that stores requests to the robot of this number in this folder.
    pub(super) fn begin(
        folder: PathBuf,
        robot: usize,
        inbox: SyncSender<Input<ToStation>>,
    ) -> io::Result<Self> {
        let queue = Arc::<CommandQueue>::default();
        let keeper = CommandKeeper { folder, robot, inbox, failed: BTreeMap::new() };
        let theirs = Arc::clone(&queue);
        let work = move || {
            keeper.work(&theirs);
            theirs.todo.lock().has_ended = true;
            theirs.changed.notify_all();
        };
        thread::Builder::new().name("commands".to_owned()).spawn(work)?;
        Ok(Self { queue })
    }

    /// Stores a request, and reports the result.
    pub(super) fn keep(&self, command: StoredCommand) {
        self.queue.todo.lock().set(command.id(), Some(Box::new(command)));
        self.queue.changed.notify_all();
    }

    /// Removes a request.
    pub(super) fn remove(&self, id: CommandId) {
        self.queue.todo.lock().remove(id);
        self.queue.changed.notify_all();
    }

    /// Does what waits and ends; does not wait for long for a disk that is stuck.
    pub(super) fn end(&self) {
        let mut todo = self.queue.todo.lock();
        todo.ends = true;
        self.queue.changed.notify_all();
        let is_busy = |todo: &mut CommandTasks| !todo.has_ended;
        let _stuck = self.queue.changed.wait_while_for(&mut todo, is_busy, END_WITHIN);
    }
}

#[cfg(test)]
impl CommandDisk {
    /// A disk that hangs.
    pub(super) fn stuck() -> Self {
        Self { queue: Arc::default() }
    }

    /// Number of tasks that wait for the disk.
    pub(super) fn waiting(&self) -> usize {
        self.queue.todo.lock().tasks.len()
    }
}

impl Drop for CommandDisk {
    fn drop(&mut self) {
        self.queue.todo.lock().ends = true;
        self.queue.changed.notify_all();
    }
}

struct CommandKeeper {
    folder: PathBuf,
    robot: usize,
    inbox: SyncSender<Input<ToStation>>,
    /// Requests that the disk did not take.
    failed: BTreeMap<CommandId, Box<StoredCommand>>,
}

impl CommandKeeper {
    fn work(mut self, queue: &CommandQueue) {
        loop {
            let mut todo = queue.todo.lock();
            let is_idle = |todo: &mut CommandTasks| todo.tasks.is_empty() && !todo.ends;
            if self.failed.is_empty() {
                queue.changed.wait_while(&mut todo, is_idle);
            } else {
                let _retry = queue.changed.wait_while_for(&mut todo, is_idle, RETRY_EVERY);
            }
            let (task, ends) = (todo.next(), todo.ends);
            drop(todo);
            match task {
                Some((id, task)) => self.perform(id, task),
                None if ends => return,
                None => {
                    for (id, command) in std::mem::take(&mut self.failed) {
                        self.perform(id, Some(command));
                    }
                }
            }
        }
    }

    fn perform(&mut self, id: CommandId, task: Option<Box<StoredCommand>>) {
        self.failed.remove(&id);
        let Some(command) = task else {
            // A request that stays is sent once more after a restart; the robot has its fate on record.
            return drop(remove(&self.folder, id));
        };
        match command.write(&self.folder) {
            Ok(()) => self.say(FromCommandDisk::Kept(id)),
            Err(error) => {
                self.failed.insert(id, command);
                self.say(FromCommandDisk::NotKept(id, error.to_string()));
            }
        }
    }

    fn say(&self, event: FromCommandDisk) {
        // A station that has ended needs to know nothing.
        self.inbox.send(Input::Other(ToStation::Commands(self.robot, event))).unwrap_or_default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::station::stored_command::StoredCommands;
    use crate::station::stored_command::tests::stored;
    use std::fs;
    use std::sync::mpsc::{Receiver, sync_channel};

    fn next(said: &Receiver<Input<ToStation>>) -> FromCommandDisk {
        match said.recv().unwrap() {
            Input::Other(ToStation::Commands(0, event)) => event,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_request_that_the_disk_refuses_is_stored_once_it_takes_it() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("commands");
        // A file is in the place of the folder.
        fs::write(&folder, []).unwrap();
        let (inbox, said) = sync_channel(8);
        let disk = CommandDisk::begin(folder.clone(), 0, inbox).unwrap();
        let command = stored(1);
        disk.keep(command.clone());
        assert!(matches!(next(&said), FromCommandDisk::NotKept(id, _) if id == command.id()));
        fs::remove_file(&folder).unwrap();
        loop {
            match next(&said) {
                FromCommandDisk::Kept(id) => break assert_eq!(id, command.id()),
                FromCommandDisk::NotKept(..) => {}
            }
        }
        let id = command.id();
        assert_eq!(StoredCommands::read(&folder).commands, [command]);
        disk.remove(id);
        disk.end();
        assert!(StoredCommands::read(&folder).commands.is_empty());
    }

    #[test]
    fn requests_that_are_over_before_a_stuck_disk_takes_them_are_no_task() {
        let disk = CommandDisk::stuck();
        for nth in 0..100 {
            disk.keep(stored(nth));
            disk.keep(stored(nth));
        }
        assert_eq!(disk.waiting(), 100);
        (1..100).for_each(|nth| disk.remove(stored(nth).id()));
        assert_eq!(disk.waiting(), 1);
        // One that is on the disk has to be removed there.
        disk.remove(stored(200).id());
        assert_eq!(disk.waiting(), 2);
    }
}
