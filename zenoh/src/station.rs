//! The side of a station: each robot of the fleet has a port of its own from which its datagrams come to the station, so that the
//! station's answers find their robot.

use crate::carry::{DATAGRAM_MAX, LastHeard, keep_session, put};
use crate::command_line::{Network, StationSide, print};
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

/// So many robots have ports. Of more, those go first to whom the station never answered: it did not know them.
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
            if ports.len() >= ROBOTS_MAX {
                let stranger = |port: &Port| !port.is_answered.load(Ordering::Acquire);
                let strangers = ports.iter().find(|(_, port)| stranger(port));
                let Some(stranger) = strangers.map(|(name, _)| name.clone()) else { return };
                ports.remove(&stranger);
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

/// Carries what the station sends to a robot.
async fn carry_answers(
    session: Session,
    up: String,
    socket: Arc<UdpSocket>,
    is_answered: Arc<AtomicBool>,
) {
    let mut buffer = [0; DATAGRAM_MAX];
    loop {
        // A station that is not there yet is said by the next call.
        if let Ok(length) = socket.recv(&mut buffer).await {
            is_answered.store(true, Ordering::Release);
            put(&session, &up, &buffer[..length], Priority::InteractiveHigh).await;
        }
    }
}
