//! Keeps a WebSocket to a station. A connection over which nothing is heard is kept while another is dialled: the first over which the
//! station is heard replaces all others, so a silent connection costs nothing if it lives again, and little if it does not.

use super::connection::{ByteStream, Connection, Socket, carry, websocket_config};
use super::{Carrier, Deliver};
use crate::clock::SessionClock;
use crate::inbox::{LOOK, Stopper};
use parking_lot::Mutex;
use rafcon_link::SessionTime;
use std::fmt;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread;
use std::time::Duration;
use tungstenite::client::{ClientRequestBuilder, client_with_config};

/// Another dial begins at the earliest so long after the one before, and as long as a dial took last, but within these bounds: whoever
/// waits longer and longer is silent long after a blackout.
const DIAL_EVERY: (Duration, Duration) = (Duration::from_secs(1), Duration::from_secs(4));
/// Limit of concurrent dials.
const DIALS_MAX: usize = 8;
/// Limit of silent connections.
const SILENT_MAX: usize = 3;

/// Opens streams to a station.
pub trait Dial: fmt::Debug + Send + Sync {
    /// The station's address, such as `wss://ground.example:4748`.
    fn uri(&self) -> String;

    /// Opens a stream within the timeout. The error contains the remedy.
    fn dial(&self) -> Result<Box<dyn ByteStream>, String>;
}

/// Keeps connections to a station.
pub(crate) struct Dialler {
    dial: Arc<dyn Dial>,
    clock: SessionClock,
    /// Time without an answer after which a connection is silent.
    silence: Duration,
    /// Open connections, the oldest first.
    connections: Mutex<Vec<Arc<Connection>>>,
    dials: AtomicUsize,
    dial_every: Mutex<Duration>,
    deliver: Deliver,
    stopper: Stopper,
    tell: fn(&str),
    told: Mutex<String>,
    /// Something has changed.
    changed: SyncSender<()>,
}

impl Dialler {
    /// Opens and replaces connections until it is stopped. What arrives is delivered.
    pub(crate) fn begin(
        dial: Arc<dyn Dial>,
        silence: Duration,
        deliver: Deliver,
        tell: fn(&str),
        stopper: &Stopper,
    ) -> io::Result<Arc<Self>> {
        let (changed, changes) = mpsc::sync_channel(1);
        let dialler = Arc::new(Self {
            dial,
            clock: SessionClock::begin(),
            silence,
            connections: Mutex::default(),
            dials: AtomicUsize::new(0),
            dial_every: Mutex::new(DIAL_EVERY.0),
            deliver,
            stopper: stopper.clone(),
            tell,
            told: Mutex::default(),
            changed,
        });
        let keeping = Arc::clone(&dialler);
        let keep = move || keeping.keep(&changes);
        thread::Builder::new().name("dialler".to_owned()).spawn(keep)?;
        Ok(dialler)
    }

    /// Over each connection: the other side takes a datagram once, whatever way it comes.
    pub(super) fn send(&self, datagram: &[u8]) {
        for connection in self.connections.lock().iter() {
            connection.send(datagram);
        }
    }

    fn keep(self: Arc<Self>, changes: &Receiver<()>) {
        let mut dial_at = SessionTime::BEGIN;
        while !self.stopper.is_stopped() {
            let now = self.clock.now();
            let is_silent = self.choose(now);
            if is_silent && now >= dial_at && self.may_dial() {
                dial_at = now + *self.dial_every.lock();
                let dialler = Arc::clone(&self);
                let dialled = thread::Builder::new().name("websocket".to_owned());
                if let Err(error) = dialled.spawn(move || dialler.carry_one()) {
                    self.dials.fetch_sub(1, Ordering::AcqRel);
                    self.say(&error.to_string());
                }
            }
            // The timeout and a wake-up both lead to a check.
            changes.recv_timeout(LOOK).unwrap_or_default();
        }
        self.connections.lock().iter().for_each(|connection| connection.close());
    }

    /// Counts a dial, unless too many are on their way.
    fn may_dial(&self) -> bool {
        let more = |dials| (dials < DIALS_MAX).then_some(dials + 1);
        self.dials.fetch_update(Ordering::AcqRel, Ordering::Acquire, more).is_ok()
    }

    /// Keeps the newest live connection, or else the silent ones. Returns true if none is live.
    fn choose(&self, now: SessionTime) -> bool {
        let mut connections = self.connections.lock();
        connections.retain(|connection| !connection.is_closed());
        let is_lately = |at: SessionTime| now.since(at) < self.silence;
        let living = connections.iter().rposition(|it| it.heard().is_some_and(is_lately));
        if let Some(living) = living {
            let living = connections.swap_remove(living);
            connections.drain(..).for_each(|other| other.close());
            connections.push(living);
        }
        while connections.len() > SILENT_MAX {
            connections.remove(0).close();
        }
        connections.iter().all(|it| it.unanswered_since().is_some_and(|since| !is_lately(since)))
    }

    /// Opens a connection, and carries its messages until it ends.
    fn carry_one(&self) {
        let begun = self.clock.now();
        let opened = self.open();
        self.dials.fetch_sub(1, Ordering::AcqRel);
        match opened {
            Ok((socket, connection)) => {
                let took = self.clock.now().since(begun);
                *self.dial_every.lock() = took.clamp(DIAL_EVERY.0, DIAL_EVERY.1);
                self.told.lock().clear();
                self.connections.lock().push(Arc::clone(&connection));
                if self.stopper.is_stopped() {
                    connection.close();
                }
                carry(socket, &connection, &self.deliver);
            }
            Err(why) => self.say(&why),
        }
        // A full channel means that a check is pending.
        self.changed.try_send(()).unwrap_or_default();
    }

    fn open(&self) -> Result<(Socket, Arc<Connection>), String> {
        let stream = self.dial.dial()?;
        let connection = Connection::new(stream.socket(), self.clock);
        let connection = connection.map_err(|error| error.to_string())?;
        let uri = self.dial.uri().parse().map_err(|error| format!("it is no address: {error}"))?;
        let request = ClientRequestBuilder::new(uri);
        let (socket, _response) = client_with_config(request, stream, Some(websocket_config()))
            .map_err(|error| format!("no WebSocket is to be had there: {error}"))?;
        Ok((socket, connection))
    }

    /// Says what is wrong, once.
    fn say(&self, why: &str) {
        let mut told = self.told.lock();
        if *told != why {
            why.clone_into(&mut told);
            (self.tell)(&format!("the station at {} is not reached: {why}", self.dial.uri()));
        }
    }
}

impl fmt::Debug for Dialler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Dialler").field(&self.dial).finish()
    }
}

impl From<Arc<Dialler>> for Carrier {
    fn from(dialler: Arc<Dialler>) -> Self {
        Self::Dialler(dialler)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::{TcpListener, TcpStream};

    #[derive(Debug)]
    struct Nowhere;

    impl Dial for Nowhere {
        fn uri(&self) -> String {
            "ws://127.0.0.1:1".to_owned()
        }

        fn dial(&self) -> Result<Box<dyn ByteStream>, String> {
            Err("there is none".to_owned())
        }
    }

    fn dialler() -> Dialler {
        let (changed, _changes) = mpsc::sync_channel(1);
        Dialler {
            dial: Arc::new(Nowhere),
            clock: SessionClock::begin(),
            silence: Duration::from_secs(1),
            connections: Mutex::default(),
            dials: AtomicUsize::new(0),
            dial_every: Mutex::new(DIAL_EVERY.0),
            deliver: Arc::new(|_, _| {}),
            stopper: Stopper::default(),
            tell: |_| {},
            told: Mutex::default(),
            changed,
        }
    }

    #[test]
    fn no_more_dials_are_on_their_way_than_the_bound_and_each_that_ends_makes_room() {
        let dialler = dialler();
        assert!((0..DIALS_MAX).all(|_| dialler.may_dial()));
        assert!(!dialler.may_dial());
        // This dial fails at once.
        dialler.carry_one();
        assert!(dialler.may_dial() && !dialler.may_dial());
    }

    #[test]
    fn of_the_connections_that_nobody_is_heard_over_the_newest_are_kept() {
        let dialler = dialler();
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let address = listener.local_addr().unwrap();
        let connect = || {
            let socket = TcpStream::connect(address).unwrap();
            Connection::new(&socket, dialler.clock).unwrap()
        };
        let all: Vec<_> = (0..=SILENT_MAX).map(|_| connect()).collect();
        let choose = |some: &[Arc<Connection>]| {
            *dialler.connections.lock() = some.to_vec();
            dialler.choose(SessionTime::BEGIN);
            all.iter().map(|it| it.is_closed()).collect::<Vec<_>>()
        };
        assert_eq!(choose(&all[1..]), [false; SILENT_MAX + 1]);
        assert_eq!(choose(&all), [true, false, false, false]);
        assert_eq!(dialler.connections.lock().len(), SILENT_MAX);
    }
}
