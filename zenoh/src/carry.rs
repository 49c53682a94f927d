//! Common parts of both sides: a Zenoh session that is reopened when it is silent, and non-blocking sending of datagrams.

use crate::command_line::{Network, complain};
use anyhow::{Result, anyhow};
use std::future::Future;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use tokio::net::UdpSocket;
use tokio::time::{Instant, sleep_until, timeout};
use zenoh::Session;
use zenoh::qos::{CongestionControl, Priority, Reliability};

/// Maximum length of a datagram of the link.
pub(crate) const DATAGRAM_MAX: usize = 2_048;
/// Buffer for a datagram, with one more byte to detect a longer one.
pub(crate) type Buffer = [u8; DATAGRAM_MAX + 1];
/// Timeout for closing a session.
const CLOSE: Duration = Duration::from_secs(2);

/// Time of the last arrival that counts for the session.
#[derive(Debug)]
pub(crate) struct LastHeard {
    since: Instant,
    /// Time in milliseconds; 0 for never.
    at: AtomicU64,
}

impl LastHeard {
    fn new() -> Self {
        Self { since: Instant::now(), at: AtomicU64::new(0) }
    }

    /// Records that something arrived now.
    pub(crate) fn note(&self) {
        let now = u64::try_from(self.since.elapsed().as_millis()).unwrap_or(u64::MAX);
        self.at.store(now.max(1), Ordering::Release);
    }

    /// Waits until nothing has arrived for this time after an arrival.
    async fn wait_for_silence(&self, silence: Duration) {
        loop {
            let heard = self.at.load(Ordering::Acquire);
            let from =
                if heard == 0 { Instant::now() } else { self.since + Duration::from_millis(heard) };
            let until = from + silence;
            sleep_until(until).await;
            if heard != 0 && self.at.load(Ordering::Acquire) == heard {
                return;
            }
        }
    }
}

/// Opens sessions in sequence, and lets each be used until it is silent. A session that its other end has dropped does not
/// always detect that by itself.
pub(crate) async fn keep_session<F: Future<Output = Result<()>>>(
    network: &Network,
    mut carry: impl FnMut(Session, std::sync::Arc<LastHeard>) -> F,
) -> Result<()> {
    loop {
        let session = open(network).await?;
        let heard = std::sync::Arc::new(LastHeard::new());
        tokio::select! {
            ended = carry(session.clone(), heard.clone()) => return ended,
            () = heard.wait_for_silence(network.silence()) => {}
        }
        complain("nothing arrives: the session is opened anew");
        if timeout(CLOSE, session.close()).await.is_err() {
            complain("the session before does not close, and is left behind");
        }
    }
}

/// Opens a session of Zenoh with the configuration of `network`.
async fn open(network: &Network) -> Result<Session> {
    let opened = zenoh::open(network.config()?).await;
    opened.map_err(|error| anyhow!(error).context("cannot open a session of Zenoh"))
}

/// Puts a datagram into the network, which drops it instead of blocking.
pub(crate) async fn put(session: &Session, key: &str, datagram: &[u8], priority: Priority) {
    let put = session.put(key, datagram);
    let put = put.congestion_control(CongestionControl::Drop).priority(priority).express(true);
    // A missing network is like a link that loses everything.
    drop(put.reliability(Reliability::BestEffort).await);
}

/// Receives the next datagram of valid length, with the address of its sender.
pub(crate) async fn receive<'b>(
    socket: &UdpSocket,
    buffer: &'b mut Buffer,
) -> (&'b [u8], SocketAddr) {
    loop {
        // The kernel reports here that an earlier datagram was refused.
        if let Ok((length, from)) = socket.recv_from(buffer).await
            && length <= DATAGRAM_MAX
        {
            return (&buffer[..length], from);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{DATAGRAM_MAX, receive};
    use tokio::net::UdpSocket;

    #[tokio::test]
    async fn a_datagram_that_is_too_long_is_dropped_and_the_next_one_arrives_whole() {
        let receiver = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        let sender = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        let to = receiver.local_addr().unwrap();
        for length in [DATAGRAM_MAX + 1, DATAGRAM_MAX, 1] {
            sender.send_to(&vec![7; length], to).await.unwrap();
        }
        let mut buffer = [0; DATAGRAM_MAX + 1];
        for length in [DATAGRAM_MAX, 1] {
            let (datagram, from) = receive(&receiver, &mut buffer).await;
            assert_eq!((datagram, from), (&vec![7; length][..], sender.local_addr().unwrap()));
        }
    }
}
