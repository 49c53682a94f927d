//! How datagrams reach the other side. What is sent may be lost: a network that is not there is a link that loses everything.

use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;

/// Where a station receives.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StationAddress {
    /// By UDP, at this address.
    Udp(SocketAddr),
}

/// What carries datagrams to one other side.
#[derive(Debug, Clone)]
pub(crate) enum Carrier {
    /// From this socket to this address.
    Udp(Arc<UdpSocket>, SocketAddr),
}

impl Carrier {
    /// Sends a datagram, without ever waiting.
    pub(crate) fn send(&self, datagram: &[u8]) {
        match self {
            Self::Udp(socket, to) => drop(socket.send_to(datagram, to)),
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
