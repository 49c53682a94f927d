//! A client of the WebSocket that says frames and hears them, one after the other. The only place that knows how one is made.

use crate::harness::TestServer;
use rafcon_protocol::api::Role;
use serde_json::{Value, json};
use std::net::TcpStream;
use std::time::Duration;
use tungstenite::client::IntoClientRequest as _;
use tungstenite::{Message, WebSocket};

/// Longer than any answer takes on any computer.
const TEST_TIMEOUT: Duration = Duration::from_mins(1);

/// One connection.
pub(crate) struct Client {
    socket: WebSocket<TcpStream>,
}

impl Client {
    /// Connects as someone with this role, and hears the welcome.
    pub(crate) fn connect(server: &TestServer, role: Role) -> Self {
        let mut client = Self::with(server, server.token(role));
        assert_eq!(client.hear()["frame"], "welcome");
        client
    }

    /// Connects with this token and hears nothing yet.
    pub(crate) fn with(server: &TestServer, token: &str) -> Self {
        let stream = TcpStream::connect(server.address()).unwrap();
        stream.set_read_timeout(Some(TEST_TIMEOUT)).unwrap();
        let address = server.url().replace("http://", "ws://") + "/api/v1/socket";
        let mut request = address.into_client_request().unwrap();
        let token = format!("Bearer {token}").parse().unwrap();
        request.headers_mut().insert("authorization", token);
        let (socket, _response) = tungstenite::client(request, stream).unwrap();
        Self { socket }
    }

    pub(crate) fn say(&mut self, frame: &Value) {
        self.say_message(Message::text(frame.to_string()));
    }

    pub(crate) fn say_message(&mut self, message: Message) {
        self.socket.send(message).unwrap();
    }

    /// Follows something.
    pub(crate) fn subscribe(&mut self, subscription: u32, topic: &Value) {
        self.say(&json!({ "frame": "subscribe", "subscription": subscription, "topic": topic }));
    }

    /// The next frame.
    pub(crate) fn hear(&mut self) -> Value {
        self.hear_or_end().unwrap_or_else(|end| panic!("{end}"))
    }

    /// The next frame, or how the connection ended.
    pub(crate) fn hear_or_end(&mut self) -> Result<Value, String> {
        loop {
            match self.socket.read() {
                Ok(Message::Text(text)) => return Ok(serde_json::from_str(&text).unwrap()),
                Ok(Message::Close(Some(close))) => {
                    return Err(format!("{} {}", u16::from(close.code), close.reason));
                }
                Ok(_) => {}
                Err(error) => return Err(error.to_string()),
            }
        }
    }

    /// The frames up to the first of which this is true.
    pub(crate) fn hear_until(&mut self, is_it: impl Fn(&Value) -> bool) -> Vec<Value> {
        let mut heard = vec![self.hear()];
        while !heard.last().is_some_and(&is_it) {
            heard.push(self.hear());
        }
        heard
    }

    /// Numbers of all events up to the end of a subscription.
    pub(crate) fn events(&mut self) -> Vec<Value> {
        let frames = self.hear_until(|frame| frame["frame"] == "ended");
        let frames = frames.iter().filter(|frame| frame["frame"] == "events");
        frames.flat_map(|frame| frame["events"].as_array().unwrap().clone()).collect()
    }
}

/// The history of a run from an event on.
pub(crate) fn history(run: &str, from: u64, values: bool) -> Value {
    json!({ "topic": "run_history", "run": run, "from": from, "values": values })
}
