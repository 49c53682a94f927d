//! Control of a run as text: who acts at which time, and who holds control afterwards.

use super::{Denied, GivenCommand, Holding, REQUESTS_MAX};
use expect_test::{Expect, expect};
use proptest::prelude::*;
use rafcon_protocol::api::ControlMove;
use std::fmt::Write as _;
use std::time::Duration;

const SILENCE: Duration = Duration::from_secs(30);

fn wanted(word: &str) -> Option<ControlMove> {
    Some(match word {
        "requests" => ControlMove::Request,
        "withdraws" => ControlMove::Withdraw,
        "hands-to-cy" => ControlMove::HandOver { to: "cy".to_owned() },
        "hands-to-ana" => ControlMove::HandOver { to: "ana".to_owned() },
        "releases" => ControlMove::Release,
        "takes-over" => ControlMove::TakeOver,
        "accepts" => ControlMove::Accept,
        "declines" => ControlMove::Decline,
        "overrides" => ControlMove::Override,
        _ => return None,
    })
}

/// A line is `second user action`. `sets-100` sets the clock by 100 s, `commands` is a command, `decides-3` a command that was decided
/// under epoch 3, and `refused-5` a refusal by the run of the user's command of second 5.
fn play(holding: &mut Holding, line: &str) -> Result<(), Denied> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [second, user, what] = words[..] else { panic!("{line}") };
    let now_ms = second.parse::<u64>().unwrap() * 1000;
    let id = |second: &str| format!("{user}/{second}");
    let mut command =
        |epoch| holding.command(GivenCommand { user, id: &id(second), epoch }, now_ms, SILENCE);
    if let Some(epoch) = what.strip_prefix("decides-") {
        return command(epoch.parse().ok());
    }
    if what == "commands" {
        return command(None);
    }
    if let Some(seconds) = what.strip_prefix("sets-") {
        holding.shift(seconds.parse::<i64>().unwrap() * 1000);
        return Ok(());
    }
    if let Some(second) = what.strip_prefix("refused-") {
        holding.refused(&id(second), now_ms);
        return Ok(());
    }
    if let Some(wanted) = wanted(what) {
        return holding.apply(user, &wanted, now_ms, SILENCE);
    }
    holding.heard(user, now_ms);
    Ok(())
}

fn shown(holding: &Holding) -> String {
    let control = holding.told(SILENCE);
    let offer = control.offered_to.map_or_else(String::new, |user| format!(", offered to {user}"));
    format!("{} {:?}{offer}", control.holder.as_deref().unwrap_or("nobody"), control.requests)
}

fn check(script: &str, expect: &Expect) {
    let mut holding = Holding::default();
    let mut seen = String::new();
    for line in script.lines().map(str::trim).filter(|line| !line.is_empty()) {
        let answer = play(&mut holding, line);
        let answer = answer.map_or_else(|denied| format!(": {denied}"), |()| String::new());
        writeln!(seen, "{line} -> {}{answer}", shown(&holding)).unwrap();
    }
    expect.assert_eq(&seen);
}

/// Result of every move in these situations, also with a silent holder if that differs.
fn table(situations: &[(&str, &str)]) -> String {
    let moves = [
        "commands",
        "requests",
        "withdraws",
        "hands-to-cy",
        "releases",
        "takes-over",
        "accepts",
        "declines",
        "overrides",
    ];
    let mut table = String::new();
    for (name, before) in situations.iter().copied() {
        for what in moves {
            let [soon, late] = [10, 40].map(|second| comes_to(before, second, what));
            writeln!(table, "{name} | ana {what} | {soon}").unwrap();
            if soon != late {
                writeln!(table, "{name}, silent | ana {what} | {late}").unwrap();
            }
        }
    }
    table
}

fn comes_to(before: &str, second: u64, what: &str) -> String {
    let mut holding = after(before);
    let answer = play(&mut holding, &format!("{second} ana {what}"));
    let answer = answer.map_or_else(|denied| denied_as(&denied), |()| "");
    format!("{}{answer}", shown(&holding))
}

#[test]
fn who_took_control_by_a_command_that_the_run_refused_has_it_no_more() {
    check(
        "
        1 ana decides-0
        1 ana refused-1
        2 ben decides-0
        3 ben refused-9
        4 ben commands
        4 ben refused-4
        4 ben refused-2
        5 ben releases
        6 cy commands
        7 ana requests
        8 cy refused-6
        ",
        &expect![[r#"
            1 ana decides-0 -> ana []
            1 ana refused-1 -> nobody []
            2 ben decides-0 -> ben []
            3 ben refused-9 -> ben []
            4 ben commands -> ben []
            4 ben refused-4 -> ben []
            4 ben refused-2 -> ben []
            5 ben releases -> nobody []
            6 cy commands -> cy []
            7 ana requests -> cy ["ana"]
            8 cy refused-6 -> ana []
        "#]],
    );
}

#[test]
fn every_move_has_an_answer_in_every_situation() {
    let situations = [
        ("nobody", ""),
        ("ana", "0 ana commands"),
        ("ana, bob asks", "0 ana commands; 1 bob requests"),
        ("bob", "0 bob commands"),
        ("bob, ana asks", "0 bob commands; 1 ana requests"),
    ];
    expect![[r#"
        nobody | ana commands | ana []
        nobody | ana requests | ana []
        nobody | ana withdraws | nobody []
        nobody | ana hands-to-cy | nobody [], denied: nobody holds it
        nobody | ana releases | nobody [], denied: nobody holds it
        nobody | ana takes-over | ana []
        nobody | ana accepts | nobody [], denied: not offered
        nobody | ana declines | nobody [], denied: not offered
        nobody | ana overrides | ana []
        ana | ana commands | ana []
        ana | ana requests | ana []
        ana | ana withdraws | ana []
        ana | ana hands-to-cy | ana [], offered to cy
        ana | ana releases | nobody []
        ana | ana takes-over | ana []
        ana | ana accepts | ana [], denied: not offered
        ana | ana declines | ana [], denied: not offered
        ana | ana overrides | ana []
        ana, bob asks | ana commands | ana ["bob"]
        ana, bob asks | ana requests | ana ["bob"]
        ana, bob asks | ana withdraws | ana ["bob"]
        ana, bob asks | ana hands-to-cy | ana ["bob"], offered to cy
        ana, bob asks | ana releases | bob []
        ana, bob asks | ana takes-over | ana ["bob"]
        ana, bob asks | ana accepts | ana ["bob"], denied: not offered
        ana, bob asks | ana declines | ana ["bob"], denied: not offered
        ana, bob asks | ana overrides | ana ["bob"]
        bob | ana commands | bob [], denied: held
        bob | ana requests | bob ["ana"]
        bob | ana withdraws | bob []
        bob | ana hands-to-cy | bob [], denied: held
        bob | ana releases | bob [], denied: held
        bob | ana takes-over | bob [], denied: heard
        bob, silent | ana takes-over | ana []
        bob | ana accepts | bob [], denied: not offered
        bob | ana declines | bob [], denied: not offered
        bob | ana overrides | ana []
        bob, ana asks | ana commands | bob ["ana"], denied: held
        bob, ana asks | ana requests | bob ["ana"]
        bob, ana asks | ana withdraws | bob []
        bob, ana asks | ana hands-to-cy | bob ["ana"], denied: held
        bob, ana asks | ana releases | bob ["ana"], denied: held
        bob, ana asks | ana takes-over | bob ["ana"], denied: heard
        bob, ana asks, silent | ana takes-over | ana []
        bob, ana asks | ana accepts | bob ["ana"], denied: not offered
        bob, ana asks | ana declines | bob ["ana"], denied: not offered
        bob, ana asks | ana overrides | ana []
    "#]]
    .assert_eq(&table(&situations));
}

#[test]
fn every_move_has_an_answer_beside_an_offer() {
    let situations = [
        ("bob, cy asks", "0 bob commands; 1 cy requests"),
        ("ana, cy asks", "0 ana commands; 1 cy requests"),
        ("ana, offered to cy", "0 ana commands; 1 ana hands-to-cy"),
        ("bob, offered to ana", "0 bob commands; 1 bob hands-to-ana"),
        ("bob, offered to cy", "0 bob commands; 1 bob hands-to-cy"),
    ];
    expect![[r#"
        bob, cy asks | ana commands | bob ["cy"], denied: held
        bob, cy asks | ana requests | bob ["cy", "ana"]
        bob, cy asks | ana withdraws | bob ["cy"]
        bob, cy asks | ana hands-to-cy | bob ["cy"], denied: held
        bob, cy asks | ana releases | bob ["cy"], denied: held
        bob, cy asks | ana takes-over | bob ["cy"], denied: heard
        bob, cy asks, silent | ana takes-over | ana ["cy"]
        bob, cy asks | ana accepts | bob ["cy"], denied: not offered
        bob, cy asks | ana declines | bob ["cy"], denied: not offered
        bob, cy asks | ana overrides | ana ["cy"]
        ana, cy asks | ana commands | ana ["cy"]
        ana, cy asks | ana requests | ana ["cy"]
        ana, cy asks | ana withdraws | ana ["cy"]
        ana, cy asks | ana hands-to-cy | cy []
        ana, cy asks | ana releases | cy []
        ana, cy asks | ana takes-over | ana ["cy"]
        ana, cy asks | ana accepts | ana ["cy"], denied: not offered
        ana, cy asks | ana declines | ana ["cy"], denied: not offered
        ana, cy asks | ana overrides | ana ["cy"]
        ana, offered to cy | ana commands | ana [], offered to cy
        ana, offered to cy | ana requests | ana [], offered to cy
        ana, offered to cy | ana withdraws | ana []
        ana, offered to cy | ana hands-to-cy | ana [], offered to cy
        ana, offered to cy | ana releases | nobody []
        ana, offered to cy | ana takes-over | ana []
        ana, offered to cy | ana accepts | ana [], offered to cy, denied: not offered
        ana, offered to cy | ana declines | ana [], offered to cy, denied: not offered
        ana, offered to cy | ana overrides | ana []
        bob, offered to ana | ana commands | bob [], offered to ana, denied: held
        bob, offered to ana | ana requests | ana []
        bob, offered to ana | ana withdraws | bob [], offered to ana
        bob, offered to ana | ana hands-to-cy | bob [], offered to ana, denied: held
        bob, offered to ana | ana releases | bob [], offered to ana, denied: held
        bob, offered to ana | ana takes-over | bob [], offered to ana, denied: heard
        bob, offered to ana, silent | ana takes-over | ana []
        bob, offered to ana | ana accepts | ana []
        bob, offered to ana | ana declines | bob []
        bob, offered to ana | ana overrides | ana []
        bob, offered to cy | ana commands | bob [], offered to cy, denied: held
        bob, offered to cy | ana requests | bob ["ana"], offered to cy
        bob, offered to cy | ana withdraws | bob [], offered to cy
        bob, offered to cy | ana hands-to-cy | bob [], offered to cy, denied: held
        bob, offered to cy | ana releases | bob [], offered to cy, denied: held
        bob, offered to cy | ana takes-over | bob [], offered to cy, denied: heard
        bob, offered to cy, silent | ana takes-over | ana []
        bob, offered to cy | ana accepts | bob [], offered to cy, denied: not offered
        bob, offered to cy | ana declines | bob [], offered to cy, denied: not offered
        bob, offered to cy | ana overrides | ana []
    "#]]
    .assert_eq(&table(&situations));
}

/// The state after these lines, which are separated by semicolons.
fn after(lines: &str) -> Holding {
    let mut holding = Holding::default();
    let lines = lines.split(';').filter(|line| !line.is_empty());
    lines.for_each(|line| play(&mut holding, line).unwrap());
    holding
}

fn denied_as(denied: &Denied) -> &'static str {
    match denied {
        Denied::Held { .. } => ", denied: held",
        Denied::Heard { .. } => ", denied: heard",
        Denied::Nobody => ", denied: nobody holds it",
        Denied::NoName => ", denied: no name",
        Denied::NotOffered => ", denied: not offered",
        Denied::TooMany => ", denied: too many",
        Denied::Epoch { .. } => ", denied: decided before control passed",
    }
}

#[test]
fn what_was_decided_before_control_passed_is_void() {
    let mut holding = Holding::default();
    let lines = [
        "0 ana decides-0",
        "1 ana decides-0",
        "2 ana decides-1",
        "3 ana decides-2",
        "40 bob takes-over",
        "41 bob decides-1",
        "42 bob decides-2",
        "80 ana takes-over",
        "81 ana decides-1",
        "82 ana decides-3",
        "83 ana releases",
        "84 ana decides-3",
        "85 ana decides-4",
    ];
    let seen = lines.map(|line| {
        let answer = play(&mut holding, line).map_or_else(|denied| denied_as(&denied), |()| "");
        format!("{line} -> epoch {}{answer}\n", holding.epoch())
    });
    expect![[r"
        0 ana decides-0 -> epoch 1
        1 ana decides-0 -> epoch 1
        2 ana decides-1 -> epoch 1
        3 ana decides-2 -> epoch 1, denied: decided before control passed
        40 bob takes-over -> epoch 2
        41 bob decides-1 -> epoch 2, denied: decided before control passed
        42 bob decides-2 -> epoch 2
        80 ana takes-over -> epoch 3
        81 ana decides-1 -> epoch 3, denied: decided before control passed
        82 ana decides-3 -> epoch 3
        83 ana releases -> epoch 4
        84 ana decides-3 -> epoch 4, denied: decided before control passed
        85 ana decides-4 -> epoch 5
    "]]
    .assert_eq(&seen.concat());
}

#[test]
fn control_changes_hands() {
    check(
        "0 ana commands
         1 bob commands
         2 bob requests
         3 ana hands-to-cy
         3 bob accepts
         3 cy declines
         3 ana hands-to-cy
         3 cy accepts
         4 cy releases
         5 bob takes-over
         20 bob heard
         40 ana takes-over
         50 ana takes-over",
        &expect![[r#"
            0 ana commands -> ana []
            1 bob commands -> ana []: ana holds control of this run: request it (POST …/control with "move": "request"), or take it over when they have been silent for 30 s; stop and pause need no control
            2 bob requests -> ana ["bob"]
            3 ana hands-to-cy -> ana ["bob"], offered to cy
            3 bob accepts -> ana ["bob"], offered to cy: nobody offers you control of this run: request it ("move": "request")
            3 cy declines -> ana ["bob"]
            3 ana hands-to-cy -> ana ["bob"], offered to cy
            3 cy accepts -> cy ["bob"]
            4 cy releases -> bob []
            5 bob takes-over -> bob []
            20 bob heard -> bob []
            40 ana takes-over -> bob []: bob was active 20 s ago: control can be taken over after 30 s of silence; request it meanwhile
            50 ana takes-over -> ana []
        "#]],
    );
}

proptest! {
    /// With any moves at any time, an active holder loses control only by giving it away or by an accepted offer.
    #[test]
    fn control_is_only_lost_by_silence(moves in prop::collection::vec((0..3_usize, 0..9_usize, 0..20_u64), 0..60)) {
        let words = ["commands", "requests", "withdraws", "hands-to-cy", "releases", "takes-over", "heard", "accepts", "declines"];
        let users = ["ana", "bob", "cy"];
        let (mut holding, mut now, mut heard, mut offered) = (Holding::default(), 0, 0, None::<String>);
        for (user, word, later) in moves {
            now += later;
            let before = holding.holder().map(str::to_owned);
            let answer = play(&mut holding, &format!("{now} {} {}", users[user], words[word]));
            let after = holding.holder().map(str::to_owned);
            if before.is_some() && before != after {
                let given = before.as_deref() == Some(users[user]);
                let accepted = offered.as_deref() == Some(users[user]);
                prop_assert!(answer.is_ok() && (given || accepted || now - heard >= 30));
            }
            offered = holding.told(SILENCE).offered_to;
            prop_assert!(offered.is_none() || after.is_some());
            if after.as_deref() == Some(users[user]) || before != after {
                heard = now;
            }
            prop_assert!(after.is_some() || holding.requests.is_empty());
        }
    }
}

#[test]
fn so_many_may_request_control_and_one_who_withdraws_makes_room() {
    let mut holding = Holding::default();
    play(&mut holding, "0 ana commands").unwrap();
    for nth in 0..REQUESTS_MAX {
        play(&mut holding, &format!("1 user{nth} requests")).unwrap();
    }
    assert!(matches!(play(&mut holding, "1 cy requests"), Err(Denied::TooMany)));
    // A repeated request of a user changes nothing.
    play(&mut holding, "1 user3 requests").unwrap();
    assert_eq!(holding.told(SILENCE).requests.len(), REQUESTS_MAX);
    play(&mut holding, "2 user3 withdraws").unwrap();
    play(&mut holding, "2 cy requests").unwrap();
    assert_eq!(holding.told(SILENCE).requests.last().map(String::as_str), Some("cy"));
}

#[test]
fn a_calendar_that_is_set_makes_nobody_silent_and_nobody_heard() {
    check(
        "
        1 ana commands
        3602 root sets-3600
        3610 bob takes-over
        3640 bob takes-over
        41 root sets--3600
        50 ana takes-over
        71 ana takes-over
        ",
        &expect![[r"
            1 ana commands -> ana []
            3602 root sets-3600 -> ana []
            3610 bob takes-over -> ana []: ana was active 9 s ago: control can be taken over after 30 s of silence; request it meanwhile
            3640 bob takes-over -> bob []
            41 root sets--3600 -> bob []
            50 ana takes-over -> bob []: bob was active 10 s ago: control can be taken over after 30 s of silence; request it meanwhile
            71 ana takes-over -> ana []
        "]],
    );
}
