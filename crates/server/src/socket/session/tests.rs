//! Frames in, requests out, one per line.

use super::{ClientRequest, SELECTION_MAX, SUBSCRIPTIONS_MAX, Session};
use crate::access::{Credential, Who};
use crate::socket::words;
use expect_test::{Expect, expect};
use proptest::prelude::*;
use rafcon_protocol::api::Role;

fn who(role: Role) -> Who {
    Who { user: "ana".to_owned(), role, expires_ms: None, by: Credential::Owner }
}

/// The requests of these frames, one per line. Frames for the client appear as text.
fn hear(session: &mut Session, role: Role, frames: &str) -> String {
    let frames = frames.lines().map(str::trim).filter(|frame| !frame.is_empty());
    let acts = frames.map(|frame| match session.hear(frame, &who(role), 5) {
        ClientRequest::Tell(frame) => words::text(&frame) + "\n",
        act => format!("{act:?}\n"),
    });
    acts.collect()
}

fn check(role: Role, frames: &str, expect: &Expect) {
    expect.assert_eq(&hear(&mut Session::default(), role, frames));
}

#[test]
fn a_number_is_one_subscription_at_a_time() {
    check(
        Role::Viewer,
        r#"
            {"frame":"subscribe","subscription":1,"topic":{"topic":"run_history","run":"r","from":7,"values":true}}
            {"frame":"subscribe","subscription":1,"topic":{"topic":"server_status"}}
            {"frame":"unsubscribe","subscription":1}
            {"frame":"subscribe","subscription":1,"topic":{"topic":"server_status"}}
        "#,
        &expect![[r#"
            Begin(1, RunHistory { run: "r", from: 7, values: true })
            {"frame":"refused","id":null,"refusal":{"code":"subscription_in_use","message":"subscription 1 exists already: unsubscribe it first, or choose another number"}}
            GiveUp(1)
            Begin(1, ServerStatus)
        "#]],
    );
}

#[test]
fn subscriptions_are_limited() {
    let mut session = Session::default();
    let subscribe = |number: usize| {
        format!(
            r#"{{"frame":"subscribe","subscription":{number},"topic":{{"topic":"server_status"}}}}"#
        )
    };
    for number in 0..SUBSCRIPTIONS_MAX {
        hear(&mut session, Role::Viewer, &subscribe(number));
    }
    expect![[r#"
        {"frame":"ended","subscription":900,"refusal":{"code":"too_many_subscriptions","message":"this connection has 64 subscriptions, and that is the most: give one up first"}}
    "#]]
    .assert_eq(&hear(&mut session, Role::Viewer, &subscribe(900)));
    session.ended(3);
    expect![["
        Begin(900, ServerStatus)
    "]]
    .assert_eq(&hear(&mut session, Role::Viewer, &subscribe(900)));
}

#[test]
fn a_selection_is_not_longer_than_others_can_be_told() {
    let select = |paths: &[String]| {
        let paths = serde_json::to_string(paths).unwrap();
        let frame = format!(r#"{{"frame":"presence","machine":"m","selection":{paths}}}"#);
        hear(&mut Session::default(), Role::Viewer, &frame)
    };
    let look = |bytes: usize| select(&["S".repeat(bytes)]);
    assert!(look(64 << 10).starts_with("Look"));
    assert!(select(&vec!["S".to_owned(); SELECTION_MAX]).starts_with("Look"));
    let refused = select(&vec!["S".to_owned(); SELECTION_MAX + 1]);
    assert!(refused.contains("too_many_selected"), "{refused}");
    expect![[r#"
        {"frame":"refused","id":null,"refusal":{"code":"too_many_selected","message":"1 states are selected in machine m, with paths of 65537 bytes: tell of at most 1000 states and 65536 bytes"}}
    "#]]
    .assert_eq(&look((64 << 10) + 1));
}

#[test]
fn a_ping_is_answered_with_the_time() {
    check(
        Role::Viewer,
        r#"{"frame":"ping","id":3}"#,
        &expect![[r#"
            {"frame":"pong","id":3,"now_ms":5}
        "#]],
    );
}

#[test]
fn what_is_no_frame_is_refused_with_its_id() {
    check(
        Role::Admin,
        r#"
            hallo
            {"frame":"dance"}
            {"frame":"command","run":"r","envelope":{"id":"c1","command":{"type":"run_to"}}}
            {"frame":"edit","machine":"m","edit":{"id":"e1"}}
        "#,
        &expect![[r#"
            {"frame":"refused","id":null,"refusal":{"code":"bad_frame","message":"not a frame: expected value at line 1 column 1, in \"hallo\"; this server speaks version 2 of the frames, which docs/protocol.md lists: load the page again, or update the program"}}
            {"frame":"refused","id":null,"refusal":{"code":"bad_frame","message":"not a frame: unknown variant `dance`, expected one of `subscribe`, `unsubscribe`, `command`, `edit`, `undo`, `redo`, `presence`, `ping` at line 1 column 16, in \"{\\\"frame\\\":\\\"dance\\\"}\"; this server speaks version 2 of the frames, which docs/protocol.md lists: load the page again, or update the program"}}
            {"frame":"refused","id":"c1","refusal":{"code":"bad_frame","message":"not a frame: missing field `path`, in \"{\\\"frame\\\":\\\"command\\\",\\\"run\\\":\\\"r\\\",\\\"envelope\\\":{\\\"id\\\":\\\"c1\\\",\\\"command\\\":{\\\"type\\\":\\\"run_to\\\"}}}\"; this server speaks version 2 of the frames, which docs/protocol.md lists: load the page again, or update the program"}}
            {"frame":"refused","id":"e1","refusal":{"code":"bad_frame","message":"not a frame: missing field `name`, in \"{\\\"frame\\\":\\\"edit\\\",\\\"machine\\\":\\\"m\\\",\\\"edit\\\":{\\\"id\\\":\\\"e1\\\"}}\"; this server speaks version 2 of the frames, which docs/protocol.md lists: load the page again, or update the program"}}
        "#]],
    );
}

#[test]
fn commands_and_edits_need_their_rights() {
    let frames = r#"
        {"frame":"command","run":"r","envelope":{"id":"c1","command":{"type":"pause"}}}
        {"frame":"command","run":"r","envelope":{"id":"c2","command":{"type":"edit_script","path":"a","script":""}}}
        {"frame":"undo","machine":"m","undo":{"id":"u1"}}
        {"frame":"presence","machine":"m","selection":["a/b"]}
    "#;
    check(
        Role::Viewer,
        frames,
        &expect![[r#"
        {"frame":"refused","id":"c1","refusal":{"code":"not_your_right","message":"ana is viewer here, and this needs the right to command: ask an admin for another role"}}
        {"frame":"refused","id":"c2","refusal":{"code":"not_your_right","message":"ana is viewer here, and this needs the right to edit: ask an admin for another role"}}
        {"frame":"refused","id":"u1","refusal":{"code":"not_your_right","message":"ana is viewer here, and this needs the right to edit: ask an admin for another role"}}
        Look { machine: "m", selection: ["a/b"] }
    "#]],
    );
    check(
        Role::Operator,
        frames,
        &expect![[r#"
        Command { run: "r", envelope: Envelope { id: "c1", author: "", decided_on: None, expiry: None, not_before: None, epoch: None, command: Pause } }
        {"frame":"refused","id":"c2","refusal":{"code":"not_your_right","message":"ana is operator here, and this needs the right to edit: ask an admin for another role"}}
        {"frame":"refused","id":"u1","refusal":{"code":"not_your_right","message":"ana is operator here, and this needs the right to edit: ask an admin for another role"}}
        Look { machine: "m", selection: ["a/b"] }
    "#]],
    );
    check(
        Role::Engineer,
        frames,
        &expect![[r#"
            Command { run: "r", envelope: Envelope { id: "c1", author: "", decided_on: None, expiry: None, not_before: None, epoch: None, command: Pause } }
            Command { run: "r", envelope: Envelope { id: "c2", author: "", decided_on: None, expiry: None, not_before: None, epoch: None, command: EditScript { path: "a", script: "" } } }
            Change { machine: "m", id: "u1", operation: Undo }
            Look { machine: "m", selection: ["a/b"] }
        "#]],
    );
}

/// Valid frames, which are then corrupted.
const RIGHT: [&str; 5] = [
    r#"{"frame":"subscribe","subscription":1,"topic":{"topic":"run_history","run":"r","from":7}}"#,
    r#"{"frame":"unsubscribe","subscription":1}"#,
    r#"{"frame":"command","run":"r","envelope":{"id":"c1","command":{"type":"pause"}}}"#,
    r#"{"frame":"edit","machine":"m","edit":{"id":"e1","name":"Rename","edit":{"edit":"set_name","path":"a","name":"b"}}}"#,
    r#"{"frame":"ping","id":3}"#,
];

/// Every frame causes a reply or a request. A subscription starts only under a free number.
fn any_frame_is_answered(frames: &[String]) {
    let mut session = Session::default();
    let mut begun = std::collections::BTreeSet::new();
    for frame in frames {
        match session.hear(frame, &who(Role::Admin), 5) {
            ClientRequest::Begin(subscription, _) => assert!(begun.insert(subscription)),
            ClientRequest::GiveUp(subscription) => drop(begun.remove(&subscription)),
            ClientRequest::Tell(frame) => assert!(words::text(&frame).starts_with(r#"{"frame":""#)),
            ClientRequest::Command { .. }
            | ClientRequest::Change { .. }
            | ClientRequest::Look { .. } => {}
        }
        assert!(begun.len() <= SUBSCRIPTIONS_MAX);
    }
}

/// A valid frame with some characters replaced or removed.
fn nearly_right() -> impl Strategy<Value = String> {
    let change = (
        any::<prop::sample::Index>(),
        prop::sample::select(vec!["", "\"", "{", "}", "0", "\u{0}", "é", ","]),
    );
    (prop::sample::select(&RIGHT[..]), prop::collection::vec(change, 0..4)).prop_map(
        |(frame, changes)| {
            let mut characters: Vec<String> = frame.chars().map(String::from).collect();
            for (index, with) in changes {
                let at = index.index(characters.len());
                characters[at] = with.to_owned();
            }
            characters.concat()
        },
    )
}

proptest! {
    #[test]
    fn mutilated_frames_are_answered(frames in prop::collection::vec(nearly_right(), 1..20)) {
        any_frame_is_answered(&frames);
    }

    #[test]
    fn texts_are_answered(frames in prop::collection::vec(".{0,60}|[{}\\[\\]\":,a-z0-9]{0,60}", 1..20)) {
        any_frame_is_answered(&frames);
    }
}
