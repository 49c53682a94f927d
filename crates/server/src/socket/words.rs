//! Serializes frames. Knows their encoding, but not their timing.

use crate::Failure;
use rafcon_protocol::api::RunNow;
use rafcon_protocol::socket::ToClient;
use serde::Serialize;

/// The JSON text of a frame.
pub(super) fn text(frame: &ToClient) -> String {
    spelled(frame)
}

/// The state of a run. Encoded like [`ToClient::RunStatus`].
pub(super) fn run_status(subscription: u32, status: &RunNow) -> String {
    #[derive(Serialize)]
    #[serde(tag = "frame", rename = "run_status")]
    struct Frame<'s> {
        subscription: u32,
        status: &'s RunNow,
    }
    spelled(&Frame { subscription, status })
}

fn spelled(frame: &impl Serialize) -> String {
    serde_json::to_string(frame).unwrap_or_else(|error| {
        let message = format!("a frame could not be put into JSON, which is a defect: {error}");
        let refusal = serde_json::json!({ "code": "no_json", "message": message });
        serde_json::json!({ "frame": "refused", "id": null, "refusal": refusal }).to_string()
    })
}

/// The refusal of a command, an edit or a frame.
pub(super) fn refused(id: Option<String>, failure: &Failure) -> ToClient {
    ToClient::Refused { id, refusal: failure.refusal() }
}

/// The end of a subscription.
pub(super) fn ended(subscription: u32, failure: Option<&Failure>) -> ToClient {
    ToClient::Ended { subscription, refusal: failure.map(Failure::refusal) }
}

/// Events of a run, already serialized. Encoded like [`ToClient::Events`].
pub(super) fn events(subscription: u32, next: u64, events: &[impl AsRef<str>]) -> String {
    let head =
        format!(r#"{{"frame":"events","subscription":{subscription},"next":{next},"events":["#);
    list(&head, events)
}

/// Revisions of a machine, already serialized. Encoded like [`ToClient::Revisions`].
pub(super) fn revisions(subscription: u32, revisions: &[impl AsRef<str>]) -> String {
    let head = format!(r#"{{"frame":"revisions","subscription":{subscription},"revisions":["#);
    list(&head, revisions)
}

fn list(head: &str, items: &[impl AsRef<str>]) -> String {
    let length: usize = items.iter().map(|item| item.as_ref().len() + 1).sum();
    let mut text = String::with_capacity(head.len() + length + 2);
    text.push_str(head);
    for (index, item) in items.iter().enumerate() {
        if index > 0 {
            text.push(',');
        }
        text.push_str(item.as_ref());
    }
    text.push_str("]}");
    text
}

#[cfg(test)]
mod tests {
    use super::{events, revisions, text};
    use rafcon_protocol::Event;
    use rafcon_protocol::api::{HistoryEntry, Revision, RevisionKind};
    use rafcon_protocol::socket::ToClient;

    fn check(entries: Vec<HistoryEntry>) {
        let texts: Vec<String> =
            entries.iter().map(|entry| serde_json::to_string(entry).unwrap()).collect();
        let next = entries.last().map_or(1, |entry| entry.sequence + 1);
        let frame = ToClient::Events { subscription: 7, next, events: entries };
        assert_eq!(events(7, next, &texts), text(&frame));
    }

    #[test]
    fn revisions_that_are_put_together_are_spelled_as_the_frame_is() {
        let revision = |revision| Revision {
            revision,
            id: "e".to_owned(),
            author: "ana".to_owned(),
            name: "Rename".to_owned(),
            at_ms: 5,
            kind: RevisionKind::Edit,
            same_as: (revision == 4).then_some(2),
            changes: Vec::new(),
        };
        let two = vec![revision(3), revision(4)];
        let texts: Vec<String> =
            two.iter().map(|one| serde_json::to_string(one).unwrap()).collect();
        let frame = ToClient::Revisions { subscription: 7, revisions: two };
        assert_eq!(revisions(7, &texts), text(&frame));
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
