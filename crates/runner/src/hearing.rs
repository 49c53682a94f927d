//! Hearing what viewers say, whatever the runner does meanwhile: that it is there is said at once, the rest is handed on. Waits
//! neither for the engine nor for the interpreter; must never know what a command does.

use crate::Clock;
use crate::connection::{Receiver, Sender, Words};
use rafcon_protocol::{ToRunner, ToViewer, decode};
use std::sync::mpsc::{self, SyncSender};

/// So many words of one viewer wait for their turn; then it is not listened to.
const WAITING: usize = 64;

/// The way of a viewer's words from whoever hears them to whoever heeds them.
pub(crate) fn way() -> (SyncSender<Words>, mpsc::Receiver<Words>) {
    mpsc::sync_channel(WAITING)
}

/// Hears one viewer until it goes away, or nobody heeds it any more.
pub(crate) fn hear(mut receiver: Receiver, sender: &Sender, rest: &SyncSender<Words>) {
    while let Some(words) = receiver.line() {
        match ping(&words) {
            Some(id) => sender.send(&ToViewer::Pong { id, now_ms: Clock::epoch_ms() }),
            None if rest.send(words).is_err() => return,
            None => {}
        }
    }
}

fn ping(words: &Words) -> Option<u64> {
    let Words::Text(text) = words else { return None };
    match decode(text) {
        Ok(ToRunner::Ping { id }) => Some(id),
        _ => None,
    }
}
