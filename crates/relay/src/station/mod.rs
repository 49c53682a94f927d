//! The station's side: keeps a replica of each run of its robots, reports what it has, and sends commands.

mod asked;
mod checking;
mod command_disk;
mod completed_runs;
mod disk;
mod health;
mod in_order;
mod kept_runs;
mod lifetime;
mod paired_robots;
mod parcels;
mod pending_requests;
mod received;
mod replica_run;
mod robot;
mod robots;
mod stored_command;
mod value_disk;
mod values;
mod viewers;
mod watching;

#[cfg(test)]
pub(crate) use robot::default_lifetime;

use crate::carrier::{Secure, accept_connections};
use crate::clock::SessionClock;
use crate::command_lists::CommandListStore;
use crate::contacts::ContactStore;
use crate::error::RelayError;
use crate::inbox::{Inbox, Input, Stopper};
use crate::machine_lists::MachineLists;
use crate::pairing::Paired;
use crate::report::{REPORT_EVERY, Reporter};
use crate::requests::RequestBroker;
use crate::value_fetch_broker::ValueFetchBroker;
use command_disk::FromCommandDisk;
use disk::FromDisk;
use paired_robots::PairedRobots;
use rafcon_link::{Profile, SessionTime, StreamId};
use robot::StationRobot;
use robots::Robots;
use std::fmt;
use std::io;
use std::net::{SocketAddr, TcpListener, UdpSocket};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use value_disk::FromValueDisk;
use viewers::PendingRequest;

/// Interval of run scans: complete runs are closed, and viewers receive the state of the link.
const SCAN_EVERY: Duration = Duration::from_millis(250);
/// Interval at which the state of the link is stored.
const SAVE_EVERY: Duration = Duration::from_secs(10);

/// Number of ports to try if any port is accepted.
const TRIES: usize = 16;

/// Pairings of a station. A thread of its own reads them every second, so that it receives a robot that was paired after its start.
pub trait PairingList: fmt::Debug + Send + Sync {
    /// All pairings, or the pairing that cannot be read.
    fn read(&self) -> Result<Vec<Paired>, String>;
}

impl PairingList for Vec<Paired> {
    fn read(&self) -> Result<Vec<Paired>, String> {
        Ok(self.clone())
    }
}

/// Settings of a station's relay.
#[derive(Debug, Clone)]
pub struct StationSettings {
    /// The folder for its files, one for each robot.
    pub folder: PathBuf,
    /// The folder for the replicas.
    pub runs: PathBuf,
    /// Pairings with its robots.
    pub pairings: Arc<dyn PairingList>,
    /// Address for UDP and, at the same port of TCP, for a WebSocket.
    pub bind: SocketAddr,
    /// Speaks TLS with robots that ask for it.
    pub tls: Option<Arc<dyn Secure>>,
    /// Profile of the link.
    pub profile: Profile,
    /// Requests for large values.
    pub value_fetches: ValueFetchBroker,
    /// Requests of the server to start and resume runs.
    pub server_requests: RequestBroker,
    /// Planned contacts with the robots.
    pub contacts: ContactStore,
    /// Command lists for the robots.
    pub lists: CommandListStore,
    /// Lists of the robots' machines.
    pub machines: MachineLists,
    /// Told what goes wrong.
    pub tell: fn(&str),
}

/// A command that a viewer of a replica gave.
#[derive(Debug)]
pub(crate) struct GivenCommand {
    /// The number of the robot.
    robot: usize,
    /// The stream of the run's events.
    stream: StreamId,
    word: PendingRequest,
}

/// Message of the station's own threads.
#[derive(Debug)]
pub(crate) enum ToStation {
    /// Message of a viewer.
    Given(GivenCommand),
    /// Message of the disk, about the robot of this number.
    Disk(usize, FromDisk),
    /// Message of the disk, about requests to the robot of this number.
    Commands(usize, FromCommandDisk),
    /// Message of the disk, about large values of the robot of this number.
    Values(usize, FromValueDisk),
    /// A robot that was paired after the start. It has the next number.
    Paired(Box<StationRobot>),
}

/// Receives robots by UDP and, at the same port, TCP. Returns the address.
fn receive(
    settings: &StationSettings,
    inbox: &Inbox<ToStation>,
    stopper: &Stopper,
) -> Result<SocketAddr, RelayError> {
    let begin = || {
        let (socket, listener) = bind_both(settings.bind)?;
        let address = socket.local_addr()?;
        inbox.receive(&Arc::new(socket), stopper)?;
        accept_connections(listener, settings.tls.clone(), inbox.deliver(), stopper)?;
        Ok(address)
    };
    begin().map_err(|source| RelayError::Bind { address: settings.bind, source })
}

/// Binds a port of UDP and the same port of TCP.
fn bind_both(address: SocketAddr) -> io::Result<(UdpSocket, TcpListener)> {
    let mut tries = 0;
    loop {
        let socket = UdpSocket::bind(address)?;
        match TcpListener::bind(socket.local_addr()?) {
            // If any port will do, it has to be one that is free for both.
            Err(error) if address.port() == 0 && tries < TRIES => {
                drop(error);
                tries += 1;
            }
            bound => return Ok((socket, bound?)),
        }
    }
}

/// Keeps replicas of the runs of robots until it is stopped. `is_up` is given the address at which it receives.
pub fn relay_station(
    settings: &StationSettings,
    stopper: &Stopper,
    is_up: impl FnOnce(SocketAddr),
) -> Result<(), RelayError> {
    let inbox = Inbox::new();
    is_up(receive(settings, &inbox, stopper)?);
    let clock = SessionClock::begin();
    let mut paired = PairedRobots::new(settings.clone(), inbox.sender(), clock);
    let mut robots = Robots::new(paired.begin_all()?);
    paired.watch(stopper).map_err(|source| RelayError::Thread { source })?;
    let reporter = Reporter::open(&settings.folder)?;
    let [mut next_scan_at, mut next_save_at, mut next_report_at] =
        [SCAN_EVERY, SAVE_EVERY, REPORT_EVERY].map(SessionTime::after);
    while !stopper.is_stopped() {
        let now = clock.now();
        if now >= next_scan_at {
            next_scan_at = now + SCAN_EVERY;
            robots.iter_mut().for_each(StationRobot::scan);
        }
        if now >= next_save_at {
            next_save_at = now + SAVE_EVERY;
            robots.iter_mut().for_each(StationRobot::save);
        }
        if now >= next_report_at {
            next_report_at = now + REPORT_EVERY;
            reporter.set(robots.iter_mut().map(StationRobot::report).collect());
        }
        let mut next = next_scan_at.min(next_save_at).min(next_report_at);
        for robot in robots.iter_mut() {
            next = next.or_earlier([robot.send()?]);
        }
        match inbox.wait(next.since(clock.now())) {
            Some(Input::Datagram(from, datagram)) => robots.receive(&from, &datagram),
            Some(Input::Other(message)) => robots.handle(message),
            None => {}
        }
    }
    robots.iter_mut().for_each(StationRobot::end);
    // They hold the socket, too.
    drop((robots, inbox));
    stopper.join();
    Ok(())
}

#[cfg(test)]
mod tests;
