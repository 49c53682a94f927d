//! The server's WebSocket as frames. Reads and writes do not block; only [`Socket::wait`] does.

use super::{Address, Fault, Stream};
use rafcon_protocol::api::Refusal;
use rafcon_protocol::socket::{ToClient, ToServer};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use std::io;
use std::os::fd::AsFd;
use std::time::Duration;
use tungstenite::client::{ClientRequestBuilder, client_with_config};
use tungstenite::handshake::HandshakeError;
use tungstenite::http::Response;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Error, Message, WebSocket};

const PATH: &str = "/api/v1/socket";
/// Maximum size of a frame, in bytes; a revision of a machine may be long.
const FRAME_MAX: usize = 256 * 1024 * 1024;

/// Reason of a broken connection.
pub(super) type Broken = String;

/// A WebSocket whose reads and writes never block.
#[derive(Debug)]
pub(super) struct Socket {
    socket: WebSocket<Stream>,
    /// True if data is still to be written.
    is_full: bool,
}

impl Socket {
    /// Upgrades the connection to a WebSocket.
    pub(super) fn open(
        stream: Stream,
        address: &Address,
        token: Option<&str>,
    ) -> Result<Self, Fault> {
        let nonsense = |what: String| Fault::Nonsense { server: address.to_string(), what };
        let uri = address.of_socket(PATH).parse();
        let uri = uri.map_err(|error| nonsense(format!("cannot find its address: {error}")))?;
        let mut request = ClientRequestBuilder::new(uri);
        if let Some(token) = token {
            request = request.with_header("Authorization", format!("Bearer {token}"));
        }
        let config = WebSocketConfig::default()
            .max_message_size(Some(FRAME_MAX))
            .max_frame_size(Some(FRAME_MAX));
        let (socket, _response) = client_with_config(request, stream, Some(config))
            .map_err(|error| fault(address, error))?;
        socket
            .get_ref()
            .socket()
            .set_nonblocking(true)
            .map_err(|source| Fault::Unreachable { server: address.to_string(), source })?;
        Ok(Self { socket, is_full: false })
    }

    /// Sends a frame. Data beyond the capacity of the socket is written later.
    pub(super) fn say(&mut self, frame: &ToServer) -> Result<(), Broken> {
        let text = serde_json::to_string(frame).map_err(|error| error.to_string())?;
        let written = self.socket.write(Message::text(text));
        self.full(written)?;
        self.flush()
    }

    /// Writes pending data, as much as the socket accepts.
    pub(super) fn flush(&mut self) -> Result<(), Broken> {
        let flushed = self.socket.flush();
        self.is_full = false;
        self.full(flushed)
    }

    fn full(&mut self, written: Result<(), Error>) -> Result<(), Broken> {
        match written {
            Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => {
                self.is_full = true;
                Ok(())
            }
            written => written.map_err(|error| words(&error)),
        }
    }

    /// The next received frame; `None` if no frame has arrived yet.
    pub(super) fn next(&mut self) -> Result<Option<ToClient>, Broken> {
        loop {
            match self.socket.read() {
                Ok(Message::Text(text)) => {
                    let frame = serde_json::from_str(&text);
                    return frame.map(Some).map_err(|error| {
                        let start: String = text.chars().take(120).collect();
                        format!("cannot understand the frame of the server ({error}): {start}")
                    });
                }
                Ok(_) => {}
                Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => {
                    return Ok(None);
                }
                Err(error) => return Err(words(&error)),
            }
        }
    }

    /// Waits until data can be read or pending data written, `wake` is readable, or the time is over.
    pub(super) fn wait(&self, wake: &impl AsFd, time: Duration) -> io::Result<()> {
        let more = if self.is_full { PollFlags::OUT } else { PollFlags::empty() };
        let socket = self.socket.get_ref().socket();
        let mut wanted =
            [PollFd::new(socket, PollFlags::IN | more), PollFd::new(wake, PollFlags::IN)];
        let time = Timespec::try_from(time).map_err(io::Error::other)?;
        match poll(&mut wanted, Some(&time)) {
            Ok(_) | Err(Errno::INTR) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }
}

fn words(error: &Error) -> Broken {
    match error {
        Error::ConnectionClosed | Error::AlreadyClosed => {
            "the server closed the connection".to_owned()
        }
        Error::Io(error) => error.to_string(),
        error => error.to_string(),
    }
}

fn fault(
    address: &Address,
    error: HandshakeError<tungstenite::handshake::client::ClientHandshake<Stream>>,
) -> Fault {
    let server = address.to_string();
    match error {
        HandshakeError::Interrupted(_) => {
            Fault::Unreachable { server, source: io::ErrorKind::TimedOut.into() }
        }
        HandshakeError::Failure(Error::Http(response)) => refused(&response),
        HandshakeError::Failure(Error::Io(source)) => Fault::Unreachable { server, source },
        HandshakeError::Failure(
            error @ (Error::ConnectionClosed | Error::AlreadyClosed | Error::Protocol(_)),
        ) => Fault::Unreachable { server, source: io::Error::other(error) },
        HandshakeError::Failure(error) => Fault::Nonsense { server, what: error.to_string() },
    }
}

fn refused(response: &Response<Option<Vec<u8>>>) -> Fault {
    let status = response.status().as_u16();
    let body = response.body().as_deref().unwrap_or_default();
    let refusal = serde_json::from_slice(body).unwrap_or_else(|_not_all_of_it| Refusal {
        code: "other".to_owned(),
        message: format!("the server refused the WebSocket with HTTP status {status}"),
    });
    Fault::Refused { status, refusal }
}

#[cfg(test)]
mod tests {
    use super::{Address, FRAME_MAX, Socket, Stream};
    use std::io::Write as _;
    use std::net::{TcpListener, TcpStream};
    use std::thread;

    #[test]
    fn a_frame_that_would_be_too_long_ends_the_connection_before_it_is_read() {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let at = listener.local_addr().unwrap();
        let serve = move || {
            let (socket, _) = listener.accept().unwrap();
            let mut socket = tungstenite::accept(socket).unwrap();
            // Header of a text frame longer than the limit, by RFC 6455, section 5.2.
            let length = u64::try_from(FRAME_MAX + 1).unwrap().to_be_bytes();
            socket.get_mut().write_all(&[&[0x81, 127][..], &length].concat()).unwrap();
            // Wait until the client disconnects.
            drop(socket.read());
        };
        let server = thread::Builder::new().spawn(serve).unwrap();
        let address = Address::parse(&format!("http://{at}")).unwrap().0;
        let stream = Stream::Plain(TcpStream::connect(at).unwrap());
        let mut socket = Socket::open(stream, &address, None).unwrap();
        let broken = loop {
            match socket.next() {
                Ok(None) => {}
                Ok(Some(frame)) => panic!("{frame:?}"),
                Err(broken) => break broken,
            }
        };
        assert!(broken.contains("too long") || broken.contains("too large"), "{broken}");
        drop(socket);
        server.join().unwrap();
    }
}
