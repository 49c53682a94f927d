//! `rafcon serve` in a process of its own, and the plainest client of it: requests, and frames one by one. The only place that
//! knows how the server is started and how it is spoken with; tests, figures and the long checks share it.

use anyhow::{Context as _, Result, bail, ensure};
use rafcon_protocol::socket::{ToClient, ToServer};
use serde_json::Value;
use std::io::{BufRead as _, BufReader};
use std::net::{SocketAddr, TcpStream};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Duration;
use tungstenite::client::{ClientRequestBuilder, client_with_config};
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket};

/// Who hears nothing for so long has found a defect.
const TEST_TIMEOUT: Duration = Duration::from_secs(30);
/// A frame may be a machine of 10,000 states.
const FRAME_MAX: usize = 256 * 1024 * 1024;

/// A server, until dropped; then it is killed.
#[derive(Debug)]
pub(crate) struct Served {
    child: Child,
    door: Door,
    /// Open for as long as the server may write there.
    _stdout: BufReader<ChildStdout>,
}

/// Where a server is, and what lets in.
#[derive(Debug, Clone)]
pub(crate) struct Door {
    pub(crate) address: SocketAddr,
    pub(crate) token: String,
}

/// A WebSocket to it.
#[derive(Debug)]
pub(crate) struct Line {
    pub(crate) socket: WebSocket<TcpStream>,
}

impl Served {
    /// Starts it and waits until it listens.
    pub(crate) fn start(mut serve: Command) -> Result<Self> {
        let mut child = serve.stdin(Stdio::null()).stdout(Stdio::piped()).spawn()?;
        let mut stdout = BufReader::new(child.stdout.take().context("no output")?);
        let door = door(&mut stdout)?;
        Ok(Self { child, door, _stdout: stdout })
    }

    pub(crate) fn door(&self) -> &Door {
        &self.door
    }

    /// The number of its process.
    pub(crate) fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Ends it as `kill -9` does.
    pub(crate) fn kill(&mut self) {
        self.child.kill().unwrap_or_default();
        self.child.wait().map(drop).unwrap_or_default();
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Reads the link that the server prints when it listens.
fn door(stdout: &mut BufReader<ChildStdout>) -> Result<Door> {
    let mut line = String::new();
    loop {
        line.clear();
        ensure!(stdout.read_line(&mut line)? > 0, "the server ended before it listened");
        let Some((_, link)) = line.split_once("http://") else { continue };
        let (address, token) =
            link.trim().split_once("/?token=").context("a link of another kind")?;
        return Ok(Door { address: address.parse()?, token: token.to_owned() });
    }
}

impl Door {
    /// Asks with this method; what is refused is an error that says why.
    pub(crate) fn ask(&self, method: &str, path: &str, body: Option<&Value>) -> Result<Value> {
        let (status, text) = self.answer(method, path, body)?;
        if !(200..300).contains(&status) {
            bail!("{method} {path}: {status} {text}");
        }
        if text.is_empty() { Ok(Value::Null) } else { Ok(serde_json::from_str(&text)?) }
    }

    /// Asks, and gives status and body.
    pub(crate) fn answer(
        &self,
        method: &str,
        path: &str,
        body: Option<&Value>,
    ) -> Result<(u16, String)> {
        let request = ureq::http::Request::builder()
            .method(method)
            .uri(format!("http://{}{path}", self.address))
            .header("Authorization", format!("Bearer {}", self.token))
            .header("Content-Type", "application/json")
            .body(body.map(Value::to_string).unwrap_or_default())?;
        let config = ureq::Agent::config_builder().http_status_as_error(false);
        let agent: ureq::Agent = config.timeout_global(Some(TEST_TIMEOUT)).build().into();
        let response = agent.run(request)?;
        let status = response.status().as_u16();
        let body = response.into_body().into_with_config().limit(u64::MAX).read_to_string()?;
        Ok((status, body))
    }

    /// A WebSocket that has been welcomed.
    pub(crate) fn line(&self) -> Result<Line> {
        let stream = TcpStream::connect(self.address)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(TEST_TIMEOUT))?;
        let address = format!("ws://{}/api/v1/socket", self.address).parse()?;
        let request = ClientRequestBuilder::new(address)
            .with_header("Authorization", format!("Bearer {}", self.token));
        let config = WebSocketConfig::default()
            .max_message_size(Some(FRAME_MAX))
            .max_frame_size(Some(FRAME_MAX));
        let (socket, _) = client_with_config(request, stream, Some(config))
            .map_err(|error| anyhow::anyhow!("no WebSocket: {error}"))?;
        let mut line = Line { socket };
        match line.hear()? {
            ToClient::Welcome { .. } => Ok(line),
            other => bail!("welcomed by {other:?}"),
        }
    }
}

impl Line {
    pub(crate) fn say(&mut self, frame: &ToServer) -> Result<()> {
        Ok(self.socket.send(Message::text(serde_json::to_string(frame)?))?)
    }

    /// The next frame.
    pub(crate) fn hear(&mut self) -> Result<ToClient> {
        let text = self.hear_text()?;
        serde_json::from_str(&text).with_context(|| format!("a frame that makes no sense: {text}"))
    }

    /// The same as it travels.
    pub(crate) fn hear_text(&mut self) -> Result<String> {
        loop {
            if let Message::Text(text) = self.socket.read()? {
                return Ok(text.as_str().to_owned());
            }
        }
    }
}
