//! Detects a killed process long before its lease ends: no socket is open at its addresses any more.
//!
//! The kernel refuses a datagram to a closed port. A process is dead if all its addresses refuse twice in a row; a slow
//! process refuses nothing. A process is also dead if another one uses its addresses, because a restarted process gets its
//! old ports. A disconnected computer refuses nothing; its processes end with their leases.

use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::time::Duration;

use rustdds::DomainParticipant;
use tokio::net::UdpSocket;

use super::graph::{self, Graph, Process};

/// Interval of the probes of a process.
const PERIOD: Duration = Duration::from_millis(400);

/// An RTPS 2.3 message without content: its header, an unknown vendor, and padding.
const NOTHING: [u8; 24] = *b"RTPS\x02\x03\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x01\x01\0\0";

/// Probes all matched processes, forever.
pub(crate) async fn watch(graph: Graph, participant: DomainParticipant) {
    let mut asked: BTreeMap<Process, Questions> = BTreeMap::new();
    let mut period = tokio::time::interval(PERIOD);
    period.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    loop {
        period.tick().await;
        let wanted = graph.processes();
        asked.retain(|process, _| wanted.contains(process));
        if wanted.iter().any(|process| !asked.contains_key(process)) {
            for (process, addresses) in graph::addresses(&participant) {
                if wanted.contains(&process)
                    && !asked.contains_key(&process)
                    && !addresses.is_empty()
                {
                    asked.insert(process, Questions::to(addresses).await);
                }
            }
        }
        let places: Vec<_> = asked.iter().map(|(it, of)| (*it, of.addresses.clone())).collect();
        for (process, questions) in &mut asked {
            let refused = questions.ask();
            let is_replaced = places.iter().any(|(later, addresses)| {
                *addresses == questions.addresses && graph.came_before(*process, *later)
            });
            let is_dead = is_replaced || refused && questions.refused_before;
            graph.set_dead(*process, is_dead);
            questions.refused_before = refused;
        }
    }
}

struct Questions {
    addresses: BTreeSet<SocketAddr>,
    /// One socket per address; `None` if the address is unreachable from here.
    sockets: Vec<Option<UdpSocket>>,
    refused_before: bool,
}

impl Questions {
    async fn to(addresses: BTreeSet<SocketAddr>) -> Self {
        let sockets = futures::future::join_all(addresses.iter().copied().map(open)).await;
        Self { addresses, sockets, refused_before: false }
    }

    /// Sends a probe; true if every address has refused an earlier one.
    fn ask(&self) -> bool {
        let mut refused = 0;
        for socket in self.sockets.iter().flatten() {
            // An error of an earlier datagram is the result of that probe.
            let before = matches!(socket.take_error(), Ok(Some(why)) if why.kind() == ErrorKind::ConnectionRefused);
            let now = matches!(socket.try_send(&NOTHING), Err(why) if why.kind() == ErrorKind::ConnectionRefused);
            if now {
                // The error belonged to an earlier datagram, and this one was not sent.
                let _ = socket.try_send(&NOTHING);
            }
            refused += usize::from(before || now);
        }
        refused > 0 && refused == self.sockets.iter().flatten().count()
    }
}

async fn open(to: SocketAddr) -> Option<UdpSocket> {
    let any = match to {
        SocketAddr::V4(_) => IpAddr::V4(Ipv4Addr::UNSPECIFIED),
        SocketAddr::V6(_) => IpAddr::V6(Ipv6Addr::UNSPECIFIED),
    };
    let socket = UdpSocket::bind((any, 0)).await.ok()?;
    socket.connect(to).await.ok()?;
    Some(socket)
}
