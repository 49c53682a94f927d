//! From where each user was let in before. What others try elsewhere does not hold up who comes from there: neither by the
//! limit of tries nor by their number. It outlives the server.

use super::private::{self, PrivateError};
use rafcon_locks::Mutex;
use std::collections::BTreeSet;
use std::net::IpAddr;
use std::path::PathBuf;

/// So many are remembered.
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

    /// Whether the user was let in from this network before.
    pub(super) fn knows(&self, user: &str, network: IpAddr) -> bool {
        self.addresses.lock().contains(&(user.to_owned(), network))
    }

    /// The user was let in from this network.
    pub(super) fn add(&self, user: &str, network: IpAddr) {
        let mut addresses = self.addresses.lock();
        if addresses.len() < MAX && addresses.insert((user.to_owned(), network)) {
            let text = serde_json::to_vec(&*addresses).unwrap_or_default();
            // A disk that refuses makes strangers of them after the next start, and nothing else.
            private::write_soon(&self.file, &text).unwrap_or_default();
        }
    }
}
