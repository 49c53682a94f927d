//! A robot and a station whose datagrams are messages of a WebSocket, because UDP is closed between them.

use crate::harness::{Place, Run, ticks};
use crate::station::{
    Program, history, in_background, machines, pair, robot_with, station, station_with_certificate,
    wait_at_station,
};
use expect_test::expect;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::process::Stdio;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Condvar, Mutex};
use tungstenite::Message;

/// What a path does with the bytes of its connections.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Passes {
    All,
    /// Those of connections that were opened before this one are kept, and the connections stay open.
    From(usize),
    /// Every connection is closed, and so is each new one.
    Nothing,
}

/// A path of TCP that can be cut silently and loudly. It says where it begins, and the number of each connection that is opened.
struct Path {
    address: SocketAddr,
    passes: Arc<(Mutex<Passes>, Condvar)>,
    opened: Receiver<usize>,
}

impl Path {
    #[expect(clippy::disallowed_methods, reason = "few connections are opened")]
    fn to(station: SocketAddr) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let passes = Arc::new((Mutex::new(Passes::All), Condvar::new()));
        let (says, opened) = channel();
        let inner = Arc::clone(&passes);
        in_background(move || {
            for (number, near) in listener.incoming().enumerate() {
                let (near, far) = (near.unwrap(), TcpStream::connect(station));
                says.send(number).unwrap_or_default();
                let Ok(far) = far else { continue };
                for (from, to) in [(&near, &far), (&far, &near)] {
                    let (from, to) = (from.try_clone().unwrap(), to.try_clone().unwrap());
                    let passes = Arc::clone(&inner);
                    in_background(move || carry(number, &from, &to, &passes.0, &passes.1));
                }
            }
        });
        Self { address, passes, opened }
    }

    fn set(&self, passes: Passes) {
        *self.passes.0.lock().unwrap() = passes;
        self.passes.1.notify_all();
    }

    /// The number of the next connection that is opened.
    fn next_opened(&self) -> usize {
        self.opened.recv().unwrap()
    }
}

fn carry(
    number: usize,
    mut from: &TcpStream,
    mut to: &TcpStream,
    passes: &Mutex<Passes>,
    changed: &Condvar,
) {
    let mut buffer = [0; 2_000];
    while let Ok(length @ 1..) = from.read(&mut buffer) {
        let mut now = passes.lock().unwrap();
        while matches!(*now, Passes::From(first) if number < first) {
            now = changed.wait(now).unwrap();
        }
        if *now == Passes::Nothing || to.write_all(&buffer[..length]).is_err() {
            break;
        }
    }
    for end in [from, to] {
        end.shutdown(Shutdown::Both).unwrap_or_default();
    }
}

#[test]
fn a_station_has_the_run_although_the_connection_is_cut_silently_and_loudly() {
    let place = Place::with(&ticks(3_000));
    pair(&place, "scout");
    let (_ground, address) = station(&place, "127.0.0.1:0");
    let path = Path::to(address);
    let _robot = robot_with(&place, &format!("--station ws://{}", path.address));
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Ticks  running");
    // The first connections are open and silent for ever: another one replaces them.
    path.set(Passes::From(path.next_opened() + 2));
    while path.next_opened() < 2 {}
    path.set(Passes::Nothing);
    let last = path.next_opened();
    // For a while nothing comes over any; then all that was kept comes late.
    path.set(Passes::From(usize::MAX));
    while path.next_opened() < last + 3 {}
    path.set(Passes::All);
    assert_eq!(run.end().0, Some(0));
    wait_at_station(&place, "Ticks  ended with success");
    assert_eq!(history(&place, "ground-runs"), history(&place, "robot-runs"));
    assert_eq!(machines(&place, "ground-runs"), machines(&place, "robot-runs"));
}

#[test]
fn a_station_is_known_by_its_certificate() {
    let place = Place::with(&ticks(500));
    pair(&place, "scout");
    let (_ground, address, certificate) = station_with_certificate(&place, "ground", "127.0.0.1:0");
    let serve = "serve --state robot --runs robot-runs --bind 127.0.0.1:0 --station";
    let unknown = place.call(&format!("{serve} wss://{address}"));
    let no_address = place.call(&format!("{serve} http://{address}"));
    let no_print = place.call(&format!("{serve} wss://{address} --station-fingerprint 12"));
    expect![[r"
        error: the certificate of the station at GROUND is not known: name it with --station-fingerprint, as `rafcon station` prints it
        error: `http://GROUND` is no address of a station: it looks like `udp://ground.example:4748`, or `wss://ground.example:4748` where UDP is closed
        error: --station-fingerprint 12: write 64 hexadecimal digits
    "]]
    .assert_eq(
        &[unknown, no_address, no_print]
            .map(|answer| answer.stderr.replace(&address.to_string(), "GROUND"))
            .concat(),
    );
    // Another certificate than it has: nothing is sent to whoever that is.
    let other = "0".repeat(64);
    let wrong = format!("{serve} wss://{address} --station-fingerprint {other}");
    let mut wrong = place.command(&wrong);
    wrong.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut wrong = wrong.spawn().unwrap();
    let said = BufReader::new(wrong.stderr.take().unwrap()).lines().map(Result::unwrap);
    let wrong = Program::new(wrong);
    let mut said = said.skip_while(|line| !line.contains("is not reached"));
    let first = said.next().unwrap().replace(&address.to_string(), "GROUND");
    expect!["the station at wss://GROUND/ is not reached: its certificate is another one, so nothing was sent: another computer may be listening in"]
        .assert_eq(&first);
    let advice = format!("name it once with --station-fingerprint {certificate}");
    assert!(said.nth(2).unwrap().ends_with(&advice));
    let run = Run::start(&place, "--runs robot-runs");
    assert_eq!(run.end().0, Some(0));
    drop(wrong);
    assert_eq!(place.call("runs --runs ground-runs").stdout, "no runs in PLACE/ground-runs\n");
    drop(robot_with(
        &place,
        &format!("--station wss://{address} --station-fingerprint {certificate}"),
    ));
    // It is remembered.
    let _robot = robot_with(&place, &format!("--station wss://{address}"));
    wait_at_station(&place, "Ticks  ended with success");
    assert_eq!(history(&place, "ground-runs"), history(&place, "robot-runs"));
}

/// What strangers do at the door of a station: each connection stays open until the returned guard is dropped.
fn make_noise(station: SocketAddr) -> Vec<TcpStream> {
    let mut open = Vec::new();
    for count in 0..120_u32 {
        let Ok(mut stream) = TcpStream::connect(station) else { continue };
        match count % 4 {
            0 => {}
            1 => stream.write_all(&[22; 3_000]).unwrap_or_default(),
            2 => stream.write_all(b"GET / HTTP/1.1\r\nHost: x\r\n\r\n").unwrap_or_default(),
            _ => {
                let asked = tungstenite::client("ws://station/", stream.try_clone().unwrap());
                let Ok((mut socket, _)) = asked else { continue };
                for size in [0, 1, 28, 300, 4_000, 100_000] {
                    let noise = vec![1; size];
                    let sent = socket.send(Message::text("what")).and(socket.send(noise.into()));
                    drop(sent);
                }
            }
        }
        open.push(stream);
    }
    open
}

#[test]
fn noise_at_the_door_of_a_station_harms_nothing() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let (_ground, address) = station(&place, "127.0.0.1:0");
    let _robot = robot_with(&place, &format!("--station ws://{address}"));
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Ticks  running");
    let _open = make_noise(address);
    let told = place.call("tell last stop --runs ground-runs");
    assert_eq!(told.stdout, "applied\n", "{}", told.stderr);
    drop(run.end());
    wait_at_station(&place, "Ticks  ended with");
    assert_eq!(history(&place, "ground-runs"), history(&place, "robot-runs"));
}
