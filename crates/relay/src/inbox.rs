//! What a relay waits for, from several threads: datagrams, and whatever else its side sends it.

use crate::carrier::{Carrier, StationAddress, any_port};
use crate::error::RelayError;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread;
use std::time::Duration;

/// So much waits at most.
const WAITING: usize = 4_096;
/// So many datagrams among that; those beyond are lost, as on any bad link. So commands always find a place.
const DATAGRAMS_MAX: usize = 1_024;
/// No datagram is longer.
const DATAGRAM_MAX: usize = 65_535;
/// A thread that receives looks this often whether it is to end.
const LOOK: Duration = Duration::from_millis(200);

/// Ends a relay.
#[derive(Debug, Clone, Default)]
pub struct Stopper(Arc<AtomicBool>);

impl Stopper {
    /// Ends it; it takes a moment.
    pub fn stop(&self) {
        self.0.store(true, Ordering::Release);
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.0.load(Ordering::Acquire)
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

    /// What carries datagrams to a station; its answers arrive here until the relay is stopped.
    pub(crate) fn dial(
        &self,
        station: &StationAddress,
        stopper: &Stopper,
    ) -> Result<Carrier, RelayError> {
        match *station {
            StationAddress::Udp(to) => {
                let socket = self.listen(any_port(to), stopper)?;
                Ok(Carrier::Udp(socket, to))
            }
        }
    }

    /// Binds a socket whose datagrams arrive here until the relay is stopped.
    pub(crate) fn listen(
        &self,
        address: SocketAddr,
        stopper: &Stopper,
    ) -> Result<Arc<UdpSocket>, RelayError> {
        let bind = || {
            let socket = Arc::new(UdpSocket::bind(address)?);
            let receiving = Arc::clone(&socket);
            receiving.set_read_timeout(Some(LOOK))?;
            let (sender, stopper) = (self.sender(), stopper.clone());
            let waiting = Arc::clone(&self.datagrams);
            let receive = move || receive(&receiving, &sender, &waiting, &stopper);
            thread::Builder::new().name("datagrams".to_owned()).spawn(receive)?;
            Ok(socket)
        };
        bind().map_err(|source| RelayError::Bind { address, source })
    }
}

fn receive<T>(
    socket: &Arc<UdpSocket>,
    sender: &SyncSender<Input<T>>,
    waiting: &AtomicUsize,
    stopper: &Stopper,
) {
    let mut buffer = vec![0; DATAGRAM_MAX];
    while !stopper.is_stopped() {
        if let Ok((length, from)) = socket.recv_from(&mut buffer)
            && waiting.load(Ordering::Acquire) < DATAGRAMS_MAX
        {
            waiting.fetch_add(1, Ordering::AcqRel);
            let carrier = Carrier::Udp(Arc::clone(socket), from);
            sender.send(Input::Datagram(carrier, buffer[..length].to_vec())).unwrap_or_default();
        }
    }
}
