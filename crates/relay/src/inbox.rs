//! What a relay waits for, from several threads: datagrams, and whatever else its side sends it.

use crate::carrier::{Carrier, Deliver};
use crate::error::RelayError;
use parking_lot::Mutex;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// So much waits at most.
const WAITING: usize = 4_096;
/// So many datagrams among that; those beyond are lost, as on any bad link. So commands always find a place.
const DATAGRAMS_MAX: usize = 1_024;
/// No datagram is longer.
const DATAGRAM_MAX: usize = 65_535;
/// A thread that receives looks this often whether it is to end.
pub(crate) const LOOK: Duration = Duration::from_millis(200);

/// Ends a relay.
#[derive(Debug, Clone, Default)]
pub struct Stopper(Arc<Stopping>);

#[derive(Debug, Default)]
struct Stopping {
    is_stopped: AtomicBool,
    /// Threads that hold sockets.
    threads: Mutex<Vec<JoinHandle<()>>>,
}

impl Stopper {
    /// Ends it; it takes a moment.
    pub fn stop(&self) {
        self.0.is_stopped.store(true, Ordering::Release);
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.0.is_stopped.load(Ordering::Acquire)
    }

    /// Starts a thread that holds a socket and ends after a stop.
    pub(crate) fn spawn(&self, name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
        let thread = thread::Builder::new().name(name.to_owned()).spawn(work)?;
        self.0.threads.lock().push(thread);
        Ok(())
    }

    /// Waits after a stop until the threads have closed their sockets, so that the next start can bind the address.
    pub(crate) fn join(&self) {
        let threads = std::mem::take(&mut *self.0.threads.lock());
        // A thread that panicked has closed its socket, too.
        for thread in threads {
            drop(thread.join());
        }
    }
}

/// What arrives.
#[derive(Debug)]
pub(crate) enum Input<T> {
    /// A datagram, and what carries an answer.
    Datagram(Carrier, Vec<u8>),
    Other(T),
}

/// Where a relay waits.
#[derive(Debug)]
pub(crate) struct Inbox<T> {
    sender: SyncSender<Input<T>>,
    receiver: Receiver<Input<T>>,
    /// How many datagrams wait.
    datagrams: Arc<AtomicUsize>,
}

impl<T: Send + 'static> Inbox<T> {
    pub(crate) fn new() -> Self {
        let (sender, receiver) = mpsc::sync_channel(WAITING);
        Self { sender, receiver, datagrams: Arc::default() }
    }

    /// For the threads that send to it.
    pub(crate) fn sender(&self) -> SyncSender<Input<T>> {
        self.sender.clone()
    }

    /// The next input; nothing if none comes in this time.
    pub(crate) fn wait(&self, time: Duration) -> Option<Input<T>> {
        let input = self.receiver.recv_timeout(time.min(LOOK)).ok()?;
        if let Input::Datagram(..) = input {
            self.datagrams.fetch_sub(1, Ordering::AcqRel);
        }
        Some(input)
    }

    /// Where datagrams are put that arrive. Those beyond what may wait are lost, as on any bad link.
    pub(crate) fn deliver(&self) -> Deliver {
        let (sender, waiting) = (self.sender(), Arc::clone(&self.datagrams));
        Arc::new(move |carrier, datagram| {
            if waiting.load(Ordering::Acquire) < DATAGRAMS_MAX {
                waiting.fetch_add(1, Ordering::AcqRel);
                sender.send(Input::Datagram(carrier, datagram)).unwrap_or_default();
            }
        })
    }

    /// Binds a socket whose datagrams arrive here until the relay is stopped.
    pub(crate) fn listen(
        &self,
        address: SocketAddr,
        stopper: &Stopper,
    ) -> Result<Arc<UdpSocket>, RelayError> {
        let bind = || {
            let socket = Arc::new(UdpSocket::bind(address)?);
            self.receive(&socket, stopper)?;
            Ok(socket)
        };
        bind().map_err(|source| RelayError::Bind { address, source })
    }

    /// Receives at this socket until the relay is stopped.
    pub(crate) fn receive(&self, socket: &Arc<UdpSocket>, stopper: &Stopper) -> io::Result<()> {
        socket.set_read_timeout(Some(LOOK))?;
        let (socket, stopper, deliver) = (Arc::clone(socket), stopper.clone(), self.deliver());
        let starter = stopper.clone();
        starter.spawn("datagrams", move || receive(&socket, &deliver, &stopper))
    }
}

fn receive(socket: &Arc<UdpSocket>, deliver: &Deliver, stopper: &Stopper) {
    let mut buffer = vec![0; DATAGRAM_MAX];
    while !stopper.is_stopped() {
        if let Ok((length, from)) = socket.recv_from(&mut buffer) {
            deliver(Carrier::Udp(Arc::clone(socket), from), buffer[..length].to_vec());
        }
    }
}
