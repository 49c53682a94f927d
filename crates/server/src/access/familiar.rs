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

    /// Notes that the user has logged in from this network.
    pub(super) fn add(&self, user: &str, network: IpAddr) {
        let mut addresses = self.addresses.lock();
        if addresses.len() < MAX && addresses.insert((user.to_owned(), network)) {
            let text = serde_json::to_vec(&*addresses).unwrap_or_default();
            // If the disk refuses, they are strangers after the next start; nothing else is lost.
            private::write_soon(&self.file, &text).unwrap_or_default();
        }
    }
}
