//! A bad path for datagrams between a robot and a station: `cargo xtask link-proxy --listen 127.0.0.1:4750 --to 127.0.0.1:4748`.
//!
//! The robot sends to `--listen`. Options set delay, rates, losses, doubles and late datagrams; a line on standard input cuts the
//! path (`cut`: what is sent is lost; `hold`: it comes later, as if nothing had been) and mends it (`mend`); `end` ends the proxy.

use rafcon_testkit::link_world::{Carrier, Conditions, Cut};
use std::io::{self, BufRead as _};
use std::net::{SocketAddr, UdpSocket};
use std::process::ExitCode;
use std::sync::mpsc::{self, Sender};
use std::thread;
use std::time::{Duration, Instant};

/// What the proxy waits for.
enum Arrival {
    FromRobot(SocketAddr, Vec<u8>),
    FromStation(Vec<u8>),
    Line(String),
}

struct Options {
    listen: SocketAddr,
    to: SocketAddr,
    down: Conditions,
    up: Conditions,
}

#[expect(clippy::print_stderr, reason = "this is a command-line program")]
fn main() -> ExitCode {
    let Some(options) = options() else {
        eprintln!(
            "usage: link_proxy [--listen ADDRESS:PORT] [--to ADDRESS:PORT] [--delay-ms N] [--down BITS] [--up BITS] [--lost PERCENT] [--doubled PERCENT] [--late PERCENT]"
        );
        return ExitCode::from(2);
    };
    match carry(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

#[expect(clippy::disallowed_methods, reason = "it imitates a link in real time")]
#[expect(clippy::print_stdout, reason = "this is a command-line program")]
fn carry(options: &Options) -> io::Result<()> {
    let near = UdpSocket::bind(options.listen)?;
    let any = if options.to.is_ipv4() { "127.0.0.1:0" } else { "[::1]:0" };
    let far = UdpSocket::bind(any)?;
    let (sender, arrivals) = mpsc::channel();
    receive(near.try_clone()?, &sender, Arrival::FromRobot)?;
    receive(far.try_clone()?, &sender, |_, datagram| Arrival::FromStation(datagram))?;
    let lines = move || {
        for line in io::stdin().lock().lines().map_while(Result::ok) {
            drop(sender.send(Arrival::Line(line)));
        }
    };
    thread::Builder::new().spawn(lines)?;
    println!("robots send to udp://{}", near.local_addr()?);
    let begin = Instant::now();
    let mut down = Carrier::new(options.down.clone(), 1);
    let mut up = Carrier::new(options.up.clone(), 2);
    let mut robot = None;
    loop {
        let now = begin.elapsed();
        while let Some(datagram) = down.arrive(now) {
            far.send_to(&datagram, options.to).unwrap_or_default();
        }
        while let Some((robot, datagram)) = robot.and_then(|it| Some((it, up.arrive(now)?))) {
            near.send_to(&datagram, robot).unwrap_or_default();
        }
        let next = [down.next(), up.next()].into_iter().flatten().min();
        let wait = next.map_or(Duration::from_secs(1), |next| next.saturating_sub(now));
        match arrivals.recv_timeout(wait) {
            Ok(Arrival::FromRobot(from, datagram)) => {
                robot = Some(from);
                down.send(begin.elapsed(), datagram);
            }
            Ok(Arrival::FromStation(datagram)) => up.send(begin.elapsed(), datagram),
            Ok(Arrival::Line(line)) if line.trim() == "end" => return Ok(()),
            Ok(Arrival::Line(line)) => {
                for carrier in [&mut down, &mut up] {
                    match line.trim() {
                        "cut" => carrier.begin_cut(begin.elapsed(), Cut::Drops),
                        "hold" => carrier.begin_cut(begin.elapsed(), Cut::Holds),
                        "mend" => carrier.end_cut(begin.elapsed()),
                        _ => println!("say `cut`, `hold`, `mend` or `end`"),
                    }
                }
            }
            Err(_nothing) => {}
        }
    }
}

fn receive(
    socket: UdpSocket,
    sender: &Sender<Arrival>,
    arrival: impl Fn(SocketAddr, Vec<u8>) -> Arrival + Send + 'static,
) -> io::Result<()> {
    let sender = sender.clone();
    let receive = move || {
        let mut buffer = vec![0; 65_535];
        // An address that no one listens at is said by the next call.
        loop {
            if let Ok((length, from)) = socket.recv_from(&mut buffer)
                && sender.send(arrival(from, buffer[..length].to_vec())).is_err()
            {
                return;
            }
        }
    };
    thread::Builder::new().spawn(receive).map(drop)
}

fn options() -> Option<Options> {
    let local = |port| SocketAddr::from(([127, 0, 0, 1], port));
    let (down, up) = (Conditions::delay_2s(256_000), Conditions::delay_2s(32_000));
    let mut found = Options { listen: local(4_750), to: local(4_748), down, up };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next()?;
        let number = || value.parse::<u64>().ok();
        let percent = || value.parse::<usize>().ok().filter(|percent| *percent <= 100);
        match word.as_str() {
            "--listen" => found.listen = value.parse().ok()?,
            "--to" => found.to = value.parse().ok()?,
            "--down" => found.down.bits_per_s = number()?.max(1),
            "--up" => found.up.bits_per_s = number()?.max(1),
            "--delay-ms" => {
                let delay = Duration::from_millis(number()?);
                (found.down.delay, found.up.delay) = (delay, delay);
            }
            "--lost" => (found.down.lost, found.up.lost) = (percent()?, percent()?),
            "--doubled" => (found.down.doubled, found.up.doubled) = (percent()?, percent()?),
            "--late" => (found.down.late, found.up.late) = (percent()?, percent()?),
            _ => return None,
        }
    }
    Some(found)
}
