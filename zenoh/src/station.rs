//! The side of a station. Each robot of the fleet has its own port, from which its datagrams are sent to the station, so
//! that the station's responses reach that robot.

use crate::carry::{DATAGRAM_MAX, LastHeard, keep_session, put, receive};
use crate::command_line::{Network, StationSide, complain, print};
use crate::keys::Fleet;
use anyhow::{Result, anyhow};
use std::collections::BTreeMap;
use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::net::UdpSocket;
use tokio::runtime::Handle;
use tokio::task::AbortHandle;
use zenoh::Session;
use zenoh::qos::Priority;

/// Maximum number of robots with a port. Beyond it, ports of robots without a response from the station are closed: the
/// station does not know these robots.
const ROBOTS_MAX: usize = 256;

/// Carries the datagrams of a fleet to a station until this program ends.
pub(crate) async fn carry(network: &Network, side: &StationSide) -> Result<()> {
    print(&format!("robots of `{}` are carried to udp://{}", network.fleet, side.to));
    keep_session(network, |session, heard| carry_in(network, side.to, session, heard)).await
}

async fn carry_in(
    network: &Network,
    to: SocketAddr,
    session: Session,
    heard: Arc<LastHeard>,
) -> Result<()> {
    let ports = Ports {
        fleet: network.fleet.clone(),
        to,
        session: session.clone(),
        handle: Handle::current(),
        ports: Mutex::default(),
        is_full: AtomicBool::new(false),
    };
    let arrivals = session.declare_subscriber(network.fleet.down("*")).callback(move |sample| {
        heard.note();
        let payload = sample.payload().to_bytes();
        if let Some(robot) = ports.fleet.robot(sample.key_expr().as_str())
            && payload.len() <= DATAGRAM_MAX
        {
            ports.send(robot, &payload);
        }
    });
    let _arrivals = arrivals.await.map_err(|error| anyhow!(error))?;
    std::future::pending().await
}

/// The ports of the robots.
struct Ports {
    fleet: Fleet,
    to: SocketAddr,
    session: Session,
    handle: Handle,
    ports: Mutex<BTreeMap<String, Port>>,
    /// True if a robot got no port and this was reported.
    is_full: AtomicBool,
}

/// The port of one robot.
struct Port {
    socket: Arc<UdpSocket>,
    is_answered: Arc<AtomicBool>,
    answers: AbortHandle,
}

impl Drop for Port {
    fn drop(&mut self) {
        self.answers.abort();
    }
}

impl Ports {
    fn send(&self, robot: &str, datagram: &[u8]) {
        let mut ports = self.ports.lock().unwrap_or_else(PoisonError::into_inner);
        if !ports.contains_key(robot) {
            if !make_room(&mut ports) {
                if !self.is_full.swap(true, Ordering::AcqRel) {
                    complain(&format!(
                        "the station answers {ROBOTS_MAX} robots: `{robot}` and further ones are not carried"
                    ));
                }
                return;
            }
            // Without a port the datagram is lost, as on any link.
            let Ok(port) = self.open(robot) else { return };
            ports.insert(robot.to_owned(), port);
        }
        if let Some(port) = ports.get(robot) {
            drop(port.socket.try_send(datagram));
        }
    }

    fn open(&self, robot: &str) -> io::Result<Port> {
        let any: SocketAddr = match (self.to, self.to.ip().is_loopback()) {
            (SocketAddr::V4(_), true) => (Ipv4Addr::LOCALHOST, 0).into(),
            (SocketAddr::V4(_), false) => (Ipv4Addr::UNSPECIFIED, 0).into(),
            (SocketAddr::V6(_), _) => (Ipv6Addr::UNSPECIFIED, 0).into(),
        };
        let socket = std::net::UdpSocket::bind(any)?;
        socket.connect(self.to)?;
        socket.set_nonblocking(true)?;
        let _context = self.handle.enter();
        let socket = Arc::new(UdpSocket::from_std(socket)?);
        let is_answered = Arc::new(AtomicBool::new(false));
        let answers = carry_answers(
            self.session.clone(),
            self.fleet.up(robot),
            Arc::clone(&socket),
            Arc::clone(&is_answered),
        );
        let answers = self.handle.spawn(answers).abort_handle();
        Ok(Port { socket, is_answered, answers })
    }
}

/// Makes room for one more port. False if the station has responded to every robot that has one.
fn make_room(ports: &mut BTreeMap<String, Port>) -> bool {
    if ports.len() < ROBOTS_MAX {
        return true;
    }
    let stranger = ports.iter().find(|(_, port)| !port.is_answered.load(Ordering::Acquire));
    let stranger = stranger.map(|(name, _)| name.clone());
    stranger.is_some_and(|name| ports.remove(&name).is_some())
}

/// Forwards the station's datagrams to a robot.
async fn carry_answers(
    session: Session,
    up: String,
    socket: Arc<UdpSocket>,
    is_answered: Arc<AtomicBool>,
) {
    let mut buffer = [0; DATAGRAM_MAX + 1];
    loop {
        let (datagram, _) = receive(&socket, &mut buffer).await;
        is_answered.store(true, Ordering::Release);
        put(&session, &up, datagram, Priority::InteractiveHigh).await;
    }
}

#[cfg(test)]
mod tests {
    use super::{Port, ROBOTS_MAX, make_room};
    use std::collections::BTreeMap;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use tokio::net::UdpSocket;

    async fn port(is_answered: bool) -> Port {
        let socket = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        let answers = tokio::spawn(std::future::pending::<()>()).abort_handle();
        let is_answered = Arc::new(AtomicBool::new(is_answered));
        Port { socket: Arc::new(socket), is_answered, answers }
    }

    #[tokio::test]
    async fn a_robot_that_the_station_never_answered_makes_room_and_one_that_it_answers_does_not() {
        let mut ports = BTreeMap::new();
        for number in 0..ROBOTS_MAX {
            assert!(make_room(&mut ports));
            ports.insert(format!("r{number}"), port(number != 7).await);
        }
        let stranger = ports["r7"].answers.clone();
        assert!(make_room(&mut ports));
        assert_eq!((ports.len(), ports.contains_key("r7")), (ROBOTS_MAX - 1, false));
        tokio::task::yield_now().await;
        assert!(stranger.is_finished());
        ports.insert("new".to_owned(), port(true).await);
        assert!(!make_room(&mut ports));
        assert_eq!(ports.len(), ROBOTS_MAX);
        // A port without a response from the station is freed for the next robot.
        ports["new"].is_answered.store(false, Ordering::Release);
        assert!(make_room(&mut ports));
    }
}
