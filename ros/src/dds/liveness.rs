//! Finds out that a process was killed long before its lease ends: nothing listens at its addresses any more.
//!
//! A datagram to a port that nobody has open is refused by the kernel of its computer. A process whose every address
//! refuses, twice in a row, is dead; one that is only slow refuses nothing. So is one whose addresses another process has since: one
//! that is started again takes the same ports. A computer that is gone refuses nothing: that is what the lease is for.

use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::time::Duration;

use rustdds::DomainParticipant;
use tokio::net::UdpSocket;

use super::graph::{self, Graph, Process};

/// Between two questions.
const PERIOD: Duration = Duration::from_millis(400);

/// A message of RTPS 2.3 that says nothing: its header, an unknown vendor, and padding.
const NOTHING: [u8; 24] = *b"RTPS\x02\x03\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x01\x01\0\0";

/// Asks all processes that matter, for ever.
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
    /// One for each address; `None` if it cannot be reached from here.
    sockets: Vec<Option<UdpSocket>>,
    refused_before: bool,
}

impl Questions {
    async fn to(addresses: BTreeSet<SocketAddr>) -> Self {
        let sockets = futures::future::join_all(addresses.iter().copied().map(open)).await;
        Self { addresses, sockets, refused_before: false }
    }

    /// Asks again; true if every address has refused what was asked before.
    fn ask(&self) -> bool {
        let mut refused = 0;
        for socket in self.sockets.iter().flatten() {
            // What the kernel knows about an earlier datagram is the result of this one.
            let before = matches!(socket.take_error(), Ok(Some(why)) if why.kind() == ErrorKind::ConnectionRefused);
            let now = matches!(socket.try_send(&NOTHING), Err(why) if why.kind() == ErrorKind::ConnectionRefused);
            if now {
                // The error was that of an earlier datagram, and this one was not sent.
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
