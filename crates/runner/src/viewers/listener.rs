//! Where others join a run: a socket in the run's folder. Knows how a viewer comes in, but not what it is told.

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

/// How long someone who connects may take to say who they are and what they want.
const HELLO_AT_MOST: Duration = Duration::from_secs(10);

/// How long no one is let in who could not be.
const ACCEPT_BACKOFF: Timespec = Timespec { tv_sec: 0, tv_nsec: 100_000_000 };

/// The open door of a run.
#[derive(Debug)]
pub(crate) struct ViewerListener {
    listener: TrackedDescriptor<UnixListener>,
    path: PathBuf,
    /// Closed when no one is to come in any more.
    open: UnixStream,
}

/// Closes the door when it is dropped.
#[derive(Debug)]
pub(crate) struct ListenerCloser {
    open: UnixStream,
}

impl Drop for ListenerCloser {
    fn drop(&mut self) {
        // Not only closed: a process that a script forked may have a copy. One that is shut already is as shut as it should be.
        drop(self.open.shutdown(Shutdown::Both));
    }
}

impl ViewerListener {
    /// Opens the door of the run in `folder`. What lies there of an earlier runner is removed.
    pub(crate) fn open(folder: &Path) -> io::Result<(Self, ListenerCloser)> {
        let path = folder.join(SOCKET_FILE);
        let listener = TrackedDescriptor::new(bind_socket(folder)?);
        let (open, closer) = UnixStream::pair()?;
        Ok((Self { listener, path, open }, ListenerCloser { open: closer }))
    }

    /// Lets viewers in until the door is closed.
    pub(crate) fn serve<'scope, S: Scripts>(
        self,
        scope: &'scope Scope<'scope, '_>,
        company: &'scope ViewerSet<S>,
    ) {
        while self.is_knocked_at() {
            let Ok((stream, _)) = self.listener.0.accept() else {
                self.rest();
                continue;
            };
            let socket = Socket::new(stream);
            if !company.arrive(&socket) {
                continue;
            }
            let talk = move || {
                // Whoever does not say who they are is no one: the connection ends.
                drop(welcome(scope, company, &socket));
                company.arrived(&socket);
            };
            // Whoever finds no thread to talk to is shut out: the connection ends.
            drop(thread::Builder::new().name("joining".to_owned()).spawn_scoped(scope, talk));
        }
    }

    /// Waits a while, or until the door is closed: the system has no room for a connection, and someone still knocks.
    fn rest(&self) {
        let mut open = [PollFd::new(&self.open, PollFlags::IN | PollFlags::HUP)];
        // Interrupted by a signal, the wait is over.
        let _woken = poll(&mut open, Some(&ACCEPT_BACKOFF));
    }

    /// Waits for the next one; false when the door is closed.
    fn is_knocked_at(&self) -> bool {
        let mut both = [
            PollFd::new(&self.listener.0, PollFlags::IN),
            PollFd::new(&self.open, PollFlags::IN | PollFlags::HUP),
        ];
        // Interrupted by a signal, the wait begins anew.
        while poll(&mut both, None).is_err() {}
        both[1].revents().is_empty()
    }
}

impl Drop for ViewerListener {
    fn drop(&mut self) {
        // The folder may be gone, and the socket with it.
        drop(fs::remove_file(&self.path));
    }
}

fn welcome<'scope, S: Scripts>(
    scope: &'scope Scope<'scope, '_>,
    company: &'scope ViewerSet<S>,
    socket: &Socket,
) -> Result<(), TalkError> {
    socket.wait_at_most(Some(HELLO_AT_MOST))?;
    let mut line = connection::open(socket.clone())?;
    let ToRunner::Join(join) = line.receiver.message()? else { return Err(TalkError::NoJoin) };
    socket.wait_at_most(None)?;
    company.welcome(scope, line, join)?;
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
