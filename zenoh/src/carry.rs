//! What both sides do: open a session of Zenoh and open it anew when it is silent; put datagrams into it without ever waiting.

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

/// No datagram of the link is longer.
pub(crate) const DATAGRAM_MAX: usize = 2_048;
/// Room for a datagram, and for one more byte that shows that it is too long.
pub(crate) type Buffer = [u8; DATAGRAM_MAX + 1];
/// A session that does not close within this time is left behind.
const CLOSE: Duration = Duration::from_secs(2);

/// When something arrived last, as far as it matters for the session.
#[derive(Debug)]
pub(crate) struct LastHeard {
    since: Instant,
    /// Milliseconds; 0 for never.
    at: AtomicU64,
}

impl LastHeard {
    fn new() -> Self {
        Self { since: Instant::now(), at: AtomicU64::new(0) }
    }

    /// Something arrived.
    pub(crate) fn note(&self) {
        let now = u64::try_from(self.since.elapsed().as_millis()).unwrap_or(u64::MAX);
        self.at.store(now.max(1), Ordering::Release);
    }

    /// Ends when nothing has arrived for so long after something did.
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

/// Opens sessions, one after the other, and lets each be used until it is silent: a session whose other end forgot it does not always
/// notice that by itself.
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

/// Opens a session.
async fn open(network: &Network) -> Result<Session> {
    let opened = zenoh::open(network.config()?).await;
    opened.map_err(|error| anyhow!(error).context("cannot open a session of Zenoh"))
}

/// Puts a datagram into the network, which drops it rather than wait.
pub(crate) async fn put(session: &Session, key: &str, datagram: &[u8], priority: Priority) {
    let put = session.put(key, datagram);
    let put = put.congestion_control(CongestionControl::Drop).priority(priority).express(true);
    // A network that is not there is a link that loses everything.
    drop(put.reliability(Reliability::BestEffort).await);
}

/// Receives the next datagram that is not too long, and the address of its sender.
pub(crate) async fn receive<'b>(
    socket: &UdpSocket,
    buffer: &'b mut Buffer,
) -> (&'b [u8], SocketAddr) {
    loop {
        // The kernel reports here that nobody listens at the address of an earlier datagram.
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
