//! `rafcon link`: status of the links of this computer.

use super::kept::out;
use super::link::{robot_folders, station_folder};
use super::serve::state;
use crate::cli;
use crate::environment::Environment;
use crate::failure::complain;
use crate::view::{counted, harmless, size, time};
use anyhow::{Context as _, Result};
use rafcon_protocol::calendar::utc_text;
use rafcon_protocol::{
    ClockOffset, CommandStage, Contact, LIST_ID, LinkHealth, LinkReport, LinkRights, LinkTraffic,
    OpenCommand,
};
use rafcon_relay::read_reports;
use std::fmt::Write as _;
use std::io::Write as _;
use std::process::ExitCode;
use std::time::Duration;

/// Prints the status of each link. The exit code is 1 if no program here has a link.
pub(super) fn link_status(raw: &cli::LinkStatus, environment: &Environment) -> Result<ExitCode> {
    let state = state(&raw.state, environment)?;
    let mut reports = Vec::new();
    for folder in robot_folders(&state).into_iter().chain([station_folder(&state)]) {
        let read = read_reports(&folder).with_context(|| {
            format!("cannot read the report of the links in {}: another version of rafcon may run there", folder.display())
        })?;
        reports.extend(read.into_iter().flatten());
    }
    if reports.is_empty() {
        complain(
            "no link here: `rafcon serve --station ADDRESS` begins one on a robot, `rafcon station` at a station",
        );
        return Ok(ExitCode::FAILURE);
    }
    let mut out = out();
    for report in &reports {
        if raw.json {
            writeln!(out, "{}", serde_json::to_string(report)?)?;
        } else {
            write!(out, "{}", in_words(report))?;
        }
    }
    out.flush()?;
    Ok(ExitCode::SUCCESS)
}

fn in_words(report: &LinkReport) -> String {
    let LinkReport { health, profile, sent, received, runs, now_ms, station, .. } = report;
    let robot = &health.robot;
    let who = match station {
        _ if report.is_station => "the robot".to_owned(),
        Some(station) => format!("station {station}"),
        None => "the station".to_owned(),
    };
    let mut text = format!("{robot}: {}, profile {profile}\n", contact(health, *now_ms, &who));
    let LinkHealth { down_bytes_per_s, up_bytes_per_s, .. } = health;
    let (down, up) = (size(*down_bytes_per_s), size(*up_bytes_per_s));
    let mut line = |words: String| text.extend(["  ", &words, "\n"]);
    let limit = report.send_bytes_per_s.map(|limit| format!(" of {}/s", size(limit)));
    let limit = limit.unwrap_or_default();
    line(format!("from the robot {down}/s{limit}, to the robot {up}/s"));
    if report.is_station {
        line(rights(health.rights));
        line(planned_contact(health, *now_ms));
        line(up_link(health, *now_ms));
        for command in &health.commands {
            line(format!("  {}", command_line(command, health.is_heard, *now_ms)));
        }
        line(format!("robot's clock {}", offset(health.clock)));
    }
    line(format!("received {}", traffic(received)));
    line(format!("sent {}", traffic(sent)));
    if let Some(why) = &report.unusable_because {
        line(format!(
            "{} not usable, the last one because {why}",
            counted(report.unusable, "datagram")
        ));
    }
    for problem in &report.problems {
        line(problem.clone());
    }
    for run in runs {
        let missing = match run.missing {
            // The other side may have more by now.
            0 if !health.is_heard && report.is_station => {
                "all that the robot had at the last contact".to_owned()
            }
            0 if !health.is_heard => "all at the station at the last contact".to_owned(),
            0 => "all at the station".to_owned(),
            missing => format!("{missing} not known to be at the station"),
        };
        line(format!("{}  {}, {missing}", run.id, counted(run.head, "event")));
    }
    text
}

fn contact(health: &LinkHealth, now_ms: u64, who: &str) -> String {
    let LinkHealth { is_heard, heard_ms, .. } = health;
    match heard_ms.map(|heard_ms| spell(now_ms.saturating_sub(heard_ms))) {
        None => format!("no signal from {who} yet"),
        Some(ago) if *is_heard => format!("receiving from {who}, last signal {ago} ago"),
        Some(ago) => format!("no signal from {who} for {ago}"),
    }
}

fn up_link(health: &LinkHealth, now_ms: u64) -> String {
    let Some(reached_ms) = health.reached_ms else {
        return "no up-link: the robot has never confirmed a signal from this station".to_owned();
    };
    let ago = spell(now_ms.saturating_sub(reached_ms));
    let round_trip = health.round_trip_ms.map(spell).unwrap_or_default();
    let commands = match health.commands.len() as u64 {
        0 => String::new(),
        count => format!(", {} on the way{}", counted(count, "command"), progress(health)),
    };
    format!(
        "the robot received the signal sent {ago} ago; the round trip takes {round_trip}{commands}"
    )
}

/// Rights of the users of this station, by the pairing.
fn rights(rights: Option<LinkRights>) -> String {
    let may = match rights {
        None => return "rights of this station's users unknown".to_owned(),
        Some(LinkRights::Observe) => "see runs",
        Some(LinkRights::Command) => "command runs",
        Some(LinkRights::Change) => "command and change runs",
    };
    format!("users of this station may {may}")
}

/// The open contact, or else the next one.
fn planned_contact(health: &LinkHealth, now_ms: u64) -> String {
    if let Some(problem) = &health.contacts_problem {
        return format!("planned contacts unknown: {}", harmless(problem));
    }
    let Some(contact) = &health.contact else { return "no contact planned".to_owned() };
    let Contact { begin_ms, end_ms, profile, note } = contact;
    let note = note.as_ref().map(|note| format!(" ({})", harmless(note))).unwrap_or_default();
    let end = utc_text(*end_ms);
    if contact.is_open(now_ms) {
        let left = spell(end_ms.saturating_sub(now_ms));
        return format!("contact open until {end}, for {left} more, profile {profile}{note}");
    }
    let (begin, wait) = (utc_text(*begin_ms), spell(begin_ms.saturating_sub(now_ms)));
    format!("next contact in {wait}, {begin} to {end}, profile {profile}{note}")
}

/// Times at which a command is sent and takes effect.
fn command_line(command: &OpenCommand, is_heard: bool, now_ms: u64) -> String {
    let OpenCommand { id, asks, stage, send_at_ms, effect_ms, .. } = command;
    let user = match id.strip_prefix(LIST_ID) {
        Some(_) => "the command list".into(),
        None => harmless(id.split('/').next().unwrap_or(id)),
    };
    let until = |ms: u64| spell(ms.saturating_sub(now_ms));
    let sent = match (stage, send_at_ms) {
        (CommandStage::Sent, Some(at_ms)) => {
            format!("to be sent in {}, at {}", until(*at_ms), utc_text(*at_ms))
        }
        (CommandStage::Sent, None) if !is_heard => {
            return format!(
                "{asks} of {user}: being sent, time of effect unknown: no contact with the robot"
            );
        }
        (CommandStage::Sent, None) => "being sent".to_owned(),
        (CommandStage::Received, _) => "the robot has it".to_owned(),
        (CommandStage::Started, _) => return format!("{asks} of {user}: the run has it"),
        (CommandStage::Overdue, _) => {
            return format!("{asks} of {user}: expired without an answer of the robot");
        }
    };
    let effect = match (stage, effect_ms) {
        (_, Some(at_ms)) if *at_ms > now_ms => {
            format!(", takes effect in {}, at {}", until(*at_ms), utc_text(*at_ms))
        }
        (CommandStage::Sent, Some(at_ms)) => {
            format!(", effect expected {} ago, no answer yet", spell(now_ms - at_ms))
        }
        (CommandStage::Sent, None) => ", time of effect unknown: delay not measured yet".to_owned(),
        _ => String::new(),
    };
    format!("{asks} of {user}: {sent}{effect}")
}

/// Progress of the commands that are sent in parts.
fn progress(health: &LinkHealth) -> String {
    let parts = || health.commands.iter().filter_map(|command| command.progress);
    let bytes: u64 = parts().map(|it| it.bytes).sum();
    let arrived: u64 = parts().map(|it| it.arrived_bytes).sum();
    match (arrived * 100).checked_div(bytes) {
        Some(percent) => format!(", {percent} % of {} has arrived", size(bytes)),
        None => String::new(),
    }
}

fn offset(clock: Option<ClockOffset>) -> String {
    let signed = |ms: i64| {
        let sign = if ms < 0 { '-' } else { '+' };
        format!("{sign}{}", spell(ms.unsigned_abs()))
    };
    match clock {
        None => "unknown".to_owned(),
        Some(ClockOffset { least_ms, most_ms: None }) => {
            format!(
                "{} or more ahead of this one: the upper bound is unknown without an up-link",
                signed(least_ms)
            )
        }
        Some(ClockOffset { least_ms, most_ms: Some(most_ms) }) => {
            format!("between {} and {} ahead of this one", signed(least_ms), signed(most_ms))
        }
    }
}

fn traffic(traffic: &LinkTraffic) -> String {
    let LinkTraffic { datagrams, bytes, by_kind } = traffic;
    let mut text = format!("{} in {}", size(*bytes), counted(*datagrams, "datagram"));
    let inside: u64 = by_kind.values().sum();
    let mut kinds: Vec<_> = by_kind.iter().map(|(kind, bytes)| (*bytes, kind.as_str())).collect();
    kinds.push((bytes.saturating_sub(inside), "headers"));
    kinds.sort_unstable_by_key(|(bytes, kind)| (std::cmp::Reverse(*bytes), *kind));
    for (place, (bytes, kind)) in kinds.into_iter().filter(|(bytes, _)| *bytes > 0).enumerate() {
        let mark = if place == 0 { ':' } else { ',' };
        // Writing to a string does not fail.
        let _written = write!(text, "{mark} {kind} {}", size(bytes));
    }
    text
}

fn spell(ms: u64) -> String {
    time(Duration::from_millis(ms))
}

#[cfg(test)]
mod tests {
    use super::in_words;
    use expect_test::{Expect, expect};
    use rafcon_protocol::{
        ClockOffset, CommandProgress, CommandStage, Contact, LinkHealth, LinkReport, LinkRights,
        LinkRun, LinkTraffic, OpenCommand,
    };
    use std::collections::BTreeMap;

    fn report() -> LinkReport {
        let by_kind = |kinds: &[(&str, u64)]| -> BTreeMap<String, u64> {
            kinds.iter().map(|(kind, bytes)| ((*kind).to_owned(), *bytes)).collect()
        };
        let run = |id: &str, head, missing| LinkRun { id: id.to_owned(), head, missing };
        LinkReport {
            is_station: true,
            station: None,
            problems: Vec::new(),
            profile: "delay-2s".to_owned(),
            send_bytes_per_s: None,
            now_ms: 10_000_000,
            health: LinkHealth {
                robot: "scout".to_owned(),
                is_heard: true,
                heard_ms: Some(9_999_700),
                expected_every_ms: 500,
                reached_ms: Some(9_995_000),
                round_trip_ms: Some(4_100),
                lifetime_ms: Some(22_300),
                command_bytes_per_s: Some(2_000),
                down_bytes_per_s: 900,
                up_bytes_per_s: 31,
                missing: 12,
                commands: vec![OpenCommand {
                    id: "ana/1".to_owned(),
                    asks: "edit_script".to_owned(),
                    stage: CommandStage::Sent,
                    sent_ms: 9_999_000,
                    send_at_ms: None,
                    expires_ms: None,
                    not_before_ms: None,
                    arrives_ms: Some(10_001_050),
                    effect_ms: Some(10_001_050),
                    progress: Some(CommandProgress { arrived_bytes: 1_300, bytes: 2_900 }),
                }],
                contact: None,
                contacts_problem: None,
                clock: Some(ClockOffset { least_ms: -200, most_ms: Some(3_900) }),
                rights: Some(LinkRights::Command),
            },
            sent: LinkTraffic { datagrams: 1, bytes: 90, by_kind: BTreeMap::new() },
            received: LinkTraffic {
                datagrams: 4_000,
                bytes: 1_234_567,
                by_kind: by_kind(&[("events", 800_000), ("status", 20_000)]),
            },
            unusable: 2,
            unusable_because: Some("a datagram of 3 bytes is too short".to_owned()),
            runs: vec![run("20261124-a", 3_120, 12), run("20261124-b", 1, 0)],
        }
    }

    #[test]
    fn a_link_is_told_in_words() {
        let whole = report();
        let mut dark = report();
        dark.health = LinkHealth {
            is_heard: false,
            heard_ms: Some(9_200_000),
            reached_ms: None,
            clock: Some(ClockOffset { least_ms: 40, most_ms: None }),
            ..dark.health
        };
        dark.unusable_because = None;
        let mut robot = report();
        (robot.is_station, robot.health.heard_ms) = (false, None);
        robot.send_bytes_per_s = Some(7_600);
        let said: Vec<_> = [whole, dark, robot].iter().map(in_words).collect();
        expect![[r"
            scout: receiving from the robot, last signal 0.3 s ago, profile delay-2s
              from the robot 900 B/s, to the robot 31 B/s
              users of this station may command runs
              no contact planned
              the robot received the signal sent 5.0 s ago; the round trip takes 4.1 s, 1 command on the way, 44 % of 2.9 KB has arrived
                edit_script of ana: being sent, takes effect in 1.1 s, at 1970-01-01T02:46:41.050Z
              robot's clock between -0.2 s and +3.9 s ahead of this one
              received 1.2 MB in 4,000 datagrams: events 800 KB, headers 415 KB, status 20.0 KB
              sent 90 B in 1 datagram: headers 90 B
              2 datagrams not usable, the last one because a datagram of 3 bytes is too short
              20261124-a  3,120 events, 12 not known to be at the station
              20261124-b  1 event, all at the station

            scout: no signal from the robot for 13:20, profile delay-2s
              from the robot 900 B/s, to the robot 31 B/s
              users of this station may command runs
              no contact planned
              no up-link: the robot has never confirmed a signal from this station
                edit_script of ana: being sent, time of effect unknown: no contact with the robot
              robot's clock +0.0 s or more ahead of this one: the upper bound is unknown without an up-link
              received 1.2 MB in 4,000 datagrams: events 800 KB, headers 415 KB, status 20.0 KB
              sent 90 B in 1 datagram: headers 90 B
              20261124-a  3,120 events, 12 not known to be at the station
              20261124-b  1 event, all that the robot had at the last contact

            scout: no signal from the station yet, profile delay-2s
              from the robot 900 B/s of 7.6 KB/s, to the robot 31 B/s
              received 1.2 MB in 4,000 datagrams: events 800 KB, headers 415 KB, status 20.0 KB
              sent 90 B in 1 datagram: headers 90 B
              2 datagrams not usable, the last one because a datagram of 3 bytes is too short
              20261124-a  3,120 events, 12 not known to be at the station
              20261124-b  1 event, all at the station
        "]].assert_eq(&said.join("\n"));
    }

    /// The line of the contacts, and those of the commands, of a link with these.
    fn check(contact: Option<(u64, u64)>, commands: Vec<OpenCommand>, expect: &Expect) {
        let profile = "deep".to_owned();
        let contact = contact.map(|(begin_ms, end_ms)| Contact {
            begin_ms,
            end_ms,
            profile,
            note: Some("Kiruna".to_owned()),
        });
        let report = report();
        let health = LinkHealth { contact, commands, ..report.health };
        let text = in_words(&LinkReport { health, ..report });
        let is_about = |line: &&str| line.contains("contact") || line.contains(" of ana: ");
        let lines = text.lines().filter(is_about).map(|line| &line[2..]);
        expect.assert_eq(&lines.collect::<Vec<_>>().join("\n"));
    }

    #[test]
    fn a_planned_contact_is_open_or_the_next_one() {
        check(
            Some((9_000_000, 10_060_000)),
            vec![],
            &expect![
                "contact open until 1970-01-01T02:47:40Z, for 1:00 more, profile deep (Kiruna)"
            ],
        );
        check(
            Some((13_600_000, 14_000_000)),
            vec![],
            &expect![
                "next contact in 1:00:00, 1970-01-01T03:46:40Z to 1970-01-01T03:53:20Z, profile deep (Kiruna)"
            ],
        );
        let mut unknown = report();
        unknown.health.rights = None;
        unknown.health.contacts_problem = Some("the file is damaged".to_owned());
        assert!(in_words(&unknown).contains("\n  planned contacts unknown: the file is damaged\n"));
        assert!(in_words(&unknown).contains("\n  rights of this station's users unknown\n"));
    }

    #[test]
    fn a_queued_command_has_its_expected_times_as_far_as_they_are_known() {
        let command = |stage, send_at_ms, effect_ms| OpenCommand {
            stage,
            send_at_ms,
            effect_ms,
            ..report().health.commands[0].clone()
        };
        let (begin, effect) = (Some(13_600_000), Some(13_602_000));
        let commands = vec![
            command(CommandStage::Sent, begin, effect),
            command(CommandStage::Sent, begin, None),
            command(CommandStage::Sent, None, effect),
            command(CommandStage::Sent, None, Some(9_990_000)),
            command(CommandStage::Received, None, effect),
            command(CommandStage::Received, None, None),
            command(CommandStage::Started, None, None),
            command(CommandStage::Overdue, None, None),
        ];
        check(
            Some((13_600_000, 14_000_000)),
            commands,
            &expect![[r"
                  next contact in 1:00:00, 1970-01-01T03:46:40Z to 1970-01-01T03:53:20Z, profile deep (Kiruna)
                    edit_script of ana: to be sent in 1:00:00, at 1970-01-01T03:46:40Z, takes effect in 1:00:02, at 1970-01-01T03:46:42Z
                    edit_script of ana: to be sent in 1:00:00, at 1970-01-01T03:46:40Z, time of effect unknown: delay not measured yet
                    edit_script of ana: being sent, takes effect in 1:00:02, at 1970-01-01T03:46:42Z
                    edit_script of ana: being sent, effect expected 10.0 s ago, no answer yet
                    edit_script of ana: the robot has it, takes effect in 1:00:02, at 1970-01-01T03:46:42Z
                    edit_script of ana: the robot has it
                    edit_script of ana: the run has it
                    edit_script of ana: expired without an answer of the robot"]],
        );
    }
}
