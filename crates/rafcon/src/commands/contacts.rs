//! `rafcon contacts`: the planned contacts of a station with a robot.

use super::kept::out;
use super::link::folder_of_robot;
use super::remote;
use super::serve::state;
use crate::cli::{self, ListFormat};
use crate::client::Server;
use crate::environment::Environment;
use crate::view::{harmless, time};
use anyhow::{Context as _, Result, bail};
use rafcon_protocol::calendar::utc_text;
use rafcon_protocol::{Contact, ContactPlan, ContactWindow};
use rafcon_relay::ContactFile;
use rafcon_supervisor::clock::since_1970_ms;
use std::fs::File;
use std::io::{self, Read, Write as _};
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

/// Maximum length of a list of contacts, in bytes: a thousand windows with the longest notes fit.
const LIST_MAX: u64 = 2 << 20;

/// Sets the plan on request, and prints the current plan.
pub(super) fn contacts(raw: &cli::Contacts, environment: &Environment) -> Result<ExitCode> {
    let now_ms = since_1970_ms();
    let wanted = match &raw.set {
        Some(file) => Some(read(file)?),
        None => raw.clear.then(ContactPlan::default),
    };
    let plan = if let Some(server) = remote::server(&raw.remote, environment)? {
        at_server(&server, &raw.robot, wanted.as_ref())?
    } else {
        let state = state(&raw.remote.access.state, environment)?;
        let file = ContactFile::in_folder(&folder_of_robot(&state, &raw.robot)?);
        if let Some(plan) = &wanted {
            plan.check_future(now_ms)?;
            file.write(plan)?;
        }
        file.read()?
    };
    let mut out = out();
    match raw.format {
        ListFormat::Json => writeln!(out, "{}", json(&plan.windows())?)?,
        ListFormat::Text => write!(out, "{}", in_words(&plan, now_ms))?,
    }
    out.flush()?;
    Ok(ExitCode::SUCCESS)
}

/// Sets the plan at the server of a station on request; returns the current plan.
fn at_server(server: &Server, robot: &str, wanted: Option<&ContactPlan>) -> Result<ContactPlan> {
    let windows = match wanted {
        Some(plan) => server.set_contacts(robot, &plan.windows())?,
        None => server.contacts(robot)?,
    };
    Ok(ContactPlan::of_json(&serde_json::to_value(windows)?)?)
}

/// The list in a file, or in the standard input.
fn read(file: &Path) -> Result<ContactPlan> {
    let name = file.display();
    let text = list_text(open(file)?).with_context(|| format!("cannot read {name}"))?;
    ContactPlan::of_text(&text).with_context(|| format!("{name} is not used"))
}

/// A file, or the standard input.
pub(super) fn open(file: &Path) -> Result<Box<dyn Read>> {
    if file.to_str() == Some("-") {
        return Ok(Box::new(io::stdin()));
    }
    let opened = File::open(file);
    Ok(Box::new(opened.with_context(|| format!("cannot read {}", file.display()))?))
}

fn list_text(source: impl Read) -> Result<String> {
    let mut text = String::new();
    source.take(LIST_MAX + 1).read_to_string(&mut text)?;
    if text.len() as u64 > LIST_MAX {
        bail!("it is longer than {} MiB: a plan has at most 1,000 windows", LIST_MAX >> 20);
    }
    Ok(text)
}

fn json(windows: &[ContactWindow]) -> Result<String> {
    Ok(serde_json::to_string_pretty(windows)?)
}

/// One line for each contact. Past contacts have no sign.
fn in_words(plan: &ContactPlan, now_ms: u64) -> String {
    let lines = plan.contacts().iter().map(|contact| format!("{}\n", line(contact, now_ms)));
    match lines.collect::<String>() {
        lines if lines.is_empty() => "no contact planned\n".to_owned(),
        lines => lines,
    }
}

fn line(contact: &Contact, now_ms: u64) -> String {
    let Contact { begin_ms, end_ms, profile, note } = contact;
    let note = note.as_ref().map(|note| format!("  {}", harmless(note))).unwrap_or_default();
    let sign = match () {
        () if *end_ms <= now_ms => "over".to_owned(),
        () if *begin_ms <= now_ms => format!("open for {}", spell(end_ms - now_ms)),
        () => format!("in {}", spell(begin_ms - now_ms)),
    };
    let times = format!("{} to {}", utc_text(*begin_ms), utc_text(*end_ms));
    format!("{times}  {profile}  {sign}{note}")
}

fn spell(ms: u64) -> String {
    time(Duration::from_millis(ms))
}

#[cfg(test)]
mod tests {
    use super::{LIST_MAX, in_words, list_text};
    use crate::cli::LinkProfile;
    use clap::ValueEnum as _;
    use expect_test::expect;
    use rafcon_protocol::ContactPlan;
    use rafcon_protocol::calendar::utc_ms;
    use std::io::{Read as _, repeat};

    #[test]
    fn contacts_are_listed_with_their_state() {
        let plan = r#"[
            {"begin": "2026-11-28T12:00:00Z", "end": "2026-11-28T12:20:00Z", "profile": "lan"},
            {"begin": "2026-11-28T13:00:00Z", "end": "2026-11-28T13:20:00Z", "profile": "deep", "note": "Kiruna"},
            {"begin": "2026-11-28T14:30:00Z", "end": "2026-11-28T14:50:00Z", "profile": "deep"}
        ]"#;
        let now_ms = utc_ms("2026-11-28T13:05:00Z").unwrap();
        expect![[r"
            2026-11-28T12:00:00Z to 2026-11-28T12:20:00Z  lan  over
            2026-11-28T13:00:00Z to 2026-11-28T13:20:00Z  deep  open for 15:00  Kiruna
            2026-11-28T14:30:00Z to 2026-11-28T14:50:00Z  deep  in 1:25:00
        "]]
        .assert_eq(&in_words(&ContactPlan::of_text(plan).unwrap(), now_ms));
        assert_eq!(in_words(&ContactPlan::default(), now_ms), "no contact planned\n");
    }

    #[test]
    fn a_contact_can_have_every_profile_of_a_link() {
        for profile in LinkProfile::value_variants() {
            let name = profile.to_possible_value().unwrap().get_name().to_owned();
            let times = r#""begin": "2026-11-28T12:00:00Z", "end": "2026-11-28T12:20:00Z""#;
            ContactPlan::of_text(&format!(r#"[{{{times}, "profile": "{name}"}}]"#)).unwrap();
        }
    }

    #[test]
    fn a_list_has_at_most_so_many_bytes() {
        let read = |bytes: u64| list_text(repeat(b' ').take(bytes)).map(|text| text.len() as u64);
        assert_eq!(read(LIST_MAX).unwrap(), LIST_MAX);
        let refused = read(LIST_MAX + 9).unwrap_err().to_string();
        assert_eq!(refused, "it is longer than 2 MiB: a plan has at most 1,000 windows");
    }
}
