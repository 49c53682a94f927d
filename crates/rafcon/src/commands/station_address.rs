//! Address of a station in the form that people write, the WebSocket connection to it, and the station's certificate for
//! robots with TLS.

use super::remote::notebook;
use crate::client::{Address, Fault, Fingerprint, Stream};
use crate::environment::Environment;
use anyhow::{Context as _, Result, bail};
use rafcon_relay::{ByteStream, Dial, Secure, StationAddress};
use rustls::{ServerConfig, ServerConnection, StreamOwned};
use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::slice::Iter;
use std::sync::Arc;
use std::time::Duration;

/// Default port of a station.
const USUAL_PORT: u16 = 4748;
/// Read timeout of a connection; a station without a response is dropped.
const PATIENCE: Duration = Duration::from_secs(30);

/// Parses `udp://HOST:PORT`, `ws://HOST:PORT` or `wss://HOST:PORT`, the latter two with an optional path. A station at
/// `wss://` takes the next fingerprint.
pub(super) fn station_address(
    text: &str,
    fingerprints: &mut Iter<'_, String>,
    environment: &Environment,
) -> Result<StationAddress> {
    let wrong = || {
        format!(
            "`{text}` is no address of a station: it looks like `udp://ground.example:{USUAL_PORT}`, or `wss://ground.example:{USUAL_PORT}` where UDP is closed"
        )
    };
    let (scheme, rest) = text.split_once("://").unwrap_or(("udp", text));
    let scheme_of_server = match scheme {
        "udp" => {
            let found = rest.to_socket_addrs().with_context(wrong)?.next();
            let found = found.with_context(|| format!("`{text}` has no address"))?;
            return Ok(StationAddress::Udp(found));
        }
        "ws" => "http",
        "wss" => "https",
        _ => bail!(wrong()),
    };
    let (place, path) = rest.find('/').map_or((rest, "/"), |at| rest.split_at(at));
    let has_port = place.rsplit_once(':').is_some_and(|(_, port)| !port.contains(']'));
    let port = if has_port { String::new() } else { format!(":{USUAL_PORT}") };
    let address = Address::parse(&format!("{scheme_of_server}://{place}{port}"));
    let (address, _) = address.ok().with_context(wrong)?;
    let trusted = trusted(&address, fingerprints, environment)?;
    Ok(StationAddress::WebSocket(Arc::new(StationDial { path: path.to_owned(), address, trusted })))
}

/// The certificate that the station must have. The next fingerprint from the options is saved.
fn trusted(
    address: &Address,
    fingerprints: &mut Iter<'_, String>,
    environment: &Environment,
) -> Result<Option<Fingerprint>> {
    if !address.is_secure {
        return Ok(None);
    }
    let notebook = notebook(environment)?;
    if let Some(text) = fingerprints.next() {
        let print = Fingerprint::parse(text).with_context(|| {
            format!("--station-fingerprint {text}: write 64 hexadecimal digits")
        })?;
        notebook.remember(address, &print)?;
        return Ok(Some(print));
    }
    let known = notebook.certificate(address)?;
    let known = known.with_context(|| {
        let authority = address.authority();
        format!(
            "the certificate of the station at {authority} is not known: name it with --station-fingerprint, as `rafcon station` prints it"
        )
    })?;
    Ok(Some(known))
}

/// Opens streams to a station.
#[derive(Debug)]
struct StationDial {
    address: Address,
    path: String,
    trusted: Option<Fingerprint>,
}

impl Dial for StationDial {
    fn uri(&self) -> String {
        self.address.of_socket(&self.path)
    }

    fn dial(&self) -> Result<Box<dyn ByteStream>, String> {
        let stream = Stream::connect(&self.address, self.trusted, PATIENCE);
        Ok(Box::new(stream.map_err(explain)?))
    }
}

/// Reason why a station cannot be reached, with a remedy.
fn explain(fault: Fault) -> String {
    match fault {
        Fault::Unreachable { source, .. } | Fault::Lost { source, .. } => {
            format!("is `rafcon station` running there, and its port open for TCP? ({source})")
        }
        Fault::Changed { known, seen, .. } => format!(
            "its certificate is another one, so nothing was sent: another computer may be listening in\n  \
             expected: {known}\n  received: {seen}\n\
             If that is what `rafcon station` prints there, name it once with --station-fingerprint {}",
            seen.hex()
        ),
        fault => format!("{:#}", anyhow::Error::from(fault)),
    }
}

impl ByteStream for Stream {
    fn socket(&self) -> &TcpStream {
        Self::socket(self)
    }
}

/// The certificate of a station.
#[derive(Debug)]
pub(super) struct StationTls(pub(super) Arc<ServerConfig>);

impl Secure for StationTls {
    fn secure(&self, mut stream: TcpStream) -> io::Result<Box<dyn ByteStream>> {
        let mut tls = ServerConnection::new(Arc::clone(&self.0)).map_err(io::Error::other)?;
        while tls.is_handshaking() {
            tls.complete_io(&mut stream)?;
        }
        Ok(Box::new(TlsStream(StreamOwned::new(tls, stream))))
    }
}

struct TlsStream(StreamOwned<ServerConnection, TcpStream>);

impl ByteStream for TlsStream {
    fn socket(&self) -> &TcpStream {
        self.0.get_ref()
    }
}

impl Read for TlsStream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl Write for TlsStream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
