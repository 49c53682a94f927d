//! Hearing what viewers say, whatever the runner does meanwhile: whether it is there and its engine takes inputs is said at once,
//! the rest is handed on. Never waits for the interpreter, and for the engine only briefly; must never know what a command does.

use crate::Clock;
use crate::viewers::connection::{IncomingLine, Receiver, Sender};
use rafcon_protocol::{EnginePulse, ToRunner, ToViewer, decode};
use std::sync::mpsc::{self, SyncSender};

/// So many words of one viewer wait for their turn; then it is not listened to.
const WAITING: usize = 64;

/// The way of a viewer's words from whoever hears them to whoever heeds them.
pub(crate) fn way() -> (SyncSender<IncomingLine>, mpsc::Receiver<IncomingLine>) {
    mpsc::sync_channel(WAITING)
}

/// Hears one viewer until it goes away, or nobody heeds it any more; `pulse` asks for the engine.
pub(crate) fn hear(
    mut receiver: Receiver,
    sender: &Sender,
    rest: &SyncSender<IncomingLine>,
    pulse: impl Fn() -> EnginePulse,
) {
    while let Some(words) = receiver.line() {
        match ping(&words) {
            Some(id) => {
                let engine = Some(pulse());
                sender.send(&ToViewer::Pong { id, now_ms: Clock::epoch_ms(), engine });
            }
            None if rest.send(words).is_err() => return,
            None => {}
        }
    }
}

fn ping(words: &IncomingLine) -> Option<u64> {
    let IncomingLine::Text(text) = words else { return None };
    match decode(text) {
        Ok(ToRunner::Ping { id }) => Some(id),
        _ => None,
    }
}
