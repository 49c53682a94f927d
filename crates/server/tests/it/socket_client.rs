//! A client of the WebSocket that sends and receives frames in order. Only this module knows how to connect.

use crate::harness::TestServer;
use rafcon_protocol::api::Role;
use serde_json::{Value, json};
use std::net::TcpStream;
use std::time::Duration;
use tungstenite::client::IntoClientRequest as _;
use tungstenite::{Message, WebSocket};

/// Longer than any reply takes on any computer.
const TEST_TIMEOUT: Duration = Duration::from_mins(1);

/// A connection of a client.
pub(crate) struct Client {
    socket: WebSocket<TcpStream>,
}

impl Client {
    /// Connects as the user with this role, and receives the welcome.
    pub(crate) fn connect(server: &TestServer, role: Role) -> Self {
        let mut client = Self::with(server, server.token(role));
        assert_eq!(client.hear()["frame"], "welcome");
        client
    }

    /// Connects with this token, without receiving a frame.
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

    /// Starts a subscription.
    pub(crate) fn subscribe(&mut self, subscription: u32, topic: &Value) {
        self.say(&json!({ "frame": "subscribe", "subscription": subscription, "topic": topic }));
    }

    /// Receives the next frame.
    pub(crate) fn hear(&mut self) -> Value {
        self.hear_or_end().unwrap_or_else(|end| panic!("{end}"))
    }

    /// Receives the next frame. `Err` describes the end of the connection.
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

    /// Receives frames up to the first one that fits.
    pub(crate) fn hear_until(&mut self, is_it: impl Fn(&Value) -> bool) -> Vec<Value> {
        let mut heard = vec![self.hear()];
        while !heard.last().is_some_and(&is_it) {
            heard.push(self.hear());
        }
        heard
    }

    /// Receives all events up to the end of a subscription.
    pub(crate) fn events(&mut self) -> Vec<Value> {
        let frames = self.hear_until(|frame| frame["frame"] == "ended");
        let frames = frames.iter().filter(|frame| frame["frame"] == "events");
        frames.flat_map(|frame| frame["events"].as_array().unwrap().clone()).collect()
    }
}

/// The topic for the history of a run from an event on.
pub(crate) fn history(run: &str, from: u64, values: bool) -> Value {
    json!({ "topic": "run_history", "run": run, "from": from, "values": values })
}
