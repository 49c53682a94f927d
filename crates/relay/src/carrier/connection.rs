//! One WebSocket whose binary messages are datagrams, on a thread of its own. Whoever sends never waits for it: what it cannot write in
//! time is dropped, the oldest first, as a network does it.

use super::{Carrier, Deliver};
use crate::clock::SessionClock;
use parking_lot::Mutex;
use rafcon_link::SessionTime;
use rustix::event::{EventfdFlags, PollFd, PollFlags, Timespec, eventfd, poll};
use rustix::io::Errno;
use socket2::SockRef;
use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::net::{IpAddr, Shutdown, TcpStream};
use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Error, Message, WebSocket};

/// No message is longer; datagrams are far shorter.
const MESSAGE_MAX: usize = 4_096;
/// Capacity of the send queue, in datagrams.
const WAITING_MAX: usize = 64;
/// None waits longer: after a stall the newest come first.
const WAITS_MAX: Duration = Duration::from_secs(1);
/// Capacity of the kernel's send buffer, in bytes.
const UNSENT_MAX: u32 = 8_192;
/// Messages read before the next write.
const READ_AT_ONCE: usize = 64;
/// Handshake timeout.
const PATIENCE: Duration = Duration::from_secs(30);

/// A stream of bytes over TCP, plain or by TLS.
pub trait ByteStream: Read + Write + Send {
    /// The socket below.
    fn socket(&self) -> &TcpStream;
}

impl ByteStream for TcpStream {
    fn socket(&self) -> &TcpStream {
        self
    }
}

/// A WebSocket over such a stream.
pub(super) type Socket = WebSocket<Box<dyn ByteStream>>;

/// Send queue.
#[derive(Debug, Default)]
struct Waiting(VecDeque<(SessionTime, Vec<u8>)>);

impl Waiting {
    fn push(&mut self, now: SessionTime, datagram: &[u8]) {
        if self.0.len() >= WAITING_MAX {
            self.0.pop_front();
        }
        self.0.push_back((now, datagram.to_vec()));
    }

    /// The oldest that is not too old.
    fn next(&mut self, now: SessionTime) -> Option<Vec<u8>> {
        while let Some((since, datagram)) = self.0.pop_front() {
            if now.since(since) <= WAITS_MAX {
                return Some(datagram);
            }
        }
        None
    }
}

/// A connection as those know it who send over it.
#[derive(Debug)]
pub(crate) struct Connection {
    /// `None` once it is closed. A close frame reaches a peer that still writes.
    socket: Mutex<Option<TcpStream>>,
    /// Address of the peer.
    address: Option<IpAddr>,
    clock: SessionClock,
    opened: SessionTime,
    waiting: Mutex<Waiting>,
    /// Wakes the thread.
    wake: OwnedFd,
    /// When something of the other side came over it.
    heard: Mutex<Option<SessionTime>>,
    /// When the first datagram since then was sent.
    unanswered: Mutex<Option<SessionTime>>,
    is_closed: AtomicBool,
}

impl Connection {
    /// The connection of this socket, whose messages [`carry`] carries.
    pub(super) fn new(socket: &TcpStream, clock: SessionClock) -> io::Result<Arc<Self>> {
        socket.set_nodelay(true)?;
        socket.set_read_timeout(Some(PATIENCE))?;
        socket.set_write_timeout(Some(PATIENCE))?;
        // Else what a slow link cannot carry would wait in the kernel, and be old when it arrives.
        SockRef::from(socket).set_tcp_notsent_lowat(UNSENT_MAX)?;
        Ok(Arc::new(Self {
            socket: Mutex::new(Some(socket.try_clone()?)),
            address: socket.peer_addr().ok().map(|address| address.ip()),
            clock,
            opened: clock.now(),
            waiting: Mutex::default(),
            wake: eventfd(0, EventfdFlags::NONBLOCK | EventfdFlags::CLOEXEC)?,
            heard: Mutex::default(),
            unanswered: Mutex::default(),
            is_closed: AtomicBool::new(false),
        }))
    }

    pub(super) fn send(&self, datagram: &[u8]) {
        let now = self.clock.now();
        self.unanswered.lock().get_or_insert(now);
        self.waiting.lock().push(now, datagram);
        self.wake();
    }

    fn next_waiting(&self) -> Option<Vec<u8>> {
        self.waiting.lock().next(self.clock.now())
    }

    pub(super) fn address(&self) -> Option<IpAddr> {
        self.address
    }

    pub(super) fn note_heard(&self) {
        *self.heard.lock() = Some(self.clock.now());
        *self.unanswered.lock() = None;
    }

    /// Time of the last valid datagram received.
    pub(super) fn heard(&self) -> Option<SessionTime> {
        *self.heard.lock()
    }

    /// Start of the present silence.
    pub(super) fn silent_since(&self) -> SessionTime {
        self.heard().unwrap_or(self.opened)
    }

    /// Time since which an answer is pending. A peer that received nothing owes none.
    pub(super) fn unanswered_since(&self) -> Option<SessionTime> {
        *self.unanswered.lock()
    }

    pub(super) fn is_closed(&self) -> bool {
        self.is_closed.load(Ordering::Acquire)
    }

    /// Closes it, whatever its thread waits for.
    pub(super) fn close(&self) {
        self.is_closed.store(true, Ordering::Release);
        if let Some(socket) = self.socket.lock().take() {
            drop(socket.shutdown(Shutdown::Both));
        }
        self.wake();
    }

    fn wake(&self) {
        // A counter that is full wakes as well.
        rustix::io::write(&self.wake, &1_u64.to_ne_bytes()).unwrap_or_default();
    }
}

/// Protocol parameters of both sides.
pub(super) fn websocket_config() -> WebSocketConfig {
    WebSocketConfig::default()
        .max_message_size(Some(MESSAGE_MAX))
        .max_frame_size(Some(MESSAGE_MAX))
        .read_buffer_size(4 * MESSAGE_MAX)
        .write_buffer_size(0)
        .max_write_buffer_size(16 * MESSAGE_MAX)
}

/// Carries the messages of a connection until it is closed from either side.
pub(super) fn carry(mut socket: Socket, connection: &Arc<Connection>, deliver: &Deliver) {
    let begun = socket.get_ref().socket().set_nonblocking(true).map_err(Error::Io);
    let ended = begun.and_then(|()| carry_on(&mut socket, connection, deliver));
    // Another connection is opened in both cases, closed and cut.
    drop(ended);
    connection.close();
}

fn carry_on(
    socket: &mut Socket,
    connection: &Arc<Connection>,
    deliver: &Deliver,
) -> Result<(), Error> {
    let mut is_full = false;
    while !connection.is_closed() {
        if is_full {
            is_full = !is_done(socket.flush())?;
        }
        while !is_full && let Some(datagram) = connection.next_waiting() {
            let written = socket.write(Message::binary(datagram));
            is_full = !is_done(written.and_then(|()| socket.flush()))?;
        }
        let mut read = 0;
        while read < READ_AT_ONCE
            && let Some(message) = next_message(socket)?
        {
            read += 1;
            if let Message::Binary(datagram) = message {
                deliver(Carrier::Connection(Arc::clone(connection)), datagram.into());
            }
        }
        if read < READ_AT_ONCE {
            wait(socket, connection, is_full).map_err(Error::Io)?;
        }
    }
    Ok(())
}

/// Returns true if everything is written, false if the socket is full.
fn is_done(written: Result<(), Error>) -> Result<bool, Error> {
    match written {
        Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => Ok(false),
        written => written.map(|()| true),
    }
}

fn next_message(socket: &mut Socket) -> Result<Option<Message>, Error> {
    match socket.read() {
        Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => Ok(None),
        read => read.map(Some),
    }
}

/// Waits until there is something to read, to write, or room.
fn wait(socket: &Socket, connection: &Connection, is_full: bool) -> io::Result<()> {
    let more = if is_full { PollFlags::OUT } else { PollFlags::empty() };
    let mut wanted = [
        PollFd::new(socket.get_ref().socket(), PollFlags::IN | more),
        PollFd::new(&connection.wake, PollFlags::IN),
    ];
    match poll(&mut wanted, None::<&Timespec>) {
        Ok(_) | Err(Errno::INTR) => {}
        Err(error) => return Err(error.into()),
    }
    // The pipe is read until it is empty, so that no wake-up remains.
    rustix::io::read(&connection.wake, &mut [0; 8]).unwrap_or_default();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{ByteStream, Connection, UNSENT_MAX, WAITING_MAX, WAITS_MAX, Waiting, carry};
    use crate::clock::SessionClock;
    use rafcon_link::SessionTime;
    use socket2::{Domain, Socket, Type};
    use std::io::Read as _;
    use std::net::{TcpListener, TcpStream};
    use std::sync::Arc;
    use std::thread;
    use tungstenite::WebSocket;
    use tungstenite::protocol::Role;

    fn numbers(waiting: &mut Waiting, now: SessionTime) -> Vec<u8> {
        std::iter::from_fn(|| waiting.next(now)).flatten().collect()
    }

    #[test]
    fn of_what_cannot_be_written_the_newest_waits_and_not_for_long() {
        let mut waiting = Waiting::default();
        let [early, late] = [1_000, 2_000].map(SessionTime::from_millis);
        (0..200).for_each(|number| waiting.push(early, &[number]));
        assert_eq!(waiting.0.len(), WAITING_MAX);
        waiting.push(late, &[200]);
        let newest: Vec<u8> = (u8::try_from(201 - WAITING_MAX).unwrap()..=200).collect();
        assert_eq!(numbers(&mut waiting, early + WAITS_MAX), newest);
        waiting.push(early, &[1]);
        waiting.push(late, &[2]);
        assert_eq!(numbers(&mut waiting, late + WAITS_MAX), [2]);
    }

    #[test]
    fn a_connection_that_hangs_holds_little() {
        const ROOM: usize = 4_096;
        let listener = Socket::new(Domain::IPV4, Type::STREAM, None).unwrap();
        listener.set_recv_buffer_size(ROOM).unwrap();
        listener.bind(&std::net::SocketAddr::from(([127, 0, 0, 1], 0)).into()).unwrap();
        listener.listen(1).unwrap();
        let listener = TcpListener::from(listener);
        let socket = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (mut other_side, _) = listener.accept().unwrap();
        let connection = Connection::new(&socket, SessionClock::begin()).unwrap();
        let stream: Box<dyn ByteStream> = Box::new(socket);
        let socket = WebSocket::from_raw_socket(stream, Role::Server, None);
        let carried = Arc::clone(&connection);
        let carry = move || carry(socket, &carried, &(Arc::new(|_, _| {}) as _));
        let carrying = thread::Builder::new().spawn(carry).unwrap();
        // The other side reads nothing of all this until the connection is given up.
        (0..10_000).for_each(|_| connection.send(&[7; 1_000]));
        assert_eq!(other_side.peek(&mut [0]).unwrap(), 1);
        connection.close();
        carrying.join().unwrap();
        let mut arrived = Vec::new();
        other_side.read_to_end(&mut arrived).unwrap();
        let bound = 4 * ROOM + 2 * usize::try_from(UNSENT_MAX).unwrap();
        assert!((1_000..bound).contains(&arrived.len()), "{} B", arrived.len());
    }
}
