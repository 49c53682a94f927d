//! The two ends of the path: two sockets on loopback, or two network devices.

use std::fs::File;
use std::io::{self, Read as _, Write as _};
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::thread;

/// What the proxy waits for.
pub(crate) enum Arrival {
    FromRobot(Vec<u8>),
    FromStation(Vec<u8>),
    /// Words that change the path, and where the answer goes.
    Line(String, Option<SyncSender<String>>),
}

/// What is made of a datagram.
pub(crate) type Arrives = fn(Vec<u8>) -> Arrival;

/// Where datagrams go.
pub(crate) trait Ends {
    fn to_robot(&self, datagram: &[u8]);
    fn to_station(&self, datagram: &[u8]);
}

/// Sockets on loopback. The robot is whoever sent last to the near one.
pub(crate) struct Sockets {
    near: UdpSocket,
    far: UdpSocket,
    robot: Arc<std::sync::Mutex<Option<SocketAddr>>>,
    station: SocketAddr,
}

impl Sockets {
    pub(crate) fn open(
        listen: SocketAddr,
        station: SocketAddr,
        arrivals: &SyncSender<Arrival>,
    ) -> io::Result<Self> {
        let near = UdpSocket::bind(listen)?;
        let any = if station.is_ipv4() { "127.0.0.1:0" } else { "[::1]:0" };
        let far = UdpSocket::bind(any)?;
        let robot = Arc::new(std::sync::Mutex::new(None));
        let known = Arc::clone(&robot);
        receive(near.try_clone()?, arrivals, move |from, datagram| {
            if let Ok(mut robot) = known.lock() {
                *robot = Some(from);
            }
            Arrival::FromRobot(datagram)
        })?;
        receive(far.try_clone()?, arrivals, |_, datagram| Arrival::FromStation(datagram))?;
        Ok(Self { near, far, robot, station })
    }

    /// Where robots send.
    pub(crate) fn address(&self) -> io::Result<SocketAddr> {
        self.near.local_addr()
    }
}

impl Ends for Sockets {
    fn to_robot(&self, datagram: &[u8]) {
        if let Some(robot) = self.robot.lock().ok().and_then(|robot| *robot) {
            self.near.send_to(datagram, robot).unwrap_or_default();
        }
    }

    fn to_station(&self, datagram: &[u8]) {
        self.far.send_to(datagram, self.station).unwrap_or_default();
    }
}

fn receive(
    socket: UdpSocket,
    arrivals: &SyncSender<Arrival>,
    arrival: impl Fn(SocketAddr, Vec<u8>) -> Arrival + Send + 'static,
) -> io::Result<()> {
    let arrivals = arrivals.clone();
    let receive = move || {
        let mut buffer = vec![0; 65_535];
        // An address that no one listens at is said by the next call.
        loop {
            if let Ok((length, from)) = socket.recv_from(&mut buffer)
                && arrivals.send(arrival(from, buffer[..length].to_vec())).is_err()
            {
                return;
            }
        }
    };
    thread::Builder::new().spawn(receive).map(drop)
}

/// Devices of two hosts: each read is a packet.
pub(crate) struct Devices {
    pub(crate) robot: Arc<File>,
    pub(crate) station: Arc<File>,
}

impl Devices {
    /// Passes on what the hosts send.
    pub(crate) fn receive(&self, arrivals: &SyncSender<Arrival>) -> io::Result<()> {
        pass_on(&self.robot, arrivals, Arrival::FromRobot)?;
        pass_on(&self.station, arrivals, Arrival::FromStation)
    }
}

/// Passes on each packet of a device.
fn pass_on(device: &Arc<File>, arrivals: &SyncSender<Arrival>, arrival: Arrives) -> io::Result<()> {
    let (device, arrivals) = (Arc::clone(device), arrivals.clone());
    let receive = move || {
        let mut buffer = vec![0; 65_535];
        while let Ok(length) = (&*device).read(&mut buffer)
            && arrivals.send(arrival(buffer[..length].to_vec())).is_ok()
        {}
    };
    thread::Builder::new().spawn(receive).map(drop)
}

impl Ends for Devices {
    fn to_robot(&self, packet: &[u8]) {
        // A host that has gone takes nothing.
        drop((&*self.robot).write(packet));
    }

    fn to_station(&self, packet: &[u8]) {
        drop((&*self.station).write(packet));
    }
}
