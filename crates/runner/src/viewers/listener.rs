//! Accepts viewers that join a run, at a socket in the run's folder. This module knows how a viewer joins, but not what
//! it receives.

use crate::Scripts;
use crate::viewers::connection::{self, Socket, TalkError, TrackedDescriptor};
use crate::viewers::viewer_set::ViewerSet;
use rafcon_protocol::ToRunner;
use rafcon_storage::journal::folder::{SOCKET_FILE, bind_socket};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::fs;
use std::io;
use std::net::Shutdown;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::thread::{self, Scope};
use std::time::Duration;

/// Timeout for the hello and the first message of a connection.
const HELLO_AT_MOST: Duration = Duration::from_secs(10);

/// Pause after a connection could not be accepted.
const ACCEPT_BACKOFF: Timespec = Timespec { tv_sec: 0, tv_nsec: 100_000_000 };

/// The listening socket of a run.
#[derive(Debug)]
pub(crate) struct ViewerListener {
    listener: TrackedDescriptor<UnixListener>,
    path: PathBuf,
    /// Closed when no more viewers are accepted.
    open: UnixStream,
}

/// Ends the listener on drop.
#[derive(Debug)]
pub(crate) struct ListenerCloser {
    open: UnixStream,
}

impl Drop for ListenerCloser {
    fn drop(&mut self) {
        // Shut down, not only closed, because a process that a script forked may have a copy. A socket that is already
        // shut needs no more.
        drop(self.open.shutdown(Shutdown::Both));
    }
}

impl ViewerListener {
    /// Opens the socket of the run in `folder`. A socket that an earlier runner left there is removed.
    pub(crate) fn open(folder: &Path) -> io::Result<(Self, ListenerCloser)> {
        let path = folder.join(SOCKET_FILE);
        let listener = TrackedDescriptor::new(bind_socket(folder)?);
        let (open, closer) = UnixStream::pair()?;
        Ok((Self { listener, path, open }, ListenerCloser { open: closer }))
    }

    /// Accepts viewers until the listener is closed.
    pub(crate) fn serve<'scope, S: Scripts>(
        self,
        scope: &'scope Scope<'scope, '_>,
        viewers: &'scope ViewerSet<S>,
    ) {
        while self.is_knocked_at() {
            let Ok((stream, _)) = self.listener.0.accept() else {
                self.rest();
                continue;
            };
            let socket = Socket::new(stream);
            if !viewers.arrive(&socket) {
                continue;
            }
            let talk = move || {
                // The connection ends if the hello or the join fails.
                drop(welcome(scope, viewers, &socket));
                viewers.arrived(&socket);
            };
            // The connection ends if the system has no thread for it.
            drop(thread::Builder::new().name("joining".to_owned()).spawn_scoped(scope, talk));
        }
    }

    /// Pauses after a failed accept, at most until the listener is closed. The system lacks room for a connection, and the
    /// client still waits.
    fn rest(&self) {
        let mut open = [PollFd::new(&self.open, PollFlags::IN | PollFlags::HUP)];
        // A signal ends the pause early.
        let _woken = poll(&mut open, Some(&ACCEPT_BACKOFF));
    }

    /// Waits for the next connection; false when the listener is closed.
    fn is_knocked_at(&self) -> bool {
        let mut both = [
            PollFd::new(&self.listener.0, PollFlags::IN),
            PollFd::new(&self.open, PollFlags::IN | PollFlags::HUP),
        ];
        // A signal restarts the wait.
        while poll(&mut both, None).is_err() {}
        both[1].revents().is_empty()
    }
}

impl Drop for ViewerListener {
    fn drop(&mut self) {
        // The folder may have been removed, with the socket.
        drop(fs::remove_file(&self.path));
    }
}

fn welcome<'scope, S: Scripts>(
    scope: &'scope Scope<'scope, '_>,
    viewers: &'scope ViewerSet<S>,
    socket: &Socket,
) -> Result<(), TalkError> {
    socket.wait_at_most(Some(HELLO_AT_MOST))?;
    let mut line = connection::open(socket.clone())?;
    let ToRunner::Join(join) = line.receiver.message()? else { return Err(TalkError::NoJoin) };
    socket.wait_at_most(None)?;
    viewers.welcome(scope, line, join)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::ViewerListener;
    use rafcon_storage::journal::folder::SOCKET_FILE;

    #[test]
    fn the_door_closes_though_a_forked_copy_of_its_closer_lives_on() {
        let home = tempfile::tempdir().unwrap();
        let (door, closer) = ViewerListener::open(home.path()).unwrap();
        let _copy = closer.open.try_clone().unwrap();
        drop(closer);
        assert!(!door.is_knocked_at());
    }

    #[test]
    fn a_door_that_nobody_serves_leaves_no_socket() {
        let home = tempfile::tempdir().unwrap();
        let (door, _closer) = ViewerListener::open(home.path()).unwrap();
        assert!(home.path().join(SOCKET_FILE).exists());
        drop(door);
        assert!(!home.path().join(SOCKET_FILE).exists());
    }
}
