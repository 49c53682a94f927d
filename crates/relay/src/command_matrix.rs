//! Every command of the protocol over every profile and delay, with a direction that is dead during the exchange, in virtual time; and
//! the table of commands in docs/link.md.

use crate::ids;
use crate::request_words;
use crate::station::default_lifetime;
use crate::words::StationRequest;
use rafcon_link::{CARRIER_OVERHEAD, CommandId, CommandState, NewCommand, Profile, StreamId};
use rafcon_protocol::Command;
use rafcon_testkit::disturbed_link::{Disturbance, DisturbedLink, LinkSetup, PROFILES, links};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::time::Duration;

const EVENTS: StreamId = StreamId(0x1234_5679);
/// A state at depth 8.
const PATH: &str = "ROOT01/ABCDE1/ABCDE2/ABCDE3/ABCDE4/ABCDE5/ABCDE6/ABCDE7";

/// Text that no compression shortens much: letters of a generator.
fn letters(count: usize) -> String {
    let mut seed = 7_u32;
    let letter = |_| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        char::from(b'!' + u8::try_from(seed >> 24).unwrap_or_default() % 90)
    };
    (0..count).map(letter).collect()
}

/// The tags of all commands, from the protocol's own enum: it names them where it refuses another one.
fn tags() -> BTreeSet<String> {
    let refusal = serde_json::from_value::<Command>(json!({ "type": "?" })).unwrap_err();
    let words: Vec<_> = refusal.to_string().split('`').map(str::to_owned).collect();
    words.into_iter().skip(3).step_by(2).collect()
}

/// One of each command as operators give it, and the long ones: name in the table, and command.
fn commands() -> Vec<(String, Command)> {
    let given = |length| json!([{ "path": PATH, "name": "goal", "value": letters(length) }]);
    let breakpoint =
        |condition: Option<&str>| json!({ "id": 12, "path": PATH, "condition": condition });
    let fields = json!({
        "path": PATH, "outcome": 0, "id": 12, "question": 3, "value": "yes", "sequence": 123_456,
        "script": letters(1_000), "policy": "abort", "breakpoint": breakpoint(None), "holder": "ben",
    });
    let command = |tag: &str, more: Value| {
        let mut words = fields.clone();
        words["type"] = json!(tag);
        words.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        serde_json::from_value(words).unwrap()
    };
    let mut all: Vec<_> =
        tags().into_iter().map(|tag| (tag.clone(), command(&tag, json!({})))).collect();
    let long = [
        ("answer_question", "2,000 characters", json!({ "value": letters(2_000) })),
        ("edit_script", "20 kB", json!({ "script": letters(20_000) })),
        ("run_selected", "10 kB of data", json!({ "data": given(10_000) })),
        (
            "set_breakpoint",
            "a condition",
            json!({ "breakpoint": breakpoint(Some("inputs['speed'] > 2.5 and gvm['mode'] == 'field'")) }),
        ),
    ];
    all.extend(long.map(|(tag, what, more)| (format!("{tag}, {what}"), command(tag, more))));
    all
}

/// Command id in the form of the page and `rafcon tell`.
const ID: &str = "ana/0123456789ab";

fn request(command: Command) -> StationRequest {
    StationRequest::Command(ID.to_owned(), "ana".to_owned(), Some(12_345), command)
}

/// The bytes of each command, which is read back from them.
fn bodies() -> Vec<(String, Vec<u8>)> {
    let body = |(name, command)| {
        let request = request(command);
        let body = request_words::write(EVENTS, &request);
        assert_eq!(request_words::read(ids::command(ID), &body), Ok((EVENTS, request)), "{name}");
        (name, body)
    };
    commands().into_iter().map(body).collect()
}

fn new_command(world: &DisturbedLink, nth: u8, body: &[u8]) -> NewCommand {
    let valid = default_lifetime(&world.station, world.station_time(), body.len());
    NewCommand { id: CommandId([nth; 16]), valid, wait: None, epoch: 0, body: body.to_vec() }
}

/// All at once, so that they are in each other's way: some may expire, and then the robot did nothing.
#[test]
fn every_command_has_its_true_fate_over_every_link_with_a_dead_direction() {
    let bodies = bodies();
    let dead = [
        vec![Disturbance::UpCut(40, 70)],
        vec![Disturbance::DownCut(40, 70)],
        vec![Disturbance::UpCut(40, 70), Disturbance::DownCut(40, 70)],
    ];
    for (profile, one_way) in links() {
        for disturbances in &dead {
            let at = format!("{} {one_way:?} {disturbances:?}", profile.name);
            let (profile, disturbances) = (profile.clone(), disturbances.clone());
            let link = LinkSetup { profile, one_way, disturbances };
            let mut world = DisturbedLink::new(link.clone());
            world.go_on(link.disturbed() * 45 / 100);
            let mut longest = Duration::ZERO;
            for (nth, (name, body)) in (1..).zip(&bodies) {
                let command = new_command(&world, nth, body);
                longest = longest.max(command.valid);
                world.command(command).unwrap_or_else(|why| panic!("{at}, {name}: {why}"));
            }
            world.go_on(link.disturbed() + longest);
            world.go_on(world.now + one_way * 4 + Duration::from_mins(3));
            world.check_fates();
            for (nth, (name, _)) in (1..).zip(&bodies) {
                let id = CommandId([nth; 16]);
                let fate = world.fates.get(&id);
                let is_known = matches!(fate, Some(CommandState::Done | CommandState::Expired));
                assert!(is_known && !world.station.is_open(id), "{at}, {name}: {fate:?}");
            }
        }
    }
}

/// One after the other, each with its default lifetime, while one of three datagrams is lost in both directions.
#[test]
fn every_command_is_carried_out_over_every_link() {
    // Networks of an hour's delay are no wireless networks.
    let is_real = |(profile, one_way): &(Profile, Duration)| {
        *one_way < Duration::from_secs(10)
            || *profile == Profile::DELAY_2S
            || *profile == Profile::DEEP
    };
    for (profile, one_way) in links().filter(is_real) {
        let at = format!("{} {one_way:?}", profile.name);
        let status_every = profile.status_every;
        let link = LinkSetup { profile, one_way, disturbances: vec![Disturbance::Losses(3)] };
        let mut world = DisturbedLink::new(link);
        world.go_on(one_way * 4 + status_every * 8);
        for (nth, (name, body)) in (1..).zip(bodies()) {
            let command = new_command(&world, nth, &body);
            let (id, over) = (command.id, world.now + command.valid);
            world.command(command).unwrap_or_else(|why| panic!("{at}, {name}: {why}"));
            while world.station.is_open(id) && world.now < over {
                world.go_on(world.now + one_way + Duration::from_secs(1));
            }
            assert_eq!(world.carried_out.get(&id), Some(&1), "{at}, {name}");
            assert_eq!(world.fates.get(&id), Some(&CommandState::Done), "{at}, {name}");
        }
    }
}

/// One row for each command: its length, and on each profile the datagrams that carry it and the time that these need on the up-link.
fn table() -> String {
    let names: Vec<_> = PROFILES.iter().map(|profile| format!("`{}`", profile.name)).collect();
    let mut table = format!(
        "| command | bytes | {} |\n| --- | --- |{}\n",
        names.join(" | "),
        " --- |".repeat(PROFILES.len())
    );
    for (name, command) in commands() {
        let length = request_words::write(EVENTS, &request(command)).len();
        let cells: Vec<_> = PROFILES.iter().map(|profile| cell(profile, length)).collect();
        let (tag, more) = name
            .split_once(", ")
            .map_or((&*name, String::new()), |(tag, more)| (tag, format!(", {more}")));
        writeln!(table, "| `{tag}`{more} | {length} | {} |", cells.join(" | ")).unwrap();
    }
    table
}

fn cell(profile: &Profile, length: usize) -> String {
    let (profile, disturbances) = (profile.clone(), Vec::new());
    let link = LinkSetup { profile: profile.clone(), one_way: Duration::ZERO, disturbances };
    let parts = length.div_ceil(DisturbedLink::new(link).station.command_bytes_max());
    // The head of a command in parts is a datagram of its own.
    let datagrams = if parts == 1 { 1 } else { parts + 1 };
    let bytes = (profile.up_bytes_max + CARRIER_OVERHEAD) * datagrams;
    let tenths = bytes as u64 * 80 / profile.up_bits_per_s;
    format!("{datagrams}, {}.{} s", tenths / 10, tenths % 10)
}

#[test]
fn the_document_has_the_size_of_every_command() {
    let document = include_str!("../../../docs/link.md");
    let table = table();
    assert!(document.contains(&table), "docs/link.md has another table of commands:\n{table}");
}
