//! Places for connections: so many at a time, and one other network gets a part of them only, so that it cannot keep all others
//! out. Knows addresses; must never know streams.

use super::connection::Peer;
use crate::access::network;
use parking_lot::Mutex;
use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

/// Which part of all places one other network gets at most.
const PART: u32 = 4;

/// All places of a server.
#[derive(Debug)]
pub(super) struct Places {
    max: u32,
    free: Arc<Semaphore>,
    taken: Arc<Mutex<BTreeMap<IpAddr, u32>>>,
}

/// One that is taken, until dropped.
#[derive(Debug)]
pub(super) struct Place {
    network: IpAddr,
    taken: Arc<Mutex<BTreeMap<IpAddr, u32>>>,
    _permit: OwnedSemaphorePermit,
}

impl Places {
    pub(super) fn new(max: usize) -> Self {
        let max = u32::try_from(max).unwrap_or(u32::MAX >> 4);
        Self { max, free: Arc::new(Semaphore::new(max as usize)), taken: Arc::default() }
    }

    /// A place for somebody, if there is one.
    pub(super) fn take(&self, peer: Peer) -> Option<Place> {
        let permit = Arc::clone(&self.free).try_acquire_owned().ok()?;
        let network = network(peer.ip);
        let most = if peer.is_near { self.max } else { (self.max / PART).max(1) };
        let mut taken = self.taken.lock();
        let count = taken.entry(network).or_default();
        if *count >= most {
            return None;
        }
        *count += 1;
        Some(Place { network, taken: Arc::clone(&self.taken), _permit: permit })
    }

    /// Waits until all are free, but not for ever.
    pub(super) async fn are_free(&self, patience: Duration) {
        drop(timeout(patience, self.free.acquire_many(self.max)).await);
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut taken = self.taken.lock();
        if let Some(count) = taken.get_mut(&self.network) {
            *count -= 1;
        }
        taken.retain(|_, count| *count > 0);
    }
}

#[cfg(test)]
mod tests {
    use super::{Peer, Places};

    fn peer(text: &str) -> Peer {
        let ip: std::net::IpAddr = text.parse().unwrap();
        Peer { ip, is_near: ip.is_loopback() }
    }

    #[test]
    fn one_network_cannot_keep_the_others_out() {
        let places = Places::new(8);
        let take = |text| places.take(peer(text));
        let (first, second) = (take("2001:db8::1"), take("2001:db8::2"));
        assert!(first.is_some() && second.is_some());
        assert!(take("2001:db8::3").is_none());
        let other = take("10.0.0.1");
        assert!(other.is_some());
        drop(first);
        let again = take("2001:db8::3");
        assert!(again.is_some());
        let near = [0; 5].map(|_| take("127.0.0.1"));
        assert!(near.iter().all(Option::is_some));
        assert!(take("127.0.0.1").is_none());
        drop((second, other, again, near));
        assert!(places.taken.lock().is_empty());
    }
}
