//! Changes in, frames out, each with its time, on a clock that pauses while a task works.

use super::super::outbox::{FULL, Lane, Outbox, length};
use super::super::status::Status;
use super::super::words;
use super::{Feed, NextMessage, tell};
use expect_test::{Expect, expect};
use rafcon_protocol::socket::ToClient;
use std::fmt::Write as _;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::{Instant, sleep, sleep_until, timeout, timeout_at};

/// Takes frames for `ms`, with a pause after each, and records the times.
async fn taken(outbox: &Outbox, ms: u64, slowness: Duration) -> String {
    let (begin, mut text) = (Instant::now(), String::new());
    let end = begin + Duration::from_millis(ms);
    while let Ok((lane, frame)) = timeout_at(end, outbox.next()).await {
        let at = begin.elapsed().as_millis();
        writeln!(text, "{at} {}", frame.to_text().unwrap()).unwrap();
        sleep(slowness).await;
        outbox.sent(lane, length(&frame));
    }
    text
}

/// A number that changes at these times, and its status frames.
async fn check(changes: &[(u64, u64)], slowness_ms: u64, expect: &Expect) {
    let (outbox, number) = (Outbox::new(), watch::Sender::new(0));
    let frame = |number: &u64| words::text(&ToClient::Pong { id: *number, now_ms: 0 });
    let status = Status::new(7, number.subscribe(), frame);
    let begin = Instant::now();
    let change = async {
        for (at, to) in changes {
            sleep_until(begin + Duration::from_millis(*at)).await;
            number.send_replace(*to);
        }
        drop(number);
    };
    let slowness = Duration::from_millis(slowness_ms);
    let ((), (), text) =
        tokio::join!(change, tell(status, &outbox), taken(&outbox, 2000, slowness));
    expect.assert_eq(&text);
}

#[tokio::test(start_paused = true)]
async fn the_first_change_is_told_at_once_and_then_one_in_a_tenth_of_a_second() {
    check(
        &[(10, 1), (20, 2), (130, 3), (500, 4), (510, 5), (511, 6)],
        0,
        &expect![[r#"
        0 {"frame":"pong","id":0,"now_ms":0}
        100 {"frame":"pong","id":2,"now_ms":0}
        200 {"frame":"pong","id":3,"now_ms":0}
        500 {"frame":"pong","id":4,"now_ms":0}
        600 {"frame":"pong","id":6,"now_ms":0}
        700 {"frame":"ended","subscription":7,"refusal":null}
    "#]],
    )
    .await;
}

/// Frames of ten kilobytes, until the outbox is full.
struct Flood {
    told: u64,
}

impl Feed for Flood {
    const LANE: Lane = Lane::History;

    fn next_time(&self) -> Instant {
        Instant::now()
    }

    async fn ready(&mut self) {}

    async fn take(&mut self) -> NextMessage {
        self.told += 1;
        NextMessage::Part(format!("{:>10000}", self.told))
    }
}

#[tokio::test(start_paused = true)]
async fn what_nobody_takes_is_not_fetched() {
    let outbox = Outbox::new();
    let floods = (0..64).map(|_| tell(Flood { told: 0 }, &outbox));
    let all = futures_util::future::join_all(floods);
    assert!(timeout(Duration::from_mins(1), all).await.is_err());
    assert!(outbox.bytes() < FULL + 10_000, "{} bytes", outbox.bytes());
}

#[tokio::test(start_paused = true)]
async fn a_client_that_is_slow_is_told_the_latest_truth_and_not_what_was_true() {
    let changes: Vec<(u64, u64)> = (1..100).map(|at| (at * 10, at)).collect();
    check(
        &changes,
        300,
        &expect![[r#"
        0 {"frame":"pong","id":0,"now_ms":0}
        300 {"frame":"pong","id":30,"now_ms":0}
        600 {"frame":"pong","id":60,"now_ms":0}
        900 {"frame":"pong","id":90,"now_ms":0}
        1200 {"frame":"pong","id":99,"now_ms":0}
        1500 {"frame":"ended","subscription":7,"refusal":null}
    "#]],
    )
    .await;
}

#[tokio::test(start_paused = true)]
async fn the_latest_truth_does_not_wait_for_history_to_be_read() {
    let outbox = Outbox::new();
    let _history = outbox.turn(Lane::History).await.unwrap();
    let number = watch::Sender::new(3);
    let frame = |number: &u64| words::text(&ToClient::Pong { id: *number, now_ms: 0 });
    let status = Status::new(7, number.subscribe(), frame);
    let told = tokio::join!(timeout(Duration::from_secs(1), tell(status, &outbox)), outbox.next());
    assert_eq!(told.1.1.to_text().unwrap(), r#"{"frame":"pong","id":3,"now_ms":0}"#);
}

#[tokio::test(start_paused = true)]
async fn the_latest_truth_is_sent_before_history_that_waits_and_history_is_never_starved() {
    let outbox = Outbox::new();
    for number in 0..3 {
        outbox.push(Lane::History, format!("history {number}"));
    }
    for number in 0..10 {
        outbox.push(Lane::Status, format!("status {number}"));
    }
    let text = taken(&outbox, 1000, Duration::ZERO).await;
    expect![[r"
        0 status 0
        0 status 1
        0 status 2
        0 status 3
        0 status 4
        0 status 5
        0 status 6
        0 status 7
        0 history 0
        0 status 8
        0 status 9
        0 history 1
        0 history 2
    "]]
    .assert_eq(&text);
}
