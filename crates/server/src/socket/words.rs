//! Frames as text. Knows how they are spelled; must never know when they are sent.

use crate::Failure;
use rafcon_protocol::api::RunNow;
use rafcon_protocol::socket::ToClient;
use serde::Serialize;

/// A frame as it travels.
pub(super) fn text(frame: &ToClient) -> String {
    spelled(frame)
}

/// How a run stands. Spelled as [`ToClient::RunStatus`] is.
pub(super) fn run_status(subscription: u32, status: &RunNow) -> String {
    #[derive(Serialize)]
    struct Frame<'s> {
        frame: &'static str,
        subscription: u32,
        status: &'s RunNow,
    }
    spelled(&Frame { frame: "run_status", subscription, status })
}

fn spelled(frame: &impl Serialize) -> String {
    serde_json::to_string(frame).unwrap_or_else(|error| {
        let message = format!("a frame could not be put into JSON, which is a defect: {error}");
        let refusal = serde_json::json!({ "code": "no_json", "message": message });
        serde_json::json!({ "frame": "refused", "id": null, "refusal": refusal }).to_string()
    })
}

/// A command, an edit or a frame was refused.
pub(super) fn refused(id: Option<String>, failure: &Failure) -> ToClient {
    ToClient::Refused { id, refusal: failure.refusal() }
}

/// Nothing more will come of a subscription.
pub(super) fn ended(subscription: u32, failure: Option<&Failure>) -> ToClient {
    ToClient::Ended { subscription, refusal: failure.map(Failure::refusal) }
}

/// Events of a run, which are text already. Spelled as [`ToClient::Events`] is.
pub(super) fn events(subscription: u32, next: u64, events: &[impl AsRef<str>]) -> String {
    let length: usize = events.iter().map(|event| event.as_ref().len() + 1).sum();
    let mut text = String::with_capacity(length + 80);
    text.push_str(&format!(
        r#"{{"frame":"events","subscription":{subscription},"next":{next},"events":["#
    ));
    for (index, event) in events.iter().enumerate() {
        if index > 0 {
            text.push(',');
        }
        text.push_str(event.as_ref());
    }
    text.push_str("]}");
    text
}

#[cfg(test)]
mod tests {
    use super::{events, text};
    use rafcon_protocol::Event;
    use rafcon_protocol::api::HistoryEntry;
    use rafcon_protocol::socket::ToClient;

    fn check(entries: Vec<HistoryEntry>) {
        let texts: Vec<String> =
            entries.iter().map(|entry| serde_json::to_string(entry).unwrap()).collect();
        let next = entries.last().map_or(1, |entry| entry.sequence + 1);
        let frame = ToClient::Events { subscription: 7, next, events: entries };
        assert_eq!(events(7, next, &texts), text(&frame));
    }

    #[test]
    fn events_that_are_put_together_are_spelled_as_the_frame_is() {
        let entry = |sequence| {
            let event = Event::Paused { paused: sequence == 1 };
            HistoryEntry { sequence, t_ns: 10 * sequence, event }
        };
        check(Vec::new());
        check(vec![entry(1)]);
        check(vec![entry(1), entry(2), entry(3)]);
    }
}
