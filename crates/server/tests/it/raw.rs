//! Requests byte by byte, including those that no regular client sends.

use crate::harness::TestServer;
use rustix::net::{AddressFamily, SocketType, bind, connect, socket};
use serde_json::Value;
use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

/// Far longer than any response takes. A test fails instead of hanging.
const TEST_TIMEOUT: Duration = Duration::from_secs(15);

/// A connection that sends arbitrary bytes.
pub(crate) struct Raw(TcpStream);

impl Raw {
    pub(crate) fn to(server: &TestServer) -> Self {
        Self::over(TcpStream::connect(server.address()).unwrap())
    }

    /// Connects from another address of this computer.
    pub(crate) fn from(ip: [u8; 4], server: &TestServer) -> Self {
        let socket = socket(AddressFamily::INET, SocketType::STREAM, None).unwrap();
        bind(&socket, &SocketAddr::from((ip, 0))).unwrap();
        connect(&socket, &server.address()).unwrap();
        Self::over(TcpStream::from(socket))
    }

    fn over(stream: TcpStream) -> Self {
        stream.set_read_timeout(Some(TEST_TIMEOUT)).unwrap();
        stream.set_write_timeout(Some(TEST_TIMEOUT)).unwrap();
        Self(stream)
    }

    /// Sends bytes. Returns `true` if they were accepted.
    pub(crate) fn say(&mut self, bytes: impl AsRef<[u8]>) -> bool {
        self.0.write_all(bytes.as_ref()).is_ok()
    }

    /// All remaining output of the server until it closes or breaks the connection.
    pub(crate) fn rest(mut self) -> String {
        let (mut bytes, mut part) = (Vec::new(), [0; 4096]);
        while let Ok(count @ 1..) = self.0.read(&mut part) {
            bytes.extend_from_slice(&part[..count]);
        }
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// True if the server has sent unread data.
    pub(crate) fn has_answer(&self) -> bool {
        self.0.set_nonblocking(true).unwrap();
        let count = self.0.peek(&mut [0; 1]);
        self.0.set_nonblocking(false).unwrap();
        matches!(count, Ok(1))
    }

    /// Skips the body that this head announces.
    pub(crate) fn skip_body(&mut self, head: &str) {
        let mut lines = head.lines().filter_map(|line| line.strip_prefix("content-length: "));
        let length = lines.next().map_or(0, |length| length.trim().parse().unwrap());
        self.0.read_exact(&mut vec![0; length]).unwrap();
    }

    /// The next head on a connection that stays open.
    pub(crate) fn head(&mut self) -> String {
        let (mut bytes, mut one) = (Vec::new(), [0; 1]);
        while !bytes.ends_with(b"\r\n\r\n") && matches!(self.0.read(&mut one), Ok(1)) {
            bytes.push(one[0]);
        }
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

/// The status of a login from another address of this computer.
pub(crate) fn login_from(ip: [u8; 4], server: &TestServer, login: &Value) -> u16 {
    let mut raw = Raw::from(ip, server);
    raw.say(log_in(server, login));
    status(&raw.rest())
}

/// The request to log in.
pub(crate) fn log_in(server: &TestServer, login: &Value) -> String {
    let text = login.to_string();
    format!(
        "POST /api/v1/session HTTP/1.1\r\nHost: {}\r\nConnection: close\r\nContent-Type: application/json\r\n\
         Content-Length: {}\r\n\r\n{text}",
        server.address(),
        text.len()
    )
}

/// The status in a response. 0 without a response.
pub(crate) fn status(text: &str) -> u16 {
    text.split(' ').nth(1).and_then(|word| word.parse().ok()).unwrap_or_default()
}

/// Sends a request with these header lines and returns the response.
pub(crate) fn ask(server: &TestServer, line: &str, head: &[(&str, &str)]) -> String {
    let mut raw = Raw::to(server);
    let head = head.iter().map(|(name, value)| format!("{name}: {value}\r\n"));
    raw.say(format!("{line} HTTP/1.1\r\n{}Connection: close\r\n\r\n", head.collect::<String>()));
    raw.rest()
}
