//! How datagrams reach the other side: by UDP, or as messages of a WebSocket where UDP is closed. What is sent may be lost: a network
//! that is not there is a link that loses everything.

mod acceptor;
mod connection;
mod dialler;

pub use acceptor::Secure;
pub use connection::ByteStream;
pub use dialler::Dial;

pub(crate) use acceptor::accept_connections;
pub(crate) use dialler::Dialler;

use connection::Connection;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;

/// Address at which a station receives.
#[derive(Debug, Clone)]
pub enum StationAddress {
    /// By UDP, at this address.
    Udp(SocketAddr),
    /// By a WebSocket that is opened in this way.
    WebSocket(Arc<dyn Dial>),
}

/// Transport of datagrams to one peer.
#[derive(Debug, Clone)]
pub(crate) enum Carrier {
    /// From this socket to this address.
    Udp(Arc<UdpSocket>, SocketAddr),
    /// By this connection, while it is open.
    Connection(Arc<Connection>),
    /// Over the connections that this opens.
    Dialler(Arc<Dialler>),
}

/// Takes what arrives, with what carries an answer.
pub(crate) type Deliver = Arc<dyn Fn(Carrier, Vec<u8>) + Send + Sync>;

impl Carrier {
    /// Sends a datagram, without ever waiting.
    pub(crate) fn send(&self, datagram: &[u8]) {
        match self {
            Self::Udp(socket, to) => drop(socket.send_to(datagram, to)),
            Self::Connection(connection) => connection.send(datagram),
            Self::Dialler(dialler) => dialler.send(datagram),
        }
    }

    /// The other side made what this has delivered: so it leads there.
    pub(crate) fn note_heard(&self) {
        if let Self::Connection(connection) = self {
            connection.note_heard();
        }
    }
}

/// Any port of this computer, in the kind of network in which the station is.
pub(crate) fn any_port(station: SocketAddr) -> SocketAddr {
    match (station, station.ip().is_loopback()) {
        (SocketAddr::V4(_), true) => ([127, 0, 0, 1], 0).into(),
        (SocketAddr::V4(_), false) => ([0, 0, 0, 0], 0).into(),
        (SocketAddr::V6(_), _) => ([0_u16; 8], 0).into(),
    }
}
