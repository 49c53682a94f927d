//! Requests and responses. Knows HTTP and JSON, but not the purpose of a request.

use super::{Address, Fault, Fingerprint, Stream};
use rafcon_protocol::api::Refusal;
use serde::de::DeserializeOwned;
use std::fmt;
use std::io::{Read, Write as _};
use std::time::Duration;
use ureq::http::{Request, Response};
use ureq::unversioned::resolver::DefaultResolver;
use ureq::unversioned::transport::{
    Buffers, ConnectionDetails, Connector, LazyBuffers, NextTimeout, Transport,
};
use ureq::{Agent, Body};

/// Response timeout. It is long because a server responds to the start of a run after the machine is loaded.
const RESPONSE_TIMEOUT: Duration = Duration::from_mins(2);
/// Maximum size of a response, in bytes. A machine of 100,000 states is among the largest.
const ANSWER_MAX: u64 = 512 * 1024 * 1024;

/// HTTP client for one server.
#[derive(Clone)]
pub(super) struct Http {
    address: Address,
    agent: Agent,
}

impl fmt::Debug for Http {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Http({})", self.address)
    }
}

impl Http {
    /// A client for the server at this address with this certificate.
    pub(super) fn new(address: &Address, trusted: Option<Fingerprint>) -> Self {
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(0)
            .max_idle_connections(0)
            .proxy(None)
            .user_agent(concat!("rafcon/", env!("CARGO_PKG_VERSION")))
            .build();
        let door = HttpConnector { address: address.clone(), trusted };
        Self {
            address: address.clone(),
            agent: Agent::with_parts(config, door, DefaultResolver::default()),
        }
    }

    /// Sends a request and reads the response.
    pub(super) fn ask<T: DeserializeOwned>(
        &self,
        request: Request<Vec<u8>>,
    ) -> Result<Answer<T>, Fault> {
        let mut response = self.agent.run(request).map_err(|error| self.fault(error))?;
        let cookies = cookies(&response);
        let body = self.body(&mut response, ANSWER_MAX)?;
        let status = response.status();
        if !status.is_success() {
            return Err(refused(status.as_u16(), &body));
        }
        let body = if body.is_empty() { b"null" } else { body.as_slice() };
        let body = serde_json::from_slice(body).map_err(|error| self.nonsense(&error))?;
        Ok(Answer { body, cookies })
    }

    /// Sends a request and returns the response as a stream.
    pub(super) fn open(&self, request: Request<Vec<u8>>) -> Result<impl Read + use<>, Fault> {
        let mut response = self.agent.run(request).map_err(|error| self.fault(error))?;
        let status = response.status();
        if !status.is_success() {
            return Err(refused(status.as_u16(), &self.body(&mut response, ANSWER_MAX)?));
        }
        Ok(response.into_body().into_reader())
    }

    /// Reads the body of a response of at most `max` bytes.
    fn body(&self, response: &mut Response<Body>, max: u64) -> Result<Vec<u8>, Fault> {
        let body = response.body_mut().with_config().limit(max).read_to_vec();
        body.map_err(|error| match error {
            ureq::Error::BodyExceedsLimit(_) => {
                self.nonsense(&format!("the answer has more than {max} bytes"))
            }
            error => self.fault(error),
        })
    }

    fn nonsense(&self, error: &impl ToString) -> Fault {
        Fault::Nonsense { server: self.address.to_string(), what: error.to_string() }
    }

    fn fault(&self, error: ureq::Error) -> Fault {
        match error {
            ureq::Error::Other(error) => match error.downcast::<Fault>() {
                Ok(fault) => *fault,
                Err(error) => self.nonsense(&error),
            },
            ureq::Error::Io(source) => Fault::Lost { server: self.address.to_string(), source },
            error @ (ureq::Error::Timeout(_)
            | ureq::Error::ConnectionFailed
            | ureq::Error::Protocol(_)) => {
                let source = std::io::Error::other(error);
                Fault::Lost { server: self.address.to_string(), source }
            }
            ureq::Error::HostNotFound => {
                let source = std::io::Error::other("no computer has this name");
                Fault::Unreachable { server: self.address.to_string(), source }
            }
            error => self.nonsense(&error),
        }
    }
}

/// Body and cookies of a successful response.
#[derive(Debug)]
pub(super) struct Answer<T> {
    /// Content of the response.
    pub(super) body: T,
    /// Cookies of the response, in the form for the next request.
    pub(super) cookies: String,
}

fn cookies<T>(response: &Response<T>) -> String {
    let set = response.headers().get_all("set-cookie").iter();
    let pairs = set.filter_map(|value| value.to_str().ok()?.split(';').next());
    pairs.collect::<Vec<_>>().join("; ")
}

/// The server's refusal. A proxy in between may send another format.
fn refused(status: u16, body: &[u8]) -> Fault {
    let refusal = serde_json::from_slice(body).unwrap_or_else(|_other_words| Refusal {
        code: "other".to_owned(),
        message: format!("the server refused with HTTP status {status} and gave no reason"),
    });
    Fault::Refused { status, refusal }
}

/// Opens connections with this program's own stream.
#[derive(Debug)]
struct HttpConnector {
    address: Address,
    trusted: Option<Fingerprint>,
}

impl Connector for HttpConnector {
    type Out = HttpTransport;

    fn connect(
        &self,
        details: &ConnectionDetails<'_>,
        _chained: Option<()>,
    ) -> Result<Option<HttpTransport>, ureq::Error> {
        let stream = Stream::connect(&self.address, self.trusted, RESPONSE_TIMEOUT)
            .map_err(|fault| ureq::Error::Other(Box::new(fault)))?;
        let config = details.config;
        let buffers = LazyBuffers::new(config.input_buffer_size(), config.output_buffer_size());
        Ok(Some(HttpTransport { stream, buffers }))
    }
}

/// A connection for requests; its timeouts are those of the socket.
#[derive(Debug)]
struct HttpTransport {
    stream: Stream,
    buffers: LazyBuffers,
}

impl Transport for HttpTransport {
    fn buffers(&mut self) -> &mut dyn Buffers {
        &mut self.buffers
    }

    fn transmit_output(&mut self, amount: usize, _: NextTimeout) -> Result<(), ureq::Error> {
        self.stream.write_all(&self.buffers.output()[..amount])?;
        self.stream.flush()?;
        Ok(())
    }

    fn await_input(&mut self, _: NextTimeout) -> Result<bool, ureq::Error> {
        let read = self.stream.read(self.buffers.input_append_buf())?;
        self.buffers.input_appended(read);
        Ok(read > 0)
    }

    fn is_open(&mut self) -> bool {
        false
    }

    fn is_tls(&self) -> bool {
        matches!(self.stream, Stream::Tls(_))
    }
}

#[cfg(test)]
mod tests {
    use super::{Address, Http};
    use std::io::{Read as _, Write as _};
    use std::net::TcpListener;
    use std::thread;
    use ureq::http::Request;

    #[test]
    fn of_an_answer_that_is_too_long_no_more_than_the_bound_is_read() {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let url = format!("http://{}", listener.local_addr().unwrap());
        let serve = move || {
            for _ in 0..2 {
                let (mut socket, _) = listener.accept().unwrap();
                assert_ne!(socket.read(&mut [0; 4096]).unwrap(), 0);
                // The client may disconnect before all is written.
                drop(socket.write_all(b"HTTP/1.1 200 OK\r\nContent-Length: 9\r\n\r\n123456789"));
            }
        };
        let server = thread::Builder::new().spawn(serve).unwrap();
        let http = Http::new(&Address::parse(&url).unwrap().0, None);
        let ask = |max| {
            let mut response =
                http.agent.run(Request::get(&url).body(Vec::new()).unwrap()).unwrap();
            http.body(&mut response, max).map_err(|fault| fault.to_string())
        };
        assert_eq!(ask(10).as_deref(), Ok(&b"123456789"[..]));
        assert!(ask(8).unwrap_err().ends_with("the answer has more than 8 bytes"));
        server.join().unwrap();
    }
}
