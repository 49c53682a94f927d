//! Where a robot opens a WebSocket to a station. Each datagram proves itself, so anyone may come in; those who have proved nothing make
//! room for others.

use super::Deliver;
use super::connection::{ByteStream, Connection, carry, websocket_config};
use crate::clock::SessionClock;
use crate::inbox::{LOOK, Stopper};
use parking_lot::Mutex;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::net::{IpAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::thread;
use std::time::Duration;
use tungstenite::accept_with_config;

/// Limit of connections.
const CONNECTIONS_MAX: usize = 64;
/// Silence after which the connection of a robot loses its priority. It may have died without a notice.
const LATELY: Duration = Duration::from_mins(5);
/// The first byte of a client that speaks TLS.
const TLS_HANDSHAKE: u8 = 22;

/// Speaks TLS with those who ask for it.
pub trait Secure: fmt::Debug + Send + Sync {
    /// The stream inside of TLS. It may wait for the client.
    fn secure(&self, stream: TcpStream) -> io::Result<Box<dyn ByteStream>>;
}

/// Lets robots in until it is stopped. What arrives is delivered.
pub(crate) fn accept_connections(
    listener: TcpListener,
    tls: Option<Arc<dyn Secure>>,
    deliver: Deliver,
    stopper: &Stopper,
) -> io::Result<()> {
    listener.set_nonblocking(true)?;
    let acceptor =
        Acceptor { tls, deliver, clock: SessionClock::begin(), connections: Mutex::default() };
    let (acceptor, stopped) = (Arc::new(acceptor), stopper.clone());
    let accept = move || {
        while !stopped.is_stopped() {
            if let Some(stream) = accept(&listener) {
                // A refused peer dials again.
                drop(acceptor.add(stream));
            }
        }
        acceptor.connections.lock().iter().for_each(|connection| connection.close());
    };
    stopper.spawn("door", accept)
}

/// Accepts the next connection. `None` after the timeout.
fn accept(listener: &TcpListener) -> Option<TcpStream> {
    let look = Timespec::try_from(LOOK).ok();
    let ready = poll(&mut [PollFd::new(listener, PollFlags::IN)], look.as_ref());
    match listener.accept() {
        Ok((stream, _from)) => stream.set_nonblocking(false).ok().map(|()| stream),
        Err(error) => {
            if ready.is_ok() && error.kind() != io::ErrorKind::WouldBlock {
                // An immediate retry would fail again, for example without a free descriptor.
                poll(&mut [], look.as_ref()).unwrap_or_default();
            }
            None
        }
    }
}

struct Acceptor {
    tls: Option<Arc<dyn Secure>>,
    deliver: Deliver,
    clock: SessionClock,
    connections: Mutex<Vec<Arc<Connection>>>,
}

impl Acceptor {
    fn add(self: &Arc<Self>, stream: TcpStream) -> io::Result<()> {
        let connection = Connection::new(&stream, self.clock)?;
        self.make_room();
        self.connections.lock().push(Arc::clone(&connection));
        let (acceptor, served) = (Arc::clone(self), Arc::clone(&connection));
        let serve = move || {
            drop(acceptor.serve(stream, &served));
            served.close();
        };
        let begun = thread::Builder::new().name("websocket".to_owned()).spawn(serve);
        begun.map(drop).inspect_err(|_| connection.close())
    }

    /// Connections without a recent datagram of a robot are closed first: the oldest one of the address with most of them, so
    /// that repeated connections replace only their own.
    fn make_room(&self) {
        let mut connections = self.connections.lock();
        connections.retain(|connection| !connection.is_closed());
        let now = self.clock.now();
        while connections.len() >= CONNECTIONS_MAX {
            let is_heard = |connection: &Connection| {
                connection.heard().is_some_and(|at| now.since(at) < LATELY)
            };
            let mut unheard: BTreeMap<Option<IpAddr>, usize> = BTreeMap::new();
            for connection in connections.iter().filter(|connection| !is_heard(connection)) {
                *unheard.entry(connection.address()).or_default() += 1;
            }
            let worth = |at: &usize| {
                let connection = &connections[*at];
                let of_its_address = unheard.get(&connection.address()).copied();
                (is_heard(connection), Reverse(of_its_address), connection.silent_since())
            };
            let Some(least) = (0..connections.len()).min_by_key(worth) else { return };
            connections.swap_remove(least).close();
        }
    }

    /// Speaks with one who came until they go.
    fn serve(&self, stream: TcpStream, connection: &Arc<Connection>) -> io::Result<()> {
        let mut first = [0];
        stream.peek(&mut first)?;
        let stream: Box<dyn ByteStream> = match &self.tls {
            Some(tls) if first == [TLS_HANDSHAKE] => tls.secure(stream)?,
            _ => Box::new(stream),
        };
        let socket = accept_with_config(stream, Some(websocket_config()));
        let socket = socket.map_err(|error| io::Error::other(error.to_string()))?;
        carry(socket, connection, &self.deliver);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Acceptor, CONNECTIONS_MAX, Connection};
    use crate::clock::SessionClock;
    use parking_lot::Mutex;
    use socket2::{Domain, Socket, Type};
    use std::net::{SocketAddr, TcpListener};
    use std::sync::Arc;

    /// An acceptor, and a function that connects from an address.
    fn acceptor() -> (Arc<Acceptor>, impl FnMut([u8; 4])) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let acceptor = Arc::new(Acceptor {
            tls: None,
            deliver: Arc::new(|_, _| {}),
            clock: SessionClock::begin(),
            connections: Mutex::default(),
        });
        let mut open = Vec::new();
        let inside = Arc::clone(&acceptor);
        let come = move |from: [u8; 4]| {
            let stream = Socket::new(Domain::IPV4, Type::STREAM, None).unwrap();
            stream.bind(&SocketAddr::from((from, 0)).into()).unwrap();
            stream.connect(&address.into()).unwrap();
            open.push(stream);
            inside.add(listener.accept().unwrap().0).unwrap();
        };
        (acceptor, come)
    }

    /// Positions of the closed connections.
    fn closed(connections: &[Arc<Connection>]) -> Vec<usize> {
        let closed =
            connections.iter().enumerate().filter(|(_, connection)| connection.is_closed());
        closed.map(|(at, _)| at).collect()
    }

    #[test]
    fn who_has_proved_nothing_makes_room() {
        let (acceptor, mut come) = acceptor();
        (0..CONNECTIONS_MAX).for_each(|_| come([127, 0, 0, 1]));
        let connections = acceptor.connections.lock().clone();
        connections[0].note_heard();
        come([127, 0, 0, 1]);
        assert_eq!(
            (closed(&connections), acceptor.connections.lock().len()),
            (vec![1], CONNECTIONS_MAX)
        );
    }

    #[test]
    fn who_comes_a_thousand_times_drives_out_no_robot_that_has_just_come() {
        let (acceptor, mut come) = acceptor();
        come([127, 0, 0, 2]);
        let robot = Arc::clone(&acceptor.connections.lock()[0]);
        (0..1_000).for_each(|_| come([127, 0, 0, 1]));
        assert!(!robot.is_closed());
        assert_eq!(acceptor.connections.lock().len(), CONNECTIONS_MAX);
    }
}
