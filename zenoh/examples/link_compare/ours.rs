//! The sessions of RAFCON's link, each on a thread with a socket, as its servers have them.

use crate::figures::{Figures, Recorder};
use crate::proxy::Carries;
use crate::{LAST, Trial};
use anyhow::Result;
use rafcon_link::{
    EventBlock, EventBlockRef, FromRobot, Identity, KeyId, PairingKey, Profile, RobotSession,
    RunSource, SenderStart, SessionTime, StationSession, StreamId,
};
use std::net::{SocketAddr, UdpSocket};
use std::ops::RangeInclusive;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

const STREAM: StreamId = StreamId(1);

fn identity(key: &PairingKey) -> Identity<'_> {
    Identity { key_id: KeyId(1), key, robot: "scout", start: SenderStart::new(1, 0), heard: None }
}

/// Carries the events with the profile of the link.
pub(crate) async fn carry(trial: &Trial) -> Result<Figures> {
    let [robot, station] = [UdpSocket::bind("127.0.0.1:0")?, UdpSocket::bind("127.0.0.1:0")?];
    let proxy = trial.link(Carries::Datagrams, station.local_addr()?)?;
    let recorder = Arc::new(Recorder::new(trial.begin, &trial.events));
    let (notes, sends, to) = (Arc::clone(&recorder), trial.clone(), proxy.address);
    thread::Builder::new().spawn(move || station_side(&station, &notes))?;
    thread::Builder::new().spawn(move || robot_side(&robot, to, sends))?;
    trial.judge(proxy, &recorder).await
}

/// Waits for a datagram until this time. The timeout is at least 1 ms, because a socket rejects 0.
fn receive(
    socket: &UdpSocket,
    clock: Instant,
    until: Option<SessionTime>,
) -> Option<(Vec<u8>, SocketAddr)> {
    let mut buffer = [0; 2_048];
    let wait = until.map(|at| at.since(session_time(clock)).max(Duration::from_millis(1)));
    socket.set_read_timeout(wait).ok()?;
    let (length, from) = socket.recv_from(&mut buffer).ok()?;
    Some((buffer[..length].to_vec(), from))
}

/// Time of the session that began with this clock.
fn session_time(clock: Instant) -> SessionTime {
    SessionTime::after(clock.elapsed())
}

struct Journal {
    trial: Trial,
    head: usize,
}

impl RunSource for Journal {
    fn events(
        &mut self,
        _stream: StreamId,
        first: u64,
        last: u64,
        bytes_max: usize,
    ) -> Option<EventBlock> {
        let events = &self.trial.events;
        let from = usize::try_from(first).ok()?.checked_sub(1)?;
        let last = usize::try_from(last).ok()?.min(self.head);
        let (mut items, mut count) = (Vec::new(), 0);
        for event in events.list.get(from..last)? {
            if count > 0 && items.len() + event.items.len() > bytes_max {
                break;
            }
            items.extend_from_slice(&event.items);
            count += 1;
        }
        (count > 0).then(|| EventBlock {
            first_sequence: first,
            count,
            time_before: events.before(from),
            bytes: items,
        })
    }

    fn snapshot(&mut self, _stream: StreamId) -> Option<(u64, Vec<u8>)> {
        Some((self.head as u64, self.trial.events.state.clone()))
    }
}

fn robot_side(socket: &UdpSocket, to: SocketAddr, trial: Trial) {
    let clock = Instant::now();
    let lead = trial.begin.saturating_duration_since(clock);
    let due_at = |time: Duration| SessionTime::after(lead + time);
    let mut session =
        RobotSession::new(&identity(&PairingKey::from_bytes([7; 32])), Profile::DELAY_2S);
    session.begin(STREAM, 0);
    let mut journal = Journal { trial, head: 0 };
    let events = Arc::clone(&journal.trial.events);
    loop {
        let now = session_time(clock);
        while let Some(event) = events.list.get(journal.head).filter(|it| due_at(it.time) <= now) {
            let time_before = events.before(journal.head);
            journal.head += 1;
            let first = journal.head as u64;
            session.append(
                STREAM,
                EventBlockRef { first_sequence: first, count: 1, time_before, bytes: &event.items },
            );
        }
        session.set_state(STREAM, b"running", now > due_at(LAST));
        while let Ok(Some(datagram)) = session.poll_transmit(now, &mut journal) {
            drop(socket.send_to(&datagram, to));
        }
        let next = events.list.get(journal.head).map(|event| due_at(event.time));
        let next = SessionTime::earliest([next, session.poll_timeout(now)]);
        if let Some((mut datagram, _)) = receive(socket, clock, next) {
            // What comes twice is not used.
            session.handle_datagram(session_time(clock), &mut datagram, |_| {}).unwrap_or_default();
        }
    }
}

fn station_side(socket: &UdpSocket, recorder: &Recorder) {
    let (clock, mut robot) = (Instant::now(), None);
    let mut session =
        StationSession::new(&identity(&PairingKey::from_bytes([7; 32])), Profile::DELAY_2S);
    loop {
        let now = session_time(clock);
        while let Ok(Some(datagram)) = session.poll_transmit(now) {
            if let Some(robot) = robot {
                drop(socket.send_to(&datagram, robot));
            }
        }
        if let Some((mut datagram, from)) = receive(socket, clock, session.poll_timeout(now)) {
            robot = Some(from);
            let now = session_time(clock);
            let used = session.handle_datagram(now, &mut datagram, |shown| {
                if let FromRobot::Events { block, .. } = shown {
                    note(recorder, block.sequences());
                }
            });
            used.unwrap_or_default();
            let safe = session.progress(STREAM).map_or(0, |progress| progress.contiguous);
            session.set_safe(STREAM, safe);
        }
    }
}

/// Events have numbers from 1 on; here they have places in a list.
fn note(recorder: &Recorder, sequences: RangeInclusive<u64>) {
    let places = sequences.filter_map(|sequence| usize::try_from(sequence.checked_sub(1)?).ok());
    places.for_each(|place| recorder.note(place));
}
