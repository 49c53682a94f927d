//! `rafcon commands`: the list of timed commands for a robot of a station, composed, reviewed and released as one.

use super::contacts::open;
use super::kept::out;
use super::link::folder_of_robot;
use super::remote;
use super::serve::state;
use crate::cli::{self, ListFormat};
use crate::client::Server;
use crate::environment::Environment;
use crate::failure::{Usage, complain};
use crate::view::{counted, harmless, time};
use anyhow::{Context as _, Result, bail};
use rafcon_protocol::calendar::utc_text;
use rafcon_protocol::{
    Answer, CommandList, CommandStage, ListFate, ListLine, ListRelease, ListedCommand, ReleaseList,
};
use rafcon_relay::{CommandListFile, ContactFile};
use rafcon_supervisor::clock::since_1970_ms;
use std::fmt::Write as _;
use std::io::{Read, Write as _};
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

/// Maximum length of a list, in bytes. A server takes no longer request.
const LIST_MAX: u64 = 8 << 20;

/// Sets or releases the list on request, and prints it.
pub(super) fn command_list(raw: &cli::CommandList, environment: &Environment) -> Result<ExitCode> {
    let wanted = match &raw.set {
        Some(file) => Some(read(file)?),
        None => raw.clear.then(Vec::new),
    };
    let server = remote::server(&raw.remote, environment)?;
    let (list, is_with_link) = if let Some(server) = server {
        (at_server(&server, raw, wanted)?, true)
    } else if raw.release.is_some() {
        let words =
            "--release needs the server of the station, which has the link: add --server URL";
        return Err(Usage(words.to_owned()).into());
    } else {
        let state = state(&raw.remote.access.state, environment)?;
        let folder = folder_of_robot(&state, &raw.robot)?;
        let file = CommandListFile::in_folder(&folder);
        if let Some(commands) = wanted {
            file.set(commands, None)?;
        }
        let plan = ContactFile::in_folder(&folder).read()?;
        (file.read()?.without_link(&plan, since_1970_ms()), false)
    };
    let mut out = out();
    match raw.format {
        ListFormat::Json => writeln!(out, "{}", json(&list)?)?,
        ListFormat::Text => write!(out, "{}", in_words(&list, is_with_link, since_1970_ms()))?,
    }
    out.flush()?;
    match list.faults().len() as u64 {
        0 => {}
        count => complain(&format!(
            "{} with a fault: none of the commands is sent before it is corrected",
            counted(count, "line")
        )),
    }
    Ok(ExitCode::SUCCESS)
}

/// Sets or releases the list at the server of a station on request; returns the current list.
fn at_server(
    server: &Server,
    raw: &cli::CommandList,
    wanted: Option<Vec<ListedCommand>>,
) -> Result<CommandList> {
    let robot = &raw.robot;
    if let Some(commands) = wanted {
        return Ok(server.set_command_list(robot, &commands)?);
    }
    let revision = match raw.release.as_deref() {
        None => return Ok(server.command_list(robot)?),
        Some("") => server.command_list(robot)?.revision,
        Some(revision) => revision.to_owned(),
    };
    Ok(server.release_command_list(robot, &ReleaseList { revision })?)
}

/// The list in a file, or in the standard input.
fn read(file: &Path) -> Result<Vec<ListedCommand>> {
    let name = file.display();
    let text = list_text(open(file)?).with_context(|| format!("cannot read {name}"))?;
    ListedCommand::list_of_text(&text).with_context(|| format!("{name} is not used"))
}

fn list_text(source: impl Read) -> Result<String> {
    let mut text = String::new();
    source.take(LIST_MAX + 1).read_to_string(&mut text)?;
    if text.len() as u64 > LIST_MAX {
        bail!("it is longer than {} MiB: shorten its scripts and values", LIST_MAX >> 20);
    }
    Ok(text)
}

fn json(list: &CommandList) -> Result<String> {
    let commands: Vec<_> = list.lines.iter().map(|line| &line.listed).collect();
    Ok(serde_json::to_string_pretty(&commands)?)
}

/// The state of the list, and a line for each command.
fn in_words(list: &CommandList, is_with_link: bool, now_ms: u64) -> String {
    let CommandList { revision, released, lines } = list;
    if lines.is_empty() {
        return "no commands listed\n".to_owned();
    }
    let state = match released {
        None => "not released".to_owned(),
        Some(ListRelease { at_ms, user }) => {
            format!("released by {} at {}", harmless(user), utc_text(*at_ms))
        }
    };
    let mut text = format!("list {revision}, {state}\n");
    for (index, line) in lines.iter().enumerate() {
        let ListedCommand { run, command, .. } = &line.listed;
        let (kind, run) = (command.type_name(), harmless(run));
        let state = match (&line.fate, released) {
            (Some(fate), _) => fate_in_words(fate, line, now_ms),
            (None, Some(_)) if !is_with_link => {
                "released; the server of the station knows its fate (--server)".to_owned()
            }
            (None, _) => times_in_words(line, is_with_link, now_ms),
        };
        // Writing to a string does not fail.
        let _written = writeln!(text, "{}  {kind} of run {run}: {state}", index + 1);
        if let Some(fault) = &line.fault {
            let _written = writeln!(text, "   fault: {}", harmless(fault));
        }
    }
    text
}

fn fate_in_words(fate: &ListFate, line: &ListLine, now_ms: u64) -> String {
    match fate {
        ListFate::Open { stage: CommandStage::Sent } => times_in_words(line, true, now_ms),
        ListFate::Open { stage: CommandStage::Received } => match line.effect_ms {
            Some(at_ms) => format!("the robot has it, takes effect {}", at(at_ms, now_ms)),
            None => "the robot has it".to_owned(),
        },
        ListFate::Open { stage: CommandStage::Started } => "the run has it".to_owned(),
        ListFate::Open { stage: CommandStage::Overdue } => {
            "expired without an answer of the robot".to_owned()
        }
        ListFate::Answered { answer: Answer::Applied } => "applied".to_owned(),
        ListFate::Answered { answer: Answer::Refused { reason } } => {
            format!("refused: {}", harmless(reason))
        }
        ListFate::Answered { answer: Answer::Expired } => "expired, not carried out".to_owned(),
        ListFate::Answered { answer: Answer::Unknown { reason } } => {
            format!("unknown whether it was carried out: {}", harmless(reason))
        }
    }
}

/// Times at which a command is sent, takes effect and expires. An unknown time is left out.
fn times_in_words(line: &ListLine, is_with_link: bool, now_ms: u64) -> String {
    let is_sent = line.fate.is_some();
    let sent = match line.send_at_ms {
        Some(at_ms) => format!("sent {}", at(at_ms, now_ms)),
        None if is_sent => "being sent".to_owned(),
        None => "sent at the release".to_owned(),
    };
    let effect = match (line.effect_ms, line.not_before_ms) {
        (Some(at_ms), _) => format!("takes effect {}", at(at_ms, now_ms)),
        (None, _) if is_with_link => "time of effect unknown".to_owned(),
        (None, Some(at_ms)) => format!("takes effect {} at the earliest", at(at_ms, now_ms)),
        (None, None) => "takes effect on arrival".to_owned(),
    };
    let expiry = line.expires_ms.map(|at_ms| format!(", expires {}", at(at_ms, now_ms)));
    format!("{sent}, {effect}{}", expiry.unwrap_or_default())
}

/// A time, and its distance from now.
fn at(at_ms: u64, now_ms: u64) -> String {
    match at_ms.checked_sub(now_ms) {
        Some(wait_ms) if wait_ms > 0 => {
            format!("in {}, at {}", time(Duration::from_millis(wait_ms)), utc_text(at_ms))
        }
        _ => format!("at {}", utc_text(at_ms)),
    }
}

#[cfg(test)]
mod tests {
    use super::{LIST_MAX, in_words, json, list_text};
    use expect_test::{Expect, expect};
    use rafcon_protocol::{
        Answer, Command, CommandList, CommandStage, ListFate, ListLine, ListRelease, ListTime,
        ListedCommand,
    };
    use std::io::{Read as _, repeat};

    fn line(change: impl FnOnce(&mut ListLine)) -> ListLine {
        let not_before = Some(ListTime::Utc("1970-01-01T00:10:00Z".to_owned()));
        let run = "20261128-a".to_owned();
        let mut line = ListLine {
            listed: ListedCommand { run, command: Command::Pause, not_before, expiry: None },
            not_before_ms: Some(600_000),
            expires_ms: Some(700_000),
            send_at_ms: None,
            effect_ms: None,
            fault: None,
            fate: None,
        };
        change(&mut line);
        line
    }

    fn check(lines: Vec<ListLine>, user: Option<&str>, is_with_link: bool, expect: &Expect) {
        let released = user.map(|user| ListRelease { at_ms: 30_000, user: user.to_owned() });
        let list = CommandList { revision: "3f2a".to_owned(), released, lines };
        let again = ListedCommand::list_of_text(&json(&list).unwrap()).unwrap();
        assert_eq!(again.len(), list.lines.len());
        expect.assert_eq(&in_words(&list, is_with_link, 60_000));
    }

    #[test]
    fn a_list_is_shown_with_its_times_and_faults() {
        let lines = || {
            vec![
                line(|line| (line.send_at_ms, line.effect_ms) = (Some(90_000), Some(600_000))),
                line(|line| line.fault = Some("its time is past: choose a later one".to_owned())),
                line(|line| (line.not_before_ms, line.expires_ms) = (None, None)),
            ]
        };
        check(
            lines(),
            None,
            true,
            &expect![[r"
            list 3f2a, not released
            1  pause of run 20261128-a: sent in 30.0 s, at 1970-01-01T00:01:30Z, takes effect in 9:00, at 1970-01-01T00:10:00Z, expires in 10:40, at 1970-01-01T00:11:40Z
            2  pause of run 20261128-a: sent at the release, time of effect unknown, expires in 10:40, at 1970-01-01T00:11:40Z
               fault: its time is past: choose a later one
            3  pause of run 20261128-a: sent at the release, time of effect unknown
        "]],
        );
        check(
            lines(),
            None,
            false,
            &expect![[r"
            list 3f2a, not released
            1  pause of run 20261128-a: sent in 30.0 s, at 1970-01-01T00:01:30Z, takes effect in 9:00, at 1970-01-01T00:10:00Z, expires in 10:40, at 1970-01-01T00:11:40Z
            2  pause of run 20261128-a: sent at the release, takes effect in 9:00, at 1970-01-01T00:10:00Z at the earliest, expires in 10:40, at 1970-01-01T00:11:40Z
               fault: its time is past: choose a later one
            3  pause of run 20261128-a: sent at the release, takes effect on arrival
        "]],
        );
        check(Vec::new(), None, true, &expect!["no commands listed\n"]);
    }

    #[test]
    fn a_released_list_is_shown_with_the_fate_of_each_command() {
        let reason = || "it is over".to_owned();
        let fates = [
            Some(ListFate::Open { stage: CommandStage::Sent }),
            Some(ListFate::Open { stage: CommandStage::Received }),
            Some(ListFate::Open { stage: CommandStage::Started }),
            Some(ListFate::Open { stage: CommandStage::Overdue }),
            Some(ListFate::Answered { answer: Answer::Applied }),
            Some(ListFate::Answered { answer: Answer::Refused { reason: reason() } }),
            Some(ListFate::Answered { answer: Answer::Expired }),
            Some(ListFate::Answered { answer: Answer::Unknown { reason: reason() } }),
        ];
        let lines =
            fates.map(|fate| line(|line| (line.fate, line.effect_ms) = (fate, Some(600_000))));
        check(
            lines.to_vec(),
            Some("ana"),
            true,
            &expect![[r"
            list 3f2a, released by ana at 1970-01-01T00:00:30Z
            1  pause of run 20261128-a: being sent, takes effect in 9:00, at 1970-01-01T00:10:00Z, expires in 10:40, at 1970-01-01T00:11:40Z
            2  pause of run 20261128-a: the robot has it, takes effect in 9:00, at 1970-01-01T00:10:00Z
            3  pause of run 20261128-a: the run has it
            4  pause of run 20261128-a: expired without an answer of the robot
            5  pause of run 20261128-a: applied
            6  pause of run 20261128-a: refused: it is over
            7  pause of run 20261128-a: expired, not carried out
            8  pause of run 20261128-a: unknown whether it was carried out: it is over
        "]],
        );
        check(
            vec![line(|_| ())],
            Some("ana"),
            false,
            &expect![[r"
            list 3f2a, released by ana at 1970-01-01T00:00:30Z
            1  pause of run 20261128-a: released; the server of the station knows its fate (--server)
        "]],
        );
    }

    #[test]
    fn a_list_has_at_most_so_many_bytes() {
        let read = |bytes: u64| list_text(repeat(b' ').take(bytes)).map(|text| text.len() as u64);
        assert_eq!(read(LIST_MAX).unwrap(), LIST_MAX);
        let refused = read(LIST_MAX + 9).unwrap_err().to_string();
        assert_eq!(refused, "it is longer than 8 MiB: shorten its scripts and values");
    }
}
