//! Inputs of a relay from several threads: datagrams, and messages of its own side.

use crate::carrier::{Carrier, Deliver};
use crate::error::RelayError;
use parking_lot::{Condvar, Mutex};
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Capacity of the queue.
const WAITING: usize = 4_096;
/// Capacity in datagrams. Further ones are dropped, so that commands always fit.
const DATAGRAMS_MAX: usize = 1_024;
/// No datagram is longer.
const DATAGRAM_MAX: usize = 65_535;
/// Interval at which a receiving thread checks for the stop.
pub(crate) const LOOK: Duration = Duration::from_millis(200);

/// Ends a relay.
#[derive(Debug, Clone, Default)]
pub struct Stopper(Arc<Stopping>);

#[derive(Debug, Default)]
struct Stopping {
    is_stopped: AtomicBool,
    /// Held while a thread decides to wait for the stop.
    waiting: Mutex<()>,
    stopped: Condvar,
    /// Threads that hold sockets.
    threads: Mutex<Vec<JoinHandle<()>>>,
}

impl Stopper {
    /// Ends it; it takes a moment.
    pub fn stop(&self) {
        self.0.is_stopped.store(true, Ordering::Release);
        let _waiting = self.0.waiting.lock();
        self.0.stopped.notify_all();
    }

    /// Waits for this time, or until the stop. Returns true once it is stopped.
    pub(crate) fn wait(&self, time: Duration) -> bool {
        let mut waiting = self.0.waiting.lock();
        if !self.is_stopped() {
            self.0.stopped.wait_for(&mut waiting, time);
        }
        self.is_stopped()
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

/// Input of a relay.
#[derive(Debug)]
pub(crate) enum Input<T> {
    /// A datagram, and what carries an answer.
    Datagram(Carrier, Vec<u8>),
    Other(T),
}

/// Receiving end of the queue.
#[derive(Debug)]
pub(crate) struct Inbox<T> {
    sender: SyncSender<Input<T>>,
    receiver: Receiver<Input<T>>,
    /// Number of queued datagrams.
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

    /// Waits for the next input. `None` after the timeout.
    pub(crate) fn wait(&self, time: Duration) -> Option<Input<T>> {
        let input = self.receiver.recv_timeout(time.min(LOOK)).ok()?;
        if let Input::Datagram(..) = input {
            self.datagrams.fetch_sub(1, Ordering::AcqRel);
        }
        Some(input)
    }

    /// Sending end for received datagrams. It drops datagrams when the queue is full.
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
