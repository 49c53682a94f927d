//! A server as this program uses it: its address, its certificate, the user's token, and its requests.
//!
//! Knows the types of `rafcon_protocol::api` and `rafcon_protocol::socket`. Does not know how they are shown to the user.

mod address;
mod fault;
mod fingerprint;
mod follow;
mod http;
mod meet;
mod notebook;
mod session;
mod socket;
mod stream;
mod token;
mod trust;

pub(crate) use address::Address;
use anyhow::Result as Outcome;
pub(crate) use fault::Fault;
pub(crate) use fingerprint::Fingerprint;
pub(crate) use follow::follow;
use http::{Answer, Http};
pub(crate) use meet::TrustDecision;
pub(crate) use notebook::CredentialStore;
use rafcon_model::Machine;
use rafcon_protocol::api::{
    CommandAnswer, Control, ControlMove, Login, MachineAt, MachineDocument, MachineFile,
    MachineSummary, Moment, NewToken, ResumeRun, RobotMachines, RunNow, RunSummary, StartAgain,
    StartRun, StartedRun, TokenMade,
};
use rafcon_protocol::document::{Document, leave};
use rafcon_protocol::{
    CommandList, ContactWindow, Envelope, ListedCommand, ReleaseList, StateData,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use socket::Socket;
use std::io::Read;
use std::time::Duration;
pub(crate) use stream::Stream;
use token::Token;
use ureq::http::{HeaderValue, Method, Request};

/// Timeout of a connection in the middle of a frame.
const FRAME_TIMEOUT: Duration = Duration::from_secs(30);

/// One server, with the credentials for its requests.
#[derive(Debug)]
pub(crate) struct Server {
    pub(crate) address: Address,
    trusted: Option<Fingerprint>,
    token: Token,
    http: Http,
}

impl Server {
    fn new(address: Address, trusted: Option<Fingerprint>, token: Token) -> Self {
        let http = Http::new(&address, trusted);
        Self { address, trusted, token, http }
    }

    /// All runs of the server.
    pub(crate) fn runs(&self) -> Result<Vec<RunSummary>, Fault> {
        self.get("/runs")
    }

    /// Starts a run, or returns the run that an earlier request with this id started.
    pub(crate) fn start(&self, request: &StartRun) -> Result<RunSummary, Fault> {
        self.send("/runs", request)
    }

    pub(crate) fn resume(&self, run: &str, request: &ResumeRun) -> Result<RunSummary, Fault> {
        self.send(&format!("/runs/{}/resume", escaped(run)), request)
    }

    /// Has a robot of a station start a machine.
    pub(crate) fn start_at(&self, robot: &str, request: &StartRun) -> Result<StartedRun, Fault> {
        self.send(&format!("/robots/{}/runs", escaped(robot)), request)
    }

    /// Starts the machine of a run as a new run.
    pub(crate) fn start_again(&self, run: &str, request: &StartAgain) -> Result<StartedRun, Fault> {
        self.send(&format!("/runs/{}/again", escaped(run)), request)
    }

    /// The machines in the projects of a robot of a station.
    pub(crate) fn machines(&self, robot: &str) -> Result<RobotMachines, Fault> {
        self.get(&format!("/robots/{}/machines", escaped(robot)))
    }

    /// The planned contacts with a robot of a station.
    pub(crate) fn contacts(&self, robot: &str) -> Result<Vec<ContactWindow>, Fault> {
        self.get(&format!("/robots/{}/contacts", escaped(robot)))
    }

    /// Replaces the planned contacts with a robot of a station.
    pub(crate) fn set_contacts(
        &self,
        robot: &str,
        windows: &[ContactWindow],
    ) -> Result<Vec<ContactWindow>, Fault> {
        self.put(&format!("/robots/{}/contacts", escaped(robot)), &windows)
    }

    /// The command list of a robot of a station.
    pub(crate) fn command_list(&self, robot: &str) -> Result<CommandList, Fault> {
        self.get(&format!("/robots/{}/commands", escaped(robot)))
    }

    /// Replaces the command list of a robot of a station.
    pub(crate) fn set_command_list(
        &self,
        robot: &str,
        commands: &[ListedCommand],
    ) -> Result<CommandList, Fault> {
        self.put(&format!("/robots/{}/commands", escaped(robot)), &commands)
    }

    /// Releases the command list of a robot of a station.
    pub(crate) fn release_command_list(
        &self,
        robot: &str,
        release: &ReleaseList,
    ) -> Result<CommandList, Fault> {
        self.send(&format!("/robots/{}/commands/release", escaped(robot)), release)
    }

    /// State of a run, with its snapshot.
    pub(crate) fn now(&self, run: &str) -> Result<RunNow, Fault> {
        self.get(&format!("/runs/{}", escaped(run)))
    }

    /// Sends a command to a run.
    pub(crate) fn command(&self, run: &str, envelope: &Envelope) -> Result<CommandAnswer, Fault> {
        self.send(&format!("/runs/{}/commands", escaped(run)), envelope)
    }

    /// Changes the control of a run.
    pub(crate) fn control(&self, run: &str, wanted: &ControlMove) -> Result<Control, Fault> {
        self.send(&format!("/runs/{}/control", escaped(run)), wanted)
    }

    /// The user in control of a run.
    pub(crate) fn holder(&self, run: &str) -> Result<Control, Fault> {
        self.get(&format!("/runs/{}/control", escaped(run)))
    }

    /// Data of an active state; `None` if it is not active.
    pub(crate) fn state(&self, run: &str, path: &str) -> Result<Option<StateData>, Fault> {
        let data = self.get(&format!("/runs/{}/state?path={}", escaped(run), escaped(path)));
        match data {
            Err(Fault::Refused { refusal, .. }) if refusal.code == "not_active" => Ok(None),
            data => data.map(Some),
        }
    }

    /// A moment of a run.
    pub(crate) fn moment_of_run(&self, run: &str) -> Result<Moment, Fault> {
        self.get(&format!("/runs/{}/moments", escaped(run)))
    }

    /// The machine of a run with this hash; without a hash, the machine at its start.
    pub(crate) fn machine_of_run(&self, run: &str, hash: Option<&str>) -> Outcome<Machine> {
        let query = hash.map(|hash| format!("?root={}", escaped(hash))).unwrap_or_default();
        let document: Document = self.get(&format!("/runs/{}/machine{query}", escaped(run)))?;
        Ok(document.read(&mut leave)?)
    }

    /// The machine in a folder of a project, without the content of its libraries.
    pub(crate) fn machine_in(&self, file: &MachineFile) -> Outcome<Machine> {
        let open = MachineAt { file: file.clone() };
        let summary: MachineSummary = self.send("/machines/open", &open)?;
        let whole: MachineDocument =
            self.get(&format!("/machines/{}/document", escaped(&summary.id)))?;
        Ok(whole.document.read(&mut leave)?)
    }

    /// Logs in and makes a token for this program.
    pub(crate) fn log_in(&self, login: &Login, token: &NewToken) -> Result<TokenMade, Fault> {
        let request = self.request(Method::POST, "/session", None)?;
        let answer: Answer<serde_json::Value> = self.http.ask(self.with_body(request, login)?)?;
        let mut request = self.request(Method::POST, "/tokens", None)?;
        let headers = request.headers_mut();
        headers.insert("cookie", self.value(&answer.cookies)?);
        headers.insert("origin", self.value(&self.address.origin())?);
        Ok(self.http.ask(self.with_body(request, token)?)?.body)
    }

    /// Opens a WebSocket. The token is in its request.
    fn socket(&self) -> Result<Socket, Fault> {
        let stream = Stream::connect(&self.address, self.trusted, FRAME_TIMEOUT)?;
        Socket::open(stream, &self.address, self.token.text()?.as_deref())
    }

    pub(crate) fn get<T: DeserializeOwned>(&self, path: &str) -> Result<T, Fault> {
        let token = self.token.text()?;
        Ok(self.http.ask(self.request(Method::GET, path, token.as_deref())?)?.body)
    }

    /// Opens a long response as a stream.
    pub(crate) fn open(&self, path: &str) -> Result<impl Read + use<>, Fault> {
        let token = self.token.text()?;
        let mut request = self.request(Method::GET, path, token.as_deref())?;
        // No compression: if a compressed response ends early, its last part is lost.
        request.headers_mut().insert("accept-encoding", HeaderValue::from_static("identity"));
        self.http.open(request)
    }

    pub(crate) fn send<T: DeserializeOwned>(
        &self,
        path: &str,
        body: &impl Serialize,
    ) -> Result<T, Fault> {
        let token = self.token.text()?;
        let request = self.request(Method::POST, path, token.as_deref())?;
        Ok(self.http.ask(self.with_body(request, body)?)?.body)
    }

    fn put<T: DeserializeOwned>(&self, path: &str, body: &impl Serialize) -> Result<T, Fault> {
        let token = self.token.text()?;
        let request = self.request(Method::PUT, path, token.as_deref())?;
        Ok(self.http.ask(self.with_body(request, body)?)?.body)
    }

    pub(crate) fn delete<T: DeserializeOwned>(&self, path: &str) -> Result<T, Fault> {
        let token = self.token.text()?;
        Ok(self.http.ask(self.request(Method::DELETE, path, token.as_deref())?)?.body)
    }

    fn request(
        &self,
        method: Method,
        path: &str,
        token: Option<&str>,
    ) -> Result<Request<Vec<u8>>, Fault> {
        let uri = format!("{}/api/v1{path}", self.address);
        let mut request = Request::new(Vec::new());
        *request.method_mut() = method;
        *request.uri_mut() = uri.parse().map_err(|error| self.nonsense(&error))?;
        if let Some(token) = token {
            let bearer = self.value(&format!("Bearer {token}"))?;
            request.headers_mut().insert("authorization", bearer);
        }
        Ok(request)
    }

    fn with_body(
        &self,
        mut request: Request<Vec<u8>>,
        body: &impl Serialize,
    ) -> Result<Request<Vec<u8>>, Fault> {
        *request.body_mut() = serde_json::to_vec(body).map_err(|error| self.nonsense(&error))?;
        request.headers_mut().insert("content-type", HeaderValue::from_static("application/json"));
        Ok(request)
    }

    /// The parser's error does not repeat the text, which may be a secret.
    fn value(&self, text: &str) -> Result<HeaderValue, Fault> {
        HeaderValue::from_str(text).map_err(|error| self.nonsense(&error))
    }

    fn nonsense(&self, error: &impl ToString) -> Fault {
        Fault::Nonsense { server: self.address.to_string(), what: error.to_string() }
    }
}

/// Text encoded for use in an address.
pub(crate) fn escaped(text: &str) -> String {
    let byte = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' => {
            char::from(byte).to_string()
        }
        _ => format!("%{byte:02X}"),
    };
    text.bytes().map(byte).collect()
}

#[cfg(test)]
mod tests {
    use super::escaped;

    #[test]
    fn what_means_something_in_addresses_is_written_as_numbers() {
        assert_eq!(escaped("20261121-pick_a.b~"), "20261121-pick_a.b~");
        assert_eq!(escaped("A/B ?ä%"), "A%2FB%20%3F%C3%A4%25");
    }
}
