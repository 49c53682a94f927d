//! A connection to a server, plain or with TLS. Knows sockets and certificates, but not the protocol above them.

use super::trust::Pinned;
use super::{Address, Fault, Fingerprint};
use rustls::pki_types::ServerName;
use rustls::{ClientConfig, ClientConnection, StreamOwned};
use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpStream, ToSocketAddrs as _};
use std::sync::Arc;
use std::time::Duration;

/// Connection timeout for one address.
const CONNECT: Duration = Duration::from_secs(10);

/// A TCP connection, with or without TLS.
#[derive(Debug)]
pub(crate) enum Stream {
    Plain(TcpStream),
    Tls(Box<StreamOwned<ClientConnection, TcpStream>>),
}

impl Stream {
    /// Connects. `trusted` is the only accepted certificate; `patience` is the read timeout.
    pub(crate) fn connect(
        address: &Address,
        trusted: Option<Fingerprint>,
        patience: Duration,
    ) -> Result<Self, Fault> {
        let unreachable = |source| Fault::Unreachable { server: address.to_string(), source };
        let socket = reach(address).map_err(unreachable)?;
        socket.set_nodelay(true).map_err(unreachable)?;
        socket.set_read_timeout(Some(patience)).map_err(unreachable)?;
        socket.set_write_timeout(Some(patience)).map_err(unreachable)?;
        if address.is_secure { secure(address, trusted, socket) } else { Ok(Self::Plain(socket)) }
    }

    /// The TCP socket, below TLS.
    pub(crate) fn socket(&self) -> &TcpStream {
        match self {
            Self::Plain(socket) => socket,
            Self::Tls(stream) => stream.get_ref(),
        }
    }
}

/// Connects to the first reachable address of the host.
fn reach(address: &Address) -> io::Result<TcpStream> {
    let places: Vec<SocketAddr> =
        (address.host.as_str(), address.port).to_socket_addrs()?.collect();
    let mut failed = io::Error::new(io::ErrorKind::NotFound, "this name has no address");
    for place in places {
        match TcpStream::connect_timeout(&place, CONNECT) {
            Ok(socket) => return Ok(socket),
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

fn secure(
    address: &Address,
    trusted: Option<Fingerprint>,
    mut socket: TcpStream,
) -> Result<Stream, Fault> {
    let server = address.to_string();
    let unreachable = |source| Fault::Unreachable { server: server.clone(), source };
    let pinned = Arc::new(Pinned::new(trusted));
    let config = ClientConfig::builder_with_provider(pinned.provider())
        .with_safe_default_protocol_versions()
        .map_err(|error| unreachable(io::Error::other(error)))?
        .dangerous()
        .with_custom_certificate_verifier(Arc::clone(&pinned) as _)
        .with_no_client_auth();
    let name = ServerName::try_from(address.host.clone())
        .map_err(|error| unreachable(io::Error::other(error)))?;
    let mut tls = ClientConnection::new(Arc::new(config), name)
        .map_err(|error| unreachable(io::Error::other(error)))?;
    while tls.is_handshaking() {
        if let Err(source) = tls.complete_io(&mut socket) {
            return Err(match (pinned.seen(), trusted) {
                (Some(seen), Some(known)) if seen != known => {
                    Fault::Changed { server, known, seen }
                }
                (Some(seen), None) => Fault::Unknown { server, seen },
                _ => Fault::Unreachable { server, source },
            });
        }
    }
    Ok(Stream::Tls(Box::new(StreamOwned::new(tls, socket))))
}

impl Read for Stream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Plain(socket) => socket.read(buffer),
            Self::Tls(stream) => stream.read(buffer),
        }
    }
}

impl Write for Stream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Plain(socket) => socket.write(bytes),
            Self::Tls(stream) => stream.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Plain(socket) => socket.flush(),
            Self::Tls(stream) => stream.flush(),
        }
    }
}
