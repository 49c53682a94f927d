//! The talk with one viewer: lines in, frames out. Knows messages, but not what they lead to.

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

/// No message of a viewer is longer.
const LINE_BYTES_MAX: u64 = 16 << 20;

/// Why a talk did not begin.
#[derive(Debug, thiserror::Error)]
pub enum TalkError {
    /// The socket broke.
    #[error("the connection to the viewer broke")]
    Io(#[from] io::Error),
    /// The viewer said something else.
    #[error("the viewer's first lines are not those of this protocol")]
    Frame(#[from] FrameError),
    /// The viewer is of another version.
    #[error(transparent)]
    Version(#[from] rafcon_protocol::VersionMismatch),
    /// The viewer went away before it said what to run.
    #[error("the viewer went away before it said what to run")]
    Gone,
    /// The viewer wants something else than to join.
    #[error("the viewer's first message is not a join")]
    NoJoin,
}

/// The descriptors of all sockets of this process.
static OPEN: Mutex<BTreeSet<RawFd>> = Mutex::new(BTreeSet::new());

/// The descriptors of all sockets of this process, and of the locks of its runs. A forked copy closes them first of all: who
/// listens at the other end is to see the end of the runner, and not that of its copies, and a run is not alive because a copy
/// of its runner is. Never waits.
pub fn descriptors() -> Vec<RawFd> {
    let sockets = OPEN.try_lock();
    let sockets = sockets.iter().flat_map(|open| open.iter().copied());
    sockets.chain(rafcon_storage::journal::locks()).collect()
}

/// A descriptor that a forked copy lets go of.
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

/// The socket. There is one descriptor of it and no copy, so that a forked process can let go of it.
#[derive(Debug, Clone)]
pub(crate) struct Socket(Arc<TrackedDescriptor<UnixStream>>);

impl Read for Socket {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        (&self.0.0).read(buffer)
    }
}

impl Socket {
    /// A connection that nothing was said on.
    pub(crate) fn new(stream: UnixStream) -> Self {
        Self(Arc::new(TrackedDescriptor::new(stream)))
    }

    /// Whether both are the same connection.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// How long a read waits.
    pub(crate) fn wait_at_most(&self, time: Option<Duration>) -> io::Result<()> {
        self.0.0.set_read_timeout(time)
    }

    /// Closes the talk, so that a blocked write or read ends.
    pub(crate) fn shut(&self) {
        // A socket that is closed already is as closed as it should be.
        drop(self.0.0.shutdown(Shutdown::Both));
    }
}

/// The end that is written to; any thread may.
#[derive(Debug)]
pub(crate) struct Sender {
    socket: Mutex<Socket>,
    lost: AtomicBool,
}

/// The end that is read from.
#[derive(Debug)]
pub(crate) struct Receiver {
    lines: BufReader<Socket>,
    line: Vec<u8>,
}

/// One line that was read.
#[derive(Debug)]
pub(crate) enum IncomingLine {
    /// A text, without its newline.
    Text(String),
    /// Something that is no line of text.
    Nonsense,
}

/// The connection to one viewer, hellos said.
#[derive(Debug)]
pub(crate) struct Line {
    pub(crate) sender: Sender,
    pub(crate) receiver: Receiver,
    pub(crate) socket: Socket,
}

/// Exchanges hellos.
pub(crate) fn open(socket: Socket) -> Result<Line, TalkError> {
    let sender = Sender { socket: Mutex::new(socket.clone()), lost: AtomicBool::new(false) };
    let mut receiver = Receiver { lines: BufReader::new(socket.clone()), line: Vec::new() };
    sender.write(&encode(&Hello::ours())?)?;
    receiver.message::<Hello>()?.check()?;
    Ok(Line { sender, receiver, socket })
}

impl Sender {
    /// Sends one message. A viewer that is gone is not an error: the run continues.
    pub(crate) fn send(&self, message: &ToViewer) {
        if let Ok(frame) = encode_frame(message) {
            self.send_frame(&frame);
        }
    }

    /// Sends a frame that is encoded already.
    pub(crate) fn send_frame(&self, frame: &[u8]) {
        if !self.is_lost() && self.write(frame).is_err() {
            self.lose();
        }
    }

    /// No one listens any more.
    pub(crate) fn lose(&self) {
        self.lost.store(true, Ordering::Relaxed);
    }

    /// Whether no one listens any more.
    pub(crate) fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }

    fn write(&self, bytes: &[u8]) -> io::Result<()> {
        (&self.socket.lock().0.0).write_all(bytes)
    }
}

impl Receiver {
    /// The next line; `None` when the viewer is gone.
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

    /// The next line as a message.
    pub(crate) fn message<T: DeserializeOwned>(&mut self) -> Result<T, TalkError> {
        match self.line() {
            None => Err(TalkError::Gone),
            Some(IncomingLine::Text(text)) => Ok(decode(&text)?),
            Some(IncomingLine::Nonsense) => Ok(decode("(not a line of text)")?),
        }
    }
}
