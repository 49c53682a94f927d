//! The addresses from which each user has logged in before. Attempts from elsewhere do not delay a user at such an address:
//! neither by the limit of attempts nor by their number. It outlives the server.

use super::private::{self, PrivateError};
use rafcon_locks::Mutex;
use std::collections::BTreeSet;
use std::net::IpAddr;
use std::path::PathBuf;

/// How many are remembered.
const MAX: usize = 10_000;

/// Users and the addresses from which they were let in.
#[derive(Debug)]
pub(super) struct Familiar {
    file: PathBuf,
    addresses: Mutex<BTreeSet<(String, IpAddr)>>,
}

impl Familiar {
    /// Those of the servers before. A file that makes no sense counts as none: everyone is a stranger once.
    pub(super) fn open(file: PathBuf) -> Result<Self, PrivateError> {
        let text = private::read(&file)?.unwrap_or_default();
        let addresses = serde_json::from_str(&text).unwrap_or_default();
        Ok(Self { file, addresses: Mutex::new(addresses) })
    }

    /// Whether the user has logged in from this network before.
    pub(super) fn knows(&self, user: &str, network: IpAddr) -> bool {
        self.addresses.lock().contains(&(user.to_owned(), network))
    }

    /// Notes that the user has logged in from this network. Beyond the limit another address is forgotten.
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
            // If the disk refuses, they are strangers after the next start; nothing else is lost.
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
