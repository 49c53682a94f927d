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
mod parcels;
mod pending_requests;
mod received;
mod replica_run;
mod robot;
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
use rafcon_link::{Profile, StreamId};
use robot::StationRobot;
use std::collections::BTreeSet;
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

/// Pairings of a station. It reads them every second, so that it receives a robot that was paired after its start.
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

/// Names of the robots whose pairings were read.
#[derive(Debug, Default)]
struct PairedRobots {
    names: BTreeSet<String>,
    /// The last error of the list.
    problem: Option<String>,
}

impl PairedRobots {
    /// The robots that are paired when the station starts. One that cannot be received ends the station.
    fn begin_all(
        &mut self,
        settings: &StationSettings,
        inbox: &Inbox<ToStation>,
        clock: SessionClock,
    ) -> Result<Vec<StationRobot>, RelayError> {
        let new = self.read(settings);
        let robots = new.iter().enumerate().map(|(number, paired)| {
            StationRobot::begin(settings, number, paired, inbox.sender(), clock)
        });
        robots.collect()
    }

    /// Adds robots paired after the start. Reports a robot that cannot be received, once.
    fn begin_new(
        &mut self,
        settings: &StationSettings,
        inbox: &Inbox<ToStation>,
        clock: SessionClock,
        robots: &mut Vec<StationRobot>,
    ) {
        for paired in self.read(settings) {
            let (name, number) = (&paired.pairing.robot, robots.len());
            match StationRobot::begin(settings, number, &paired, inbox.sender(), clock) {
                Ok(robot) => {
                    (settings.tell)(&format!("robot {name} is paired now and is received"));
                    robots.push(robot);
                }
                Err(error) => (settings.tell)(&format!("robot {name} is not received: {error}")),
            }
        }
    }

    /// Pairings of robots that were not read before.
    fn read(&mut self, settings: &StationSettings) -> Vec<Paired> {
        let read = settings.pairings.read();
        let problem = read.as_ref().err().cloned();
        if let Some(problem) = problem.as_ref().filter(|_| self.problem != problem) {
            (settings.tell)(problem);
        }
        self.problem = problem;
        let paired = read.unwrap_or_default().into_iter();
        paired.filter(|paired| self.names.insert(paired.pairing.robot.clone())).collect()
    }
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
    let mut paired = PairedRobots::default();
    let mut robots = paired.begin_all(settings, &inbox, clock)?;
    let reporter = Reporter::open(&settings.folder)?;
    let (mut next_scan_at, mut next_save_at, mut next_report_at) =
        (SCAN_EVERY, SAVE_EVERY, REPORT_EVERY);
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
            paired.begin_new(settings, &inbox, clock, &mut robots);
            robots.iter().for_each(StationRobot::refresh_contacts);
            reporter.set(robots.iter_mut().map(StationRobot::report).collect());
        }
        let mut next = next_scan_at.min(next_save_at).min(next_report_at);
        for robot in &mut robots {
            next = next.min(robot.send()?);
        }
        match inbox.wait(next.saturating_sub(clock.now())) {
            Some(Input::Datagram(from, datagram)) => {
                // Which robot it is of is known by the key that opens it.
                let is_opened = robots.iter_mut().any(|robot| robot.receive(&from, &datagram));
                if !is_opened {
                    robots.iter_mut().for_each(StationRobot::note_unusable);
                }
            }
            Some(Input::Other(ToStation::Given(GivenCommand { robot, stream, word }))) => {
                if let Some(robot) = robots.get_mut(robot) {
                    robot.command(stream, &word);
                }
            }
            Some(Input::Other(ToStation::Disk(robot, event))) => {
                if let Some(robot) = robots.get_mut(robot) {
                    robot.on_disk_event(event);
                }
            }
            Some(Input::Other(ToStation::Commands(robot, event))) => {
                if let Some(robot) = robots.get_mut(robot) {
                    robot.on_command_disk_event(event);
                }
            }
            Some(Input::Other(ToStation::Values(robot, event))) => {
                if let Some(robot) = robots.get_mut(robot) {
                    robot.on_value_disk_event(event);
                }
            }
            None => {}
        }
    }
    robots.iter_mut().for_each(StationRobot::end);
    // They hold the socket, too.
    drop((robots, inbox));
    stopper.join();
    Ok(())
}
