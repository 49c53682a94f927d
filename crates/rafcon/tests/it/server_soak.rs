//! Many clients follow one fast run, one of them slowly, and one never reads: no one loses anything, the server's memory stays
//! bounded, and the run continues at its own pace.

use crate::harness::{self, Place};
use crate::served::{Door, Line, Served};
use crate::torture::number;
use rafcon_protocol::api::{HistoryEntry, RunPhase};
use rafcon_protocol::socket::{ToClient, ToServer, Topic};
use rafcon_storage::journal::Reader;
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use serde_json::json;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::time::Duration;

/// How many clients there are, where a few are not enough.
const CLIENTS: &str = "RAFCON_TEST_CLIENTS";
/// For how long the run continues.
const SECONDS: &str = "RAFCON_TEST_SECONDS";
/// How long the slow client thinks about a frame.
const SLOWNESS: Duration = Duration::from_millis(40);
/// What the server may take beyond what it takes with one client, and for each other.
const MEMORY_KB: u64 = 48 * 1024;
/// See [`MEMORY_KB`].
const MEMORY_EACH_KB: u64 = 384;
/// How an event begins in a frame.
const EVENT: &str = "{\"sequence\":";
#[test]
fn many_clients_lose_nothing_and_cost_a_bounded_amount_of_memory() {
    let clients = number(CLIENTS).unwrap_or(20);
    let ticks = 1000 * number(SECONDS).unwrap_or(3);
    let place = Place::empty();
    let machine = notation::parse(&harness::ticks(ticks)).unwrap();
    save(&machine, &place.path("project/machine"), None, Naming::default()).unwrap();
    let words = "serve project --bind 127.0.0.1:0 --state state --runs runs";
    let served = Served::start(place.command(words)).unwrap();
    let door = served.door();
    let run = start(door);
    let before_kb = resident_kb(served.pid());
    let never = subscribed(door, &run);
    let most_kb = std::thread::scope(|scope| {
        let readers: Vec<_> = (0..clients.saturating_sub(2))
            .map(|_| scope.spawn(|| follow(subscribed(door, &run), Duration::ZERO)))
            .collect();
        let slow = scope.spawn(|| follow(subscribed(door, &run), SLOWNESS));
        let most_kb = watch(door, &run, served.pid());
        let told = readers.into_iter().chain([slow]).map(|reader| reader.join().unwrap());
        let last = last_of(&place.path("runs").join(&run));
        told.for_each(|told| assert_eq!(told, last, "somebody was not told everything"));
        most_kb.max(resident_kb(served.pid()))
    });
    drop(never);
    let took_ms = compare(door, &run, &place.path("runs").join(&run));
    let more_kb = most_kb.saturating_sub(before_kb);
    writeln!(
        std::io::stdout(),
        "{clients} clients: {more_kb} kB more than {before_kb}; {ticks} states took {took_ms} ms"
    )
    .unwrap();
    assert!(more_kb < MEMORY_KB + clients * MEMORY_EACH_KB, "the server took {more_kb} kB more");
}

fn start(door: &Door) -> String {
    let projects = door.ask("GET", "/api/v1/projects", None).unwrap();
    let machine = json!({ "project": projects[0]["id"], "path": "machine" });
    let start = json!({ "id": "soak", "machine": machine });
    let run = door.ask("POST", "/api/v1/runs", Some(&start)).unwrap();
    run["id"].as_str().unwrap().to_owned()
}

fn subscribed(door: &Door, run: &str) -> Line {
    let mut line = door.line().unwrap();
    let topic = Topic::RunHistory { run: run.to_owned(), from: 1, values: true };
    line.say(&ToServer::Subscribe { subscription: 1, topic }).unwrap();
    line
}

/// Reads to the end, and gives the number of the last event; each has to follow the one before.
fn follow(mut line: Line, pause: Duration) -> u64 {
    let mut last = 0;
    loop {
        let text = line.hear_text().unwrap();
        if !text.starts_with(r#"{"frame":"events""#) {
            assert!(text.starts_with(r#"{"frame":"ended""#), "{text}");
            return last;
        }
        for event in text.split(EVENT).skip(1) {
            let (sequence, _) = event.split_once(',').unwrap();
            assert_eq!(sequence.parse::<u64>().unwrap(), last + 1, "an event is missing");
            last += 1;
        }
        think(pause);
    }
}

#[expect(clippy::disallowed_methods, reason = "a slow client is slow")]
fn think(pause: Duration) {
    std::thread::sleep(pause);
}

/// Follows the status of the run to its end; gives the most memory that the server had.
fn watch(door: &Door, run: &str, pid: u32) -> u64 {
    let mut line = door.line().unwrap();
    let topic = Topic::RunStatus { run: run.to_owned() };
    line.say(&ToServer::Subscribe { subscription: 1, topic }).unwrap();
    let mut most_kb = 0;
    loop {
        most_kb = most_kb.max(resident_kb(pid));
        match line.hear().unwrap() {
            ToClient::RunStatus { status, .. } => match status.run.phase {
                RunPhase::Finished { .. } => return most_kb,
                RunPhase::Starting | RunPhase::Live => {}
                phase => panic!("{phase:?}"),
            },
            other => panic!("{other:?}"),
        }
    }
}

fn last_of(folder: &Path) -> u64 {
    Reader::open(folder).unwrap().last_sequence().unwrap()
}

/// What a client is told of the run that is over is what its journal says; gives the run's length in ms.
fn compare(door: &Door, run: &str, folder: &Path) -> u64 {
    let mut line = subscribed(door, run);
    let mut reader = Reader::open(folder).unwrap();
    let (mut next, mut t_ns) = (1, 0);
    loop {
        let events = match line.hear().unwrap() {
            ToClient::Events { events, .. } => events,
            ToClient::Ended { refusal: None, .. } => break,
            other => panic!("{other:?}"),
        };
        let entries = reader.page(next, events.len()).unwrap();
        let entries = entries.iter().map(|entry| HistoryEntry {
            sequence: entry.sequence,
            t_ns: entry.t_ns,
            event: reader.event(entry, true).unwrap(),
        });
        assert_eq!(events, entries.collect::<Vec<_>>());
        next += events.len() as u64;
        t_ns = events.last().map_or(t_ns, |entry| entry.t_ns);
    }
    assert_eq!(next, last_of(folder) + 1);
    t_ns / 1_000_000
}

fn resident_kb(pid: u32) -> u64 {
    let text = fs::read_to_string(format!("/proc/{pid}/status")).unwrap();
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.split_whitespace().next().unwrap().parse().unwrap()
}
