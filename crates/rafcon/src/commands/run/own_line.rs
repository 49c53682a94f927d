//! The connection to a runner that this program started. A thread writes, so that the loop never waits for a runner that
//! does not read.

use crate::event_queue::{Line, offer};
use crate::failure::complain;
use anyhow::{Context as _, Result};
use rafcon_protocol::{Launch, ToRunner};
use rafcon_supervisor::{BeginError, Group, begin};
use std::os::unix::net::UnixStream;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread;

/// Capacity of the queue in front of the writer. Further messages are dropped.
const QUEUE: usize = 64;

/// Queue of messages to the runner, in order, after its launch.
#[derive(Debug)]
pub(super) struct OwnLine(SyncSender<ToRunner>);

impl OwnLine {
    /// Sends the launch, then the messages of the queue.
    pub(super) fn open(mut control: UnixStream, group: Group, launch: Launch) -> Result<Self> {
        let (sender, messages) = sync_channel::<ToRunner>(QUEUE);
        let write = move || {
            send(&control, group, launch);
            for message in messages {
                control.say(&message).unwrap_or_default();
            }
        };
        let writer = thread::Builder::new().name("launch".to_owned()).spawn(write);
        writer.context("cannot start a thread that talks to the runner")?;
        Ok(Self(sender))
    }
}

impl Line for OwnLine {
    /// Queues a message. A runner that does not read is detected by its silence or the time limit.
    fn say(&mut self, message: &ToRunner) -> Result<bool> {
        Ok(offer(&self.0, message))
    }
}

/// Sends the launch. A dead runner is reported by the end of its process.
fn send(control: &UnixStream, group: Group, launch: Launch) {
    match begin(control, launch) {
        Ok(()) | Err(BeginError::Gone(_)) => {}
        Err(error @ (BeginError::Launch(_) | BeginError::Silent(_))) => {
            complain(&format!("error: {error}"));
            group.kill();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{OwnLine, QUEUE};
    use crate::event_queue::Line as _;
    use rafcon_protocol::{Join, ToRunner};
    use std::sync::mpsc::sync_channel;

    #[test]
    fn what_a_runner_does_not_read_is_dropped_beyond_the_bound_and_reported() {
        let (sender, messages) = sync_channel(QUEUE);
        let mut line = OwnLine(sender);
        let mut say = || line.say(&ToRunner::Join(Join::default())).unwrap();
        assert!((0..QUEUE).all(|_| say()));
        assert!(!say());
        drop(messages.recv());
        assert!(say());
        // The end of the process is detected elsewhere.
        drop(messages);
        assert!(say());
    }
}
