//! Addresses from which each user has logged in before. Attempts from other addresses do not delay a user there, neither by
//! their rate nor by their number. Stored on disk.

use super::private::{self, PrivateError};
use rafcon_locks::Mutex;
use std::collections::BTreeSet;
use std::net::IpAddr;
use std::path::PathBuf;

/// Maximum number of remembered pairs of user and network.
const MAX: usize = 10_000;

/// Users and the networks from which they have logged in.
#[derive(Debug)]
pub(super) struct Familiar {
    file: PathBuf,
    addresses: Mutex<BTreeSet<(String, IpAddr)>>,
}

impl Familiar {
    /// Loads the addresses of earlier servers. An invalid file counts as empty: each user is unfamiliar once.
    pub(super) fn open(file: PathBuf) -> Result<Self, PrivateError> {
        let text = private::read(&file)?.unwrap_or_default();
        let addresses = serde_json::from_str(&text).unwrap_or_default();
        Ok(Self { file, addresses: Mutex::new(addresses) })
    }

    /// True if the user has logged in from this network before.
    pub(super) fn knows(&self, user: &str, network: IpAddr) -> bool {
        self.addresses.lock().contains(&(user.to_owned(), network))
    }

    /// Stores a login from this network. Beyond the limit, another address is forgotten.
    pub(super) fn add(&self, user: &str, network: IpAddr) {
        let mut addresses = self.addresses.lock();
        let entry = (user.to_owned(), network);
        if addresses.contains(&entry) {
            return;
        }
        if addresses.len() >= MAX {
            addresses.pop_first();
        }
        if addresses.insert(entry) {
            let text = serde_json::to_vec(&*addresses).unwrap_or_default();
            // A failed write costs only the familiarity after the next start.
            private::write_soon(&self.file, &text).unwrap_or_default();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Familiar, MAX};
    use std::net::{IpAddr, Ipv4Addr};

    #[test]
    fn a_limited_number_is_remembered_with_the_newest() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("familiar.json");
        let network = |number: usize| IpAddr::V4(Ipv4Addr::from(u32::try_from(number).unwrap()));
        let all: Vec<_> = (0..MAX).map(|number| ("ben", network(number))).collect();
        std::fs::write(&file, serde_json::to_vec(&all).unwrap()).unwrap();
        let familiar = Familiar::open(file).unwrap();
        familiar.add("zoe", network(7));
        assert!(familiar.knows("zoe", network(7)) && familiar.knows("ben", network(MAX - 1)));
        assert!(!familiar.knows("ben", network(0)));
        assert_eq!(familiar.addresses.lock().len(), MAX);
    }
}
