//! The connection to one viewer: lines are received, frames are sent. This module knows messages, but not their
//! effects.

use rafcon_locks::Mutex;
use rafcon_protocol::{FrameError, Hello, ToViewer, decode, encode, encode_frame};
use serde::de::DeserializeOwned;
use std::collections::BTreeSet;
use std::io::{self, BufRead as _, BufReader, Read, Write as _};
use std::net::Shutdown;
use std::os::fd::{AsRawFd, RawFd};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Limit of a viewer's message in bytes.
const LINE_BYTES_MAX: u64 = 16 << 20;

/// A reason why a connection was not established.
#[derive(Debug, thiserror::Error)]
pub enum TalkError {
    /// A read or write failed.
    #[error("the connection to the viewer broke")]
    Io(#[from] io::Error),
    /// The viewer sent an invalid first line.
    #[error("the viewer's first lines are not those of this protocol")]
    Frame(#[from] FrameError),
    /// The viewer has another version.
    #[error(transparent)]
    Version(#[from] rafcon_protocol::VersionMismatch),
    /// The viewer disconnected before its first message.
    #[error("the viewer disconnected before its first message")]
    Gone,
    /// The viewer's first message is not a join.
    #[error("the viewer's first message is not a join")]
    NoJoin,
}

/// The descriptors of all sockets of this process.
static OPEN: Mutex<BTreeSet<RawFd>> = Mutex::new(BTreeSet::new());

/// The descriptors of all sockets of this process, and of the locks of its runs. A forked copy closes them first.
/// Otherwise a viewer would see the end of the last copy instead of the end of the runner, and the run would count as
/// alive while a copy is. Never waits.
pub fn descriptors() -> Vec<RawFd> {
    let sockets = OPEN.try_lock();
    let sockets = sockets.iter().flat_map(|open| open.iter().copied());
    sockets.chain(rafcon_storage::journal::locks()).collect()
}

/// A descriptor that a forked copy closes.
#[derive(Debug)]
pub(crate) struct TrackedDescriptor<T: AsRawFd>(pub(crate) T);

impl<T: AsRawFd> TrackedDescriptor<T> {
    pub(crate) fn new(socket: T) -> Self {
        OPEN.lock().insert(socket.as_raw_fd());
        Self(socket)
    }
}

impl<T: AsRawFd> Drop for TrackedDescriptor<T> {
    fn drop(&mut self) {
        OPEN.lock().remove(&self.0.as_raw_fd());
    }
}

/// A shared socket. It has one descriptor and no duplicate, so that a forked process can close it.
#[derive(Debug, Clone)]
pub(crate) struct Socket(Arc<TrackedDescriptor<UnixStream>>);

impl Read for Socket {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        (&self.0.0).read(buffer)
    }
}

impl Socket {
    /// Wraps a new connection.
    pub(crate) fn new(stream: UnixStream) -> Self {
        Self(Arc::new(TrackedDescriptor::new(stream)))
    }

    /// True if both are one connection.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Sets the timeout of reads.
    pub(crate) fn wait_at_most(&self, time: Option<Duration>) -> io::Result<()> {
        self.0.0.set_read_timeout(time)
    }

    /// Shuts the connection down, so that blocked reads and writes end.
    pub(crate) fn shut(&self) {
        // A socket that is already closed needs no shutdown.
        drop(self.0.0.shutdown(Shutdown::Both));
    }
}

/// The sending half of a connection, for any thread.
#[derive(Debug)]
pub(crate) struct Sender {
    socket: Mutex<Socket>,
    lost: AtomicBool,
}

/// The receiving half of a connection.
#[derive(Debug)]
pub(crate) struct Receiver {
    lines: BufReader<Socket>,
    line: Vec<u8>,
}

/// One line from a viewer.
#[derive(Debug)]
pub(crate) enum IncomingLine {
    /// A text without its newline.
    Text(String),
    /// Bytes that are no line of text.
    Nonsense,
}

/// The connection to one viewer, after the hellos.
#[derive(Debug)]
pub(crate) struct Line {
    pub(crate) sender: Sender,
    pub(crate) receiver: Receiver,
    pub(crate) socket: Socket,
}

/// Exchanges hellos with a viewer.
pub(crate) fn open(socket: Socket) -> Result<Line, TalkError> {
    let sender = Sender { socket: Mutex::new(socket.clone()), lost: AtomicBool::new(false) };
    let mut receiver = Receiver { lines: BufReader::new(socket.clone()), line: Vec::new() };
    sender.write(&encode(&Hello::ours())?)?;
    receiver.message::<Hello>()?.check()?;
    Ok(Line { sender, receiver, socket })
}

impl Sender {
    /// Sends one message. A lost viewer is not an error: the run continues.
    pub(crate) fn send(&self, message: &ToViewer) {
        if let Ok(frame) = encode_frame(message) {
            self.send_frame(&frame);
        }
    }

    /// Sends an encoded frame.
    pub(crate) fn send_frame(&self, frame: &[u8]) {
        if !self.is_lost() && self.write(frame).is_err() {
            self.lose();
        }
    }

    /// Marks the connection as lost.
    pub(crate) fn lose(&self) {
        self.lost.store(true, Ordering::Relaxed);
    }

    /// True if the viewer no longer listens.
    pub(crate) fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }

    fn write(&self, bytes: &[u8]) -> io::Result<()> {
        (&self.socket.lock().0.0).write_all(bytes)
    }
}

impl Receiver {
    /// The next line; `None` after the end of the connection.
    pub(crate) fn line(&mut self) -> Option<IncomingLine> {
        self.line.clear();
        let mut limited = self.lines.by_ref().take(LINE_BYTES_MAX);
        let count = limited.read_until(b'\n', &mut self.line).ok()?;
        if count == 0 {
            return None;
        }
        if self.line.pop() != Some(b'\n') {
            // The rest of a line that is too long is no message of its own.
            self.line = Vec::new();
            self.lines.skip_until(b'\n').ok()?;
            return Some(IncomingLine::Nonsense);
        }
        let text = String::from_utf8(std::mem::take(&mut self.line));
        Some(text.map_or(IncomingLine::Nonsense, IncomingLine::Text))
    }

    /// The next line, decoded as a message.
    pub(crate) fn message<T: DeserializeOwned>(&mut self) -> Result<T, TalkError> {
        match self.line() {
            None => Err(TalkError::Gone),
            Some(IncomingLine::Text(text)) => Ok(decode(&text)?),
            Some(IncomingLine::Nonsense) => Ok(decode("(not a line of text)")?),
        }
    }
}
