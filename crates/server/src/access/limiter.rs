//! Limits login attempts: a burst, then a slow rate. Pure: time is an argument.
//!
//! Attempts count for their source network and for their user. At an address from which a user has logged in before, attempts
//! from other addresses do not delay that user.

use std::collections::BTreeMap;
use std::net::{IpAddr, Ipv6Addr};

/// Maximum burst of attempts.
const AT_ONCE: u64 = 5;
/// After the burst, one attempt per interval.
const PAUSE_MS: u64 = 10_000;
/// Cost of a successful attempt within that interval: correct logins can load the server, too.
const RIGHT_MS: u64 = 2_000;
/// Maximum number of tracked keys.
const MAX: usize = 10_000;

/// Login attempts, counted by key.
#[derive(Debug, Default)]
pub(super) struct Limiter {
    /// Time at which all attempts of a key are forgotten, in ms.
    spent: BTreeMap<Key, u64>,
}

/// An attempt to log in.
#[derive(Debug, Clone, Copy)]
pub(super) struct Try<'t> {
    pub(super) user: &'t str,
    /// Source [`network`] of the attempt.
    pub(super) from: IpAddr,
    /// True if the user has logged in from there before.
    pub(super) is_familiar: bool,
}

/// Key under which attempts count.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    From(IpAddr),
    User(String),
    UserFrom(String, IpAddr),
}

impl Limiter {
    /// Counts an attempt. `Err` has the seconds until the next attempt is allowed.
    pub(super) fn attempt(&mut self, tried: Try<'_>, now_ms: u64) -> Result<(), u64> {
        self.forget(now_ms);
        let keys = keys(tried);
        let wait = keys.iter().map(|key| self.wait(key, now_ms)).max().unwrap_or_default();
        if wait > 0 {
            return Err(wait.div_ceil(1000));
        }
        for key in keys {
            let spent = self.spent.entry(key).or_insert(now_ms);
            *spent = (*spent).max(now_ms) + PAUSE_MS;
        }
        Ok(())
    }

    /// Refunds most of a successful attempt.
    pub(super) fn succeeded(&mut self, tried: Try<'_>) {
        for key in keys(tried) {
            if let Some(spent) = self.spent.get_mut(&key) {
                *spent = spent.saturating_sub(PAUSE_MS - RIGHT_MS);
            }
        }
    }

    fn wait(&self, key: &Key, now_ms: u64) -> u64 {
        let spent = self.spent.get(key).copied().unwrap_or(now_ms);
        (spent + PAUSE_MS).saturating_sub(now_ms + AT_ONCE * PAUSE_MS)
    }

    /// Drops expired keys. If too many remain, drops the quarter that expires first.
    fn forget(&mut self, now_ms: u64) {
        if self.spent.len() < MAX {
            return;
        }
        self.spent.retain(|_, spent| *spent > now_ms);
        if self.spent.len() < MAX {
            return;
        }
        let mut ends = self.spent.values().copied().collect::<Vec<_>>();
        let (_, first, _) = ends.select_nth_unstable(MAX / 4);
        let first = *first;
        self.spent.retain(|_, spent| *spent > first);
    }
}

fn keys(tried: Try<'_>) -> [Key; 2] {
    let (user, from) = (tried.user.to_owned(), tried.from);
    if tried.is_familiar {
        return [Key::From(from), Key::UserFrom(user, from)];
    }
    [Key::From(from), Key::User(user)]
}

/// Network of an address: an owner of one IPv6 address owns its whole /64.
pub(super) fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => IpAddr::V6(Ipv6Addr::from_bits(address.to_bits() >> 64 << 64)),
        v4 @ IpAddr::V4(_) => v4,
    }
}

#[cfg(test)]
mod tests {
    use super::{Limiter, MAX, Try, network};
    use std::net::IpAddr;

    fn from<'t>(user: &'t str, address: &str) -> Try<'t> {
        Try { user, from: network(address.parse().unwrap()), is_familiar: false }
    }

    #[test]
    fn five_tries_at_once_then_one_in_ten_seconds() {
        let mut limiter = Limiter::default();
        let mut attempt = |now_ms| limiter.attempt(from("anna", "10.0.0.1"), now_ms);
        assert_eq!([0; 5].map(&mut attempt), [Ok(()); 5]);
        assert_eq!(attempt(0), Err(10));
        assert_eq!(attempt(9_001), Err(1));
        assert_eq!(attempt(10_000), Ok(()));
        assert_eq!(attempt(10_000), Err(10));
        assert_eq!(
            [100_000; 6].map(&mut attempt),
            [Ok(()), Ok(()), Ok(()), Ok(()), Ok(()), Err(10)]
        );
    }

    #[test]
    fn one_address_cannot_try_many_users_nor_one_network_many_addresses() {
        let mut limiter = Limiter::default();
        for number in 0..5 {
            let address = format!("2001:db8::{number}");
            assert_eq!(limiter.attempt(from(&format!("user{number}"), &address), 0), Ok(()));
        }
        assert_eq!(limiter.attempt(from("another", "2001:db8::99"), 0), Err(10));
        assert_eq!(limiter.attempt(from("another", "2001:db8:1::1"), 0), Ok(()));
    }

    #[test]
    fn who_was_let_in_here_before_is_not_held_up_by_others() {
        let mut limiter = Limiter::default();
        for number in 2..=250 {
            let address = format!("10.0.0.{number}");
            limiter.attempt(from("anna", &address), 1).unwrap_or_default();
        }
        assert_eq!(limiter.attempt(from("anna", "10.0.1.1"), 1), Err(10));
        let home = Try { is_familiar: true, ..from("anna", "10.0.0.1") };
        assert_eq!(limiter.attempt(home, 1), Ok(()));
    }

    #[test]
    fn a_right_password_counts_for_little() {
        let mut limiter = Limiter::default();
        let here = from("anna", "10.0.0.1");
        let mut log_in = |now_ms| {
            let tried = limiter.attempt(here, now_ms);
            tried.inspect(|()| limiter.succeeded(here))
        };
        assert_eq!((0..100).take_while(|_| log_in(0).is_ok()).count(), 21);
        assert_eq!((log_in(1_000), log_in(2_000)), (Err(1), Ok(())));
    }

    #[test]
    fn what_is_remembered_is_bounded() {
        let mut limiter = Limiter::default();
        for number in 0..u32::try_from(2 * MAX).unwrap() {
            let (user, from) = (format!("user{number}"), IpAddr::from(number.to_be_bytes()));
            let tried = Try { user: &user, from, is_familiar: false };
            limiter.attempt(tried, u64::from(number)).unwrap();
        }
        assert!(limiter.spent.len() <= MAX + 2);
    }
}
