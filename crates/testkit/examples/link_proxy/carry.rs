//! Carries what comes from either end to the other, in real time, and heeds what is said meanwhile.

use crate::ends::{Arrival, Devices, Ends, Sockets};
use crate::options::Options;
use crate::page;
use crate::path::BadPath;
use crate::recording::{Recorded, Recording, read};
use crate::tcp::{Connections, HEADERS};
use crate::tun::Network;
use std::io::{self, BufRead as _};
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// So much waits at most.
const WAITING: usize = 4_096;

/// Carries until it is told to end.
#[expect(clippy::print_stdout, reason = "this is a command-line program")]
pub(crate) fn carry(options: &Options) -> io::Result<()> {
    let (sender, arrivals) = sync_channel(WAITING);
    if let Some(address) = options.page {
        let at = page::serve(address, options.station_page.as_deref(), &sender)?;
        println!("the link is changed at http://{at}/");
    }
    listen_to_lines(sender.clone())?;
    if options.tcp {
        let connections = Connections::open(options.listen, options.to, &sender)?;
        println!("robots connect to tcp://{}", connections.address());
        return Proxy::new(options, &connections)?.run(&arrivals);
    }
    let Some(name) = &options.tun else {
        let sockets = Sockets::open(options.listen, options.to, &sender)?;
        println!("robots send to udp://{}", sockets.address()?);
        return Proxy::new(options, &sockets)?.run(&arrivals);
    };
    // Packets are carried as they are: nothing is added to their length.
    let network = Network::make(name)?;
    network.devices.receive(&sender)?;
    println!("{}", network.greeting());
    let proxy: Proxy<'_, Devices> = Proxy::new(options, &network.devices)?;
    proxy.run(&arrivals)
}

fn listen_to_lines(sender: SyncSender<Arrival>) -> io::Result<()> {
    let lines = move || {
        for line in io::stdin().lock().lines().map_while(Result::ok) {
            sender.send(Arrival::Line(line, None)).unwrap_or_default();
        }
    };
    thread::Builder::new().spawn(lines).map(drop)
}

struct Proxy<'e, E> {
    ends: &'e E,
    path: BadPath,
    begin: Instant,
    recording: Option<Recording>,
}

impl<'e, E: Ends> Proxy<'e, E> {
    #[expect(clippy::disallowed_methods, reason = "it imitates a link in real time")]
    fn new(options: &Options, ends: &'e E) -> io::Result<Self> {
        let (mut down, mut up) = (options.down.clone(), options.up.clone());
        if options.tun.is_some() {
            (down.overhead, up.overhead) = (0, 0);
        }
        if options.tcp {
            (down.overhead, up.overhead) = (HEADERS, HEADERS);
        }
        (down.in_order, up.in_order) = (options.tcp, options.tcp);
        let mut path = BadPath::new(down, up);
        for change in &options.changes {
            path.obey(Duration::ZERO, change).map_err(io::Error::other)?;
        }
        let recording = options.record.as_deref().map(Recording::create).transpose()?;
        Ok(Self { ends, path, begin: Instant::now(), recording })
    }

    fn run(mut self, arrivals: &Receiver<Arrival>) -> io::Result<()> {
        loop {
            let now = self.begin.elapsed();
            while let Some(datagram) = self.path.down.arrive(now) {
                self.ends.to_station(&datagram);
            }
            while let Some(datagram) = self.path.up.arrive(now) {
                self.ends.to_robot(&datagram);
            }
            let wait =
                self.path.next().map_or(Duration::from_secs(1), |next| next.saturating_sub(now));
            match arrivals.recv_timeout(wait) {
                Ok(Arrival::FromRobot(datagram)) => {
                    self.record(Recorded::FromRobot, &datagram)?;
                    self.path.down.send(self.begin.elapsed(), datagram);
                }
                Ok(Arrival::FromStation(datagram)) => {
                    self.record(Recorded::FromStation, &datagram)?;
                    self.path.up.send(self.begin.elapsed(), datagram);
                }
                Ok(Arrival::Line(line, _)) if line.trim() == "end" => return Ok(()),
                Ok(Arrival::Line(line, answer)) => self.heed(line.trim(), answer),
                Err(_nothing) => {}
            }
        }
    }

    fn record(&mut self, from: Recorded, datagram: &[u8]) -> io::Result<()> {
        let now = self.begin.elapsed();
        self.recording.as_mut().map_or(Ok(()), |recording| recording.add(now, from, datagram))
    }

    #[expect(clippy::print_stdout, reason = "this is a command-line program")]
    fn heed(&mut self, line: &str, answer: Option<SyncSender<String>>) {
        let now = self.begin.elapsed();
        let said = match line.split_once(' ') {
            _ if line == "say" => Ok(self.path.say(now)),
            Some(("replay", file)) => self.replay(Path::new(file)),
            Some(("noise", count)) => Ok(self.make_noise(count.parse().unwrap_or(1_000))),
            _ => self.path.obey(now, line).map(|()| self.path.say(now)),
        };
        let said = said.unwrap_or_else(|why| format!(r#"{{"error": {why:?}}}"#));
        match answer {
            Some(answer) => answer.send(said).unwrap_or_default(),
            None => println!("{said}"),
        }
    }

    /// Sends once more what was recorded, at full speed, to whom it was sent then.
    fn replay(&self, file: &Path) -> Result<String, String> {
        let recorded =
            read(file).map_err(|error| format!("cannot read {}: {error}", file.display()))?;
        for (from, datagram) in &recorded {
            match from {
                Recorded::FromRobot => self.ends.to_station(datagram),
                Recorded::FromStation => self.ends.to_robot(datagram),
            }
        }
        Ok(format!(r#"{{"replayed": {}}}"#, recorded.len()))
    }

    /// Sends so many datagrams of nonsense to both ends, at full speed. They begin as those of this protocol do.
    fn make_noise(&self, count: u32) -> String {
        for number in 0..count {
            let [a, b, c, d] = number.to_be_bytes();
            let noise = [[1, d, c, b, a].as_slice(), &[d; 90]].concat();
            self.ends.to_station(&noise);
            self.ends.to_robot(&noise);
        }
        format!(r#"{{"noise": {count}}}"#)
    }
}
