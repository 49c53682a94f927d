//! Parses a client's frames: one frame in, one request out. Pure: knows frames, numbers of subscriptions and rights; does not
//! know connections, runs or machines.

use super::words::{ended, refused};
use crate::Failure;
use crate::access::{Who, of_frame};
use crate::documents::Operation;
use rafcon_protocol::Envelope;
use rafcon_protocol::socket::{ToClient, ToServer, Topic, VERSION};
use std::collections::BTreeSet;

/// Maximum number of subscriptions per connection.
pub(super) const SUBSCRIPTIONS_MAX: usize = 64;
/// Maximum number of selected states.
const SELECTION_MAX: usize = 1000;
/// Maximum size of their paths together, in bytes.
const SELECTION_BYTES_MAX: usize = 64 << 10;

/// The action for a frame.
#[derive(Debug)]
pub(super) enum ClientRequest {
    /// Send this frame to the client.
    Tell(ToClient),
    /// Start a subscription with this number.
    Begin(u32, Topic),
    /// Cancel a subscription, and confirm that to the client.
    GiveUp(u32),
    /// Execute a command for a run.
    Command {
        /// Id of the run.
        run: String,
        /// The command with its metadata.
        envelope: Box<Envelope>,
    },
    /// Change an open machine.
    Change {
        /// Id of the machine.
        machine: String,
        /// Id of the request.
        id: String,
        /// The change to perform.
        operation: Operation,
    },
    /// Publish the states that this client shows.
    Look {
        /// Id of the machine.
        machine: String,
        /// Paths of the selected states.
        selection: Vec<String>,
    },
}

/// The subscriptions of one client.
#[derive(Debug, Default)]
pub(super) struct Session {
    subscriptions: BTreeSet<u32>,
}

impl Session {
    /// Parses a text frame. `now_ms` is the time: ms since 1970, UTC.
    pub(super) fn hear(&mut self, text: &str, who: &Who, now_ms: u64) -> ClientRequest {
        let frame = match serde_json::from_str::<ToServer>(text) {
            Ok(frame) => frame,
            Err(error) => return ClientRequest::Tell(not_a_frame(text, &error)),
        };
        if let Err(failure) = who.must(of_frame(&frame)) {
            return ClientRequest::Tell(not_yours(&frame, &failure));
        }
        match frame {
            ToServer::Subscribe { subscription, topic } => self.subscribe(subscription, topic),
            ToServer::Unsubscribe { subscription } => {
                self.subscriptions.remove(&subscription);
                ClientRequest::GiveUp(subscription)
            }
            ToServer::Command { run, envelope } => {
                ClientRequest::Command { run, envelope: Box::new(envelope) }
            }
            ToServer::Edit { machine, edit } => {
                change(machine, edit.id.clone(), Operation::edit(edit))
            }
            ToServer::Undo { machine, undo } => change(machine, undo.id, Operation::Undo),
            ToServer::Redo { machine, redo } => change(machine, redo.id, Operation::Redo),
            ToServer::Presence { machine, selection } => look(machine, selection),
            ToServer::Ping { id } => ClientRequest::Tell(ToClient::Pong { id, now_ms }),
        }
    }

    fn subscribe(&mut self, subscription: u32, topic: Topic) -> ClientRequest {
        if self.subscriptions.contains(&subscription) {
            return ClientRequest::Tell(refused(None, &in_use(subscription)));
        }
        if self.subscriptions.len() >= SUBSCRIPTIONS_MAX {
            return ClientRequest::Tell(ended(subscription, Some(&too_many())));
        }
        self.subscriptions.insert(subscription);
        ClientRequest::Begin(subscription, topic)
    }

    /// Releases the number of a subscription that has ended.
    pub(super) fn ended(&mut self, subscription: u32) {
        self.subscriptions.remove(&subscription);
    }
}

/// The refusal of a binary frame.
pub(super) fn binary() -> ToClient {
    let message = "this was a binary frame: send each JSON object as a text frame";
    refused(None, &Failure::bad("binary_frame", message))
}

fn change(machine: String, id: String, operation: Operation) -> ClientRequest {
    ClientRequest::Change { machine, id, operation }
}

fn look(machine: String, selection: Vec<String>) -> ClientRequest {
    let bytes: usize = selection.iter().map(String::len).sum();
    if selection.len() <= SELECTION_MAX && bytes <= SELECTION_BYTES_MAX {
        return ClientRequest::Look { machine, selection };
    }
    let message = format!(
        "{} states are selected in machine {machine}, with paths of {bytes} bytes: tell of at most {SELECTION_MAX} \
         states and {SELECTION_BYTES_MAX} bytes",
        selection.len()
    );
    ClientRequest::Tell(refused(None, &Failure::bad("too_many_selected", message)))
}

fn in_use(subscription: u32) -> Failure {
    let message = format!(
        "subscription {subscription} exists already: unsubscribe it first, or choose another number"
    );
    Failure::conflict("subscription_in_use", message)
}

fn too_many() -> Failure {
    let message = format!(
        "this connection has {SUBSCRIPTIONS_MAX} subscriptions, and that is the most: give one up first"
    );
    Failure::too_many("too_many_subscriptions", message)
}

fn not_a_frame(text: &str, error: &serde_json::Error) -> ToClient {
    let beginning: String = text.chars().take(80).collect();
    let message = format!(
        "not a frame: {error}, in {beginning:?}; this server speaks version {VERSION} of the frames, which \
         docs/protocol.md lists: load the page again, or update the program"
    );
    refused(id_in(text), &Failure::bad("bad_frame", message))
}

/// The request id in a malformed frame, if any, so that its sender gets the refusal.
fn id_in(text: &str) -> Option<String> {
    let frame: serde_json::Value = serde_json::from_str(text).ok()?;
    let parts = ["envelope", "edit", "undo", "redo"];
    let id = parts.iter().find_map(|part| frame.get(part)?.get("id")?.as_str());
    id.map(str::to_owned)
}

fn not_yours(frame: &ToServer, failure: &Failure) -> ToClient {
    let id = match frame {
        ToServer::Command { envelope, .. } => Some(&envelope.id),
        ToServer::Edit { edit, .. } => Some(&edit.id),
        ToServer::Undo { undo: step, .. } | ToServer::Redo { redo: step, .. } => Some(&step.id),
        ToServer::Subscribe { .. }
        | ToServer::Unsubscribe { .. }
        | ToServer::Presence { .. }
        | ToServer::Ping { .. } => None,
    };
    refused(id.cloned(), failure)
}

#[cfg(test)]
mod tests;
