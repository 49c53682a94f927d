//! `server.json`: address of a running server, for other programs of its user.

use crate::ServerState;
use crate::access::private::{self, PrivateError};
use serde::{Deserialize, Serialize};
use std::fs::{self, File, TryLockError};
use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::path::{Path, PathBuf};

/// Name of the file in the server's folder.
const FILE: &str = "server.json";
/// File that a running server keeps locked.
pub(super) const LOCK: &str = "server.lock";

/// Address and process of a running server.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct AddressFile {
    /// URL of the server: scheme, name and port.
    pub url: String,
    /// Id of the server's process.
    pub pid: u32,
    /// SHA-256 of its certificate, in hexadecimal. `None` without TLS.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fingerprint: Option<String>,
    #[serde(skip)]
    file: PathBuf,
}

impl AddressFile {
    /// Writes the address of a server. With a full disk, the server runs without this file.
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
            // The file may describe the previous server.
            card.remove()?;
        }
        Ok(card)
    }

    /// Content of the file. `None` if the last server ended regularly.
    pub fn read(state: &Path) -> Result<Option<Self>, PrivateError> {
        let file = state.join(FILE);
        let Some(text) = private::read(&file)? else { return Ok(None) };
        let card = serde_json::from_str(&text).map_err(io::Error::from);
        card.map(Some).map_err(|source| PrivateError::new("read", &file, source))
    }

    /// Content of the file if the server still runs. A crashed server returns `None`, because its port may belong to another program now.
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

    /// Removes the file when the server ends.
    pub(super) fn remove(&self) -> Result<(), PrivateError> {
        match fs::remove_file(&self.file) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                Err(PrivateError::new("remove", &self.file, error))
            }
            _ => Ok(()),
        }
    }
}

/// Address that reaches the server from this computer.
fn near(address: SocketAddr) -> SocketAddr {
    let ip = match address.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => IpAddr::V4(Ipv4Addr::LOCALHOST),
        IpAddr::V6(ip) if ip.is_unspecified() => IpAddr::V6(Ipv6Addr::LOCALHOST),
        ip => ip,
    };
    SocketAddr::new(ip, address.port())
}
