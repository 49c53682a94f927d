//! Control of a run as text: who does what when, and who holds it then.

use super::Holding;
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

/// Lines of `second user what`; `commands` is a command.
fn play(holding: &mut Holding, line: &str) -> Result<(), super::Denied> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [second, user, what] = words[..] else { panic!("{line}") };
    let now_ms = second.parse::<u64>().unwrap() * 1000;
    match wanted(what) {
        Some(wanted) => holding.apply(user, &wanted, now_ms, SILENCE),
        None if what == "commands" => holding.command(user, now_ms, SILENCE),
        None => {
            holding.heard(user, now_ms);
            Ok(())
        }
    }
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

/// What every move in these situations comes to; where the holder's silence makes a difference, also that.
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
fn every_move_has_an_answer_in_every_situation() {
    let situations = [
        ("nobody", ""),
        ("ana", "0 ana commands"),
        ("ana, bob asks", "0 ana commands; 1 bob requests"),
        ("bob", "0 bob commands"),
        ("bob, ana asks", "0 bob commands; 1 ana requests"),
    ];
    expect![[r#""#]].assert_eq(&table(&situations));
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
    expect![[r#""#]].assert_eq(&table(&situations));
}

/// After these lines, with a semicolon between each.
fn after(lines: &str) -> Holding {
    let mut holding = Holding::default();
    let lines = lines.split(';').filter(|line| !line.is_empty());
    lines.for_each(|line| play(&mut holding, line).unwrap());
    holding
}

fn denied_as(denied: &super::Denied) -> &'static str {
    match denied {
        super::Denied::Held { .. } => ", denied: held",
        super::Denied::Heard { .. } => ", denied: heard",
        super::Denied::Nobody => ", denied: nobody holds it",
        super::Denied::NoName => ", denied: no name",
        super::Denied::NotOffered => ", denied: not offered",
        super::Denied::TooMany => ", denied: too many",
    }
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
            40 ana takes-over -> bob []: bob was heard 20 s ago: control can be taken over after 30 s of silence; request it meanwhile
            50 ana takes-over -> ana []
        "#]],
    );
}

proptest! {
    /// Any user moves at any time: a holder who was heard in time loses control only by giving it or by an accepted offer.
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
