//! `server.json`: where programs of the same user find this server while it runs.

use crate::ServerState;
use crate::access::private::{self, PrivateError};
use serde::{Deserialize, Serialize};
use std::fs::{self, File, TryLockError};
use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::path::{Path, PathBuf};

/// Its name in the server's folder.
const FILE: &str = "server.json";
/// What a server keeps locked while it lives.
pub(super) const LOCK: &str = "server.lock";

/// How the running server is reached.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct AddressFile {
    /// Scheme, name and port.
    pub url: String,
    /// Its process.
    pub pid: u32,
    /// SHA-256 of its certificate, in hexadecimal; none without TLS.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fingerprint: Option<String>,
    #[serde(skip)]
    file: PathBuf,
}

impl AddressFile {
    /// Writes where a server listens. A server whose disk is full runs without.
    pub(super) fn write(
        server: &ServerState,
        address: SocketAddr,
        fingerprint: Option<String>,
    ) -> Result<Self, PrivateError> {
        let card = Self {
            url: format!("{}://{}", server.names().scheme(), near(address)),
            pid: std::process::id(),
            fingerprint,
            file: server.settings().state.join(FILE),
        };
        let text = serde_json::to_vec_pretty(&card).map_err(io::Error::from);
        let text = text.map_err(|source| PrivateError::new("write", &card.file, source))?;
        if let Err(error) = private::write_without_room(&card.file, &text) {
            (server.settings().tell)(&format!(
                "{error}: the server runs; other programs of this computer need its address and token"
            ));
            // It may name the server before this one.
            card.remove()?;
        }
        Ok(card)
    }

    /// What the folder's server said; nothing if it ended in order.
    pub fn read(state: &Path) -> Result<Option<Self>, PrivateError> {
        let file = state.join(FILE);
        let Some(text) = private::read(&file)? else { return Ok(None) };
        let card = serde_json::from_str(&text).map_err(io::Error::from);
        card.map(Some).map_err(|source| PrivateError::new("read", &file, source))
    }

    /// What the folder's server says if it lives; nothing of one that died, whose port someone else may have by now.
    pub fn of_living(state: &Path) -> Result<Option<Self>, PrivateError> {
        let lock = state.join(LOCK);
        let unlocked = match File::open(&lock) {
            Ok(file) => file.try_lock_shared(),
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => Err(TryLockError::Error(error)),
        };
        match unlocked {
            Ok(()) => Ok(None),
            Err(TryLockError::WouldBlock) => Self::read(state),
            Err(TryLockError::Error(source)) => Err(PrivateError::new("read", &lock, source)),
        }
    }

    /// The server is gone.
    pub(super) fn remove(&self) -> Result<(), PrivateError> {
        match fs::remove_file(&self.file) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                Err(PrivateError::new("remove", &self.file, error))
            }
            _ => Ok(()),
        }
    }
}

/// How an address is reached from this computer.
fn near(address: SocketAddr) -> SocketAddr {
    let ip = match address.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => IpAddr::V4(Ipv4Addr::LOCALHOST),
        IpAddr::V6(ip) if ip.is_unspecified() => IpAddr::V6(Ipv6Addr::LOCALHOST),
        ip => ip,
    };
    SocketAddr::new(ip, address.port())
}
