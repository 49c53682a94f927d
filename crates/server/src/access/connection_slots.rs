//! Slots for connections: a limit for all, a lower one for those without a login, and a share of all for one remote network.
//! If no slot is free, a new connection replaces the oldest one without a login. Idle or stalled connections therefore cannot
//! keep out a user who has to stop a robot. Knows addresses and users' names; does not know streams.

use super::limiter::network;
use crate::Failure;
use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use rafcon_locks::Mutex;
use std::collections::BTreeMap;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{oneshot, watch};
use tokio::time::timeout;

/// One remote network, or one user, gets at most this fraction of all slots: one in four.
const PART: usize = 4;

/// Source of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Peer {
    pub(crate) ip: IpAddr,
    /// True if the client runs on this computer.
    pub(crate) is_near: bool,
}

impl Peer {
    /// The client at the address `peer`, on a connection to the server's address `own`.
    pub(crate) fn of(peer: SocketAddr, own: Option<SocketAddr>) -> Self {
        let ip = peer.ip().to_canonical();
        let is_own = own.is_some_and(|own| own.ip().to_canonical() == ip);
        Self { ip, is_near: is_own || ip.is_loopback() }
    }
}

impl<S: Sync> FromRequestParts<S> for Peer {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, Failure> {
        parts.extensions.get::<Self>().copied().ok_or_else(from_nowhere)
    }
}

/// Limits on the number of open connections.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Capacity {
    /// Limit for all connections.
    pub(crate) all: usize,
    /// Limit for those without a login.
    pub(crate) anonymous: usize,
}

impl Capacity {
    /// At most `max` connections of a process that can open this many files. Half of the files are reserved for users and their
    /// runs. Half of those are reserved for everything else: journals, runners, machines.
    pub(crate) fn of(max: usize, files: usize) -> Self {
        Self { all: max.min(files - files / 4).max(1), anonymous: max.min(files / 2).max(1) }
    }
}

/// The refusal of a request whose source is unknown.
pub(super) fn from_nowhere() -> Failure {
    let message = "it is not known where this request comes from: use the server's port";
    Failure::forbidden("from_nowhere", message)
}

/// All connection slots of a server.
#[derive(Debug, Clone)]
pub(crate) struct ConnectionSlots {
    capacity: Capacity,
    taken: Arc<Mutex<Taken>>,
    /// Number of connections, including those that lost their slot and are still closing.
    count: watch::Sender<usize>,
    /// Number of connections that were closed or refused because no slot was free.
    crowded_out: watch::Sender<u64>,
}

/// Slots by number: the lower the number, the older the connection.
#[derive(Debug, Default)]
struct Taken {
    next: u64,
    places: BTreeMap<u64, SlotHolder>,
}

#[derive(Debug)]
struct SlotHolder {
    network: IpAddr,
    user: Option<String>,
    /// Dropped when another connection takes the slot.
    _kept: oneshot::Sender<()>,
}

/// Resolves when another connection has taken the slot.
pub(crate) type Lost = oneshot::Receiver<()>;

/// The slot of a connection, released on drop.
#[derive(Debug)]
pub(crate) struct ConnectionSlot {
    number: u64,
    places: ConnectionSlots,
}

impl ConnectionSlots {
    pub(crate) fn new(capacity: Capacity) -> Self {
        let (count, crowded_out) = (watch::Sender::new(0), watch::Sender::new(0));
        Self { capacity, taken: Arc::default(), count, crowded_out }
    }

    /// A slot for a new connection: a free one, or that of the oldest connection without a login.
    pub(crate) fn take(&self, peer: Peer) -> Option<(Arc<ConnectionSlot>, Lost)> {
        let network = network(peer.ip);
        let mut taken = self.taken.lock();
        let has_too_many = taken.of(network) >= self.most_of_network(peer);
        if has_too_many || self.is_full(&taken) {
            self.crowded_out.send_modify(|count| *count += 1);
            let crowd = if has_too_many { Some(network) } else { taken.most_anonymous() };
            taken.end_oldest(crowd?)?;
        }
        let number = taken.next;
        let (kept, lost) = oneshot::channel();
        taken.next += 1;
        taken.places.insert(number, SlotHolder { network, user: None, _kept: kept });
        self.count.send_modify(|count| *count += 1);
        Some((Arc::new(ConnectionSlot { number, places: self.clone() }), lost))
    }

    /// Maximum number of connections from the network of this client.
    fn most_of_network(&self, peer: Peer) -> usize {
        let all = self.capacity.all;
        if peer.is_near { all } else { (all / PART).max(1) }
    }

    /// True if a new connection needs the slot of another one.
    fn is_full(&self, taken: &Taken) -> bool {
        let Capacity { all, anonymous } = self.capacity;
        taken.places.len() >= all || taken.anonymous().count() >= anonymous
    }

    /// Waits, for a limited time, until the connections that lost their slot are closed.
    pub(crate) async fn wait_until_closed(&self, limit: Duration) {
        let (mut count, all) = (self.count.subscribe(), self.capacity.all);
        drop(timeout(limit, count.wait_for(|count| *count <= all)).await);
    }

    /// Limits on the number of connections.
    pub(crate) fn capacity(&self) -> Capacity {
        self.capacity
    }

    /// Number of connections that were closed or refused because no slot was free.
    pub(crate) fn crowded_out(&self) -> watch::Receiver<u64> {
        self.crowded_out.subscribe()
    }

    /// Waits, for a limited time, until all connections are closed.
    pub(crate) async fn wait_until_free(&self, limit: Duration) {
        let mut count = self.count.subscribe();
        drop(timeout(limit, count.wait_for(|count| *count == 0)).await);
    }
}

impl Taken {
    fn of(&self, network: IpAddr) -> usize {
        self.places.values().filter(|holder| holder.network == network).count()
    }

    /// Connections without a login.
    fn anonymous(&self) -> impl Iterator<Item = &SlotHolder> {
        self.places.values().filter(|holder| holder.user.is_none())
    }

    /// The network with the most connections without a login.
    fn most_anonymous(&self) -> Option<IpAddr> {
        let mut counts = BTreeMap::<IpAddr, usize>::new();
        for holder in self.anonymous() {
            *counts.entry(holder.network).or_default() += 1;
        }
        counts.into_iter().max_by_key(|(_, count)| *count).map(|(network, _)| network)
    }

    /// Ends the oldest connection without a login from a network. `None` if the network has no such connection.
    fn end_oldest(&mut self, network: IpAddr) -> Option<()> {
        let is_anonymous = |holder: &SlotHolder| holder.network == network && holder.user.is_none();
        let (&number, _) = self.places.iter().find(|(_, holder)| is_anonymous(holder))?;
        self.places.remove(&number).map(drop)
    }
}

impl ConnectionSlot {
    /// Marks the slot as used by a logged-in user. One user can mark a quarter of all slots.
    pub(crate) fn log_in(&self, user: &str) {
        let mut taken = self.places.taken.lock();
        let of_user = taken.places.values().filter(|holder| holder.user.as_deref() == Some(user));
        if of_user.count() >= (self.places.capacity.all / PART).max(1) {
            return;
        }
        if let Some(holder) = taken.places.get_mut(&self.number) {
            holder.user = Some(user.to_owned());
        }
    }
}

impl Drop for ConnectionSlot {
    fn drop(&mut self) {
        self.places.taken.lock().places.remove(&self.number);
        self.places.count.send_modify(|count| *count -= 1);
    }
}

#[cfg(test)]
mod tests {
    use super::{Capacity, ConnectionSlot, ConnectionSlots, Peer};
    use expect_test::{Expect, expect};
    use std::fmt::Write as _;
    use std::sync::Arc;

    /// Each line is `name comes address` (a trailing `!` logs in) or `name goes`. The output adds the remaining connections.
    fn check(max: usize, script: &str, expect: &Expect) {
        check_with(Capacity { all: max, anonymous: max }, script, expect);
    }

    fn check_with(capacity: Capacity, script: &str, expect: &Expect) {
        let places = ConnectionSlots::new(capacity);
        let mut there: Vec<(String, Arc<ConnectionSlot>)> = Vec::new();
        let mut seen = String::new();
        for line in script.lines().map(str::trim).filter(|line| !line.is_empty()) {
            let words: Vec<&str> = line.split_whitespace().collect();
            match words[..] {
                [name, "comes", address] => {
                    let ip: std::net::IpAddr = address.trim_end_matches('!').parse().unwrap();
                    let place = places.take(Peer { ip, is_near: ip.is_loopback() });
                    there.extend(place.map(|(place, _lost)| (name.to_owned(), place)));
                    if let (true, Some((_, place))) = (address.ends_with('!'), there.last()) {
                        place.log_in("ana");
                    }
                }
                [name, "goes"] => there.retain(|(other, _)| other != name),
                _ => panic!("{line}"),
            }
            let taken = places.taken.lock();
            let held = there.iter().filter(|(_, place)| taken.places.contains_key(&place.number));
            let names: Vec<&str> = held.map(|(name, _)| name.as_str()).collect();
            writeln!(seen, "{line} -> {}", names.join(" ")).unwrap();
        }
        expect.assert_eq(&seen);
        drop(there);
        assert!(places.taken.lock().places.is_empty() && *places.count.borrow() == 0);
    }

    #[test]
    fn one_network_cannot_keep_the_others_out() {
        check(
            8,
            "a comes 2001:db8::1
             b comes 2001:db8::2
             c comes 2001:db8::3
             d comes 10.0.0.1
             b goes
             e comes 2001:db8::4",
            &expect![[r"
                a comes 2001:db8::1 -> a
                b comes 2001:db8::2 -> a b
                c comes 2001:db8::3 -> b c
                d comes 10.0.0.1 -> b c d
                b goes -> c d
                e comes 2001:db8::4 -> c d e
            "]],
        );
    }

    #[test]
    fn who_is_logged_in_keeps_the_place_and_a_newcomer_takes_that_of_the_oldest_stranger() {
        check(
            4,
            "a comes 127.0.0.1!
             b comes 127.0.0.1
             c comes 127.0.0.1
             d comes 127.0.0.1
             e comes 127.0.0.1
             f comes 127.0.0.1
             g comes 10.0.0.1",
            &expect![[r"
                a comes 127.0.0.1! -> a
                b comes 127.0.0.1 -> a b
                c comes 127.0.0.1 -> a b c
                d comes 127.0.0.1 -> a b c d
                e comes 127.0.0.1 -> a c d e
                f comes 127.0.0.1 -> a d e f
                g comes 10.0.0.1 -> a e f g
            "]],
        );
    }

    #[test]
    fn one_user_cannot_keep_the_others_out() {
        check(
            4,
            "a comes 127.0.0.1!
             b comes 127.0.0.1!
             c comes 127.0.0.1!
             d comes 127.0.0.1!
             e comes 127.0.0.1",
            &expect![[r"
                a comes 127.0.0.1! -> a
                b comes 127.0.0.1! -> a b
                c comes 127.0.0.1! -> a b c
                d comes 127.0.0.1! -> a b c d
                e comes 127.0.0.1 -> a c d e
            "]],
        );
    }
    #[test]
    fn strangers_leave_places_for_users() {
        check_with(
            Capacity { all: 4, anonymous: 2 },
            "a comes 127.0.0.1
             b comes 127.0.0.1
             c comes 127.0.0.1
             d comes 127.0.0.1!
             e comes 127.0.0.1
             f comes 127.0.0.1",
            &expect![[r"
                a comes 127.0.0.1 -> a
                b comes 127.0.0.1 -> a b
                c comes 127.0.0.1 -> b c
                d comes 127.0.0.1! -> c d
                e comes 127.0.0.1 -> c d e
                f comes 127.0.0.1 -> d e f
            "]],
        );
    }

    #[test]
    fn the_capacity_leaves_files_for_everything_else() {
        let of = |max, files| {
            let Capacity { all, anonymous } = Capacity::of(max, files);
            (all, anonymous)
        };
        assert_eq!(of(1024, 500_000), (1024, 1024));
        assert_eq!(of(1024, 1000), (750, 500));
        assert_eq!(of(1024, 40), (30, 20));
        assert_eq!(of(1024, 0), (1, 1));
    }
}
