//! Planned contacts with a robot: the windows in which its station expects a link. Knows neither files nor clocks.

use crate::calendar::{utc_ms, utc_text};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Capacity of a plan, in windows.
pub const WINDOWS_MAX: usize = 1_000;
/// Maximum length of a note, in characters.
const NOTE_MAX: usize = 200;
/// A wait is extended by this part of it: two clocks drift apart by 1 ms in 5 s at most, and the link shortens a lifetime by as much.
const DRIFT_PART: u64 = 2_500;
/// Names of the link profiles.
const PROFILES: [&str; 4] = ["lan", "wifi", "delay-2s", "deep"];

/// A contact window, as users write it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ContactWindow {
    /// Begin in UTC, such as `2026-11-28T14:00:00Z`.
    pub begin: String,
    /// End in UTC, after the begin.
    pub end: String,
    /// Link profile that is expected: `lan`, `wifi`, `delay-2s` or `deep`.
    pub profile: String,
    /// Note of the planner, in one line of at most 200 characters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub note: Option<String>,
}

/// A planned contact with a robot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Contact {
    /// Begin in ms since 1970, UTC, by the station's clock.
    pub begin_ms: u64,
    /// End by the station's clock. The contact is over at this time.
    pub end_ms: u64,
    /// Link profile that is expected.
    pub profile: String,
    /// Note of the planner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub note: Option<String>,
}

/// Contacts with one robot, in their order, without overlap.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ContactPlan(Vec<Contact>);

/// Reason why a list of windows is no plan.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum BadContacts {
    /// It is no list of windows.
    #[error(
        r#"the contacts are no list in JSON ({0}): write [{{"begin": "2026-11-28T14:00:00Z", "end": "2026-11-28T14:20:00Z", "profile": "deep"}}]"#
    )]
    NotJson(String),
    /// It is longer than the capacity.
    #[error("the list has {0} windows and the limit is {WINDOWS_MAX}: remove the latest ones")]
    TooMany(usize),
    /// One window is wrong.
    #[error("{window}: {fault}")]
    Window {
        /// Number and times of the window.
        window: String,
        /// Description of the fault and its remedy.
        fault: String,
    },
    /// No window ends in the future.
    #[error(
        "{window}: this last window is in the past; add a window that ends after {now}, or clear the contacts"
    )]
    Past {
        /// Number and times of the last window.
        window: String,
        /// Time of the check.
        now: String,
    },
}

/// Times of a command that waits for a robot, in ms since 1970, UTC.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GivenTimes {
    /// Time at which the command was given.
    pub given_ms: u64,
    /// Time from a send to the arrival, if the delay was measured.
    pub delay_ms: Option<u64>,
    /// Earliest time of effect, if the command has one.
    pub not_before_ms: Option<u64>,
}

/// Expected times of a command that waits for a robot, in ms since 1970, UTC. An unknown time is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExpectedTimes {
    /// Begin of the contact in which it is sent; `None` if it is sent now.
    pub send_at_ms: Option<u64>,
    /// Arrival at the robot.
    pub arrives_ms: Option<u64>,
    /// Effect at the robot.
    pub effect_ms: Option<u64>,
}

/// Part of a lifetime before the next contact, in ms: the wait, and the drift of the clocks in it.
pub fn wait_for_contact(now_ms: u64, begin_ms: u64) -> u64 {
    let wait_ms = begin_ms.saturating_sub(now_ms);
    wait_ms + wait_ms / DRIFT_PART
}

impl ContactPlan {
    /// Reads a list of windows in JSON.
    pub fn of_text(text: &str) -> Result<Self, BadContacts> {
        let windows: Value =
            serde_json::from_str(text).map_err(|error| BadContacts::NotJson(error.to_string()))?;
        Self::of_json(&windows)
    }

    /// Reads a list of windows.
    pub fn of_json(windows: &Value) -> Result<Self, BadContacts> {
        let Value::Array(windows) = windows else {
            return Err(BadContacts::NotJson("it is another value".to_owned()));
        };
        if windows.len() > WINDOWS_MAX {
            return Err(BadContacts::TooMany(windows.len()));
        }
        let mut contacts: Vec<Contact> = Vec::with_capacity(windows.len());
        for (index, window) in windows.iter().enumerate() {
            let number = index + 1;
            let fault = |fault| BadContacts::Window { window: format!("window {number}"), fault };
            let contact = contact(window).map_err(fault)?;
            check_order(number, contacts.last(), &contact)?;
            contacts.push(contact);
        }
        Ok(Self(contacts))
    }

    /// Refuses a plan whose contacts are all over. A plan without contacts is valid.
    pub fn check_future(&self, now_ms: u64) -> Result<(), BadContacts> {
        match self.0.last() {
            Some(last) if last.end_ms <= now_ms => {
                Err(BadContacts::Past { window: last.named(self.0.len()), now: utc_text(now_ms) })
            }
            _ => Ok(()),
        }
    }

    /// The contacts, in their order.
    pub fn contacts(&self) -> &[Contact] {
        &self.0
    }

    /// The windows, as users write them.
    pub fn windows(&self) -> Vec<ContactWindow> {
        let window = |contact: &Contact| ContactWindow {
            begin: utc_text(contact.begin_ms),
            end: utc_text(contact.end_ms),
            profile: contact.profile.clone(),
            note: contact.note.clone(),
        };
        self.0.iter().map(window).collect()
    }

    /// The open contact, or else the next one.
    pub fn current(&self, now_ms: u64) -> Option<&Contact> {
        self.0.get(self.0.partition_point(|contact| contact.end_ms <= now_ms))
    }

    /// Begin of the next contact. `None` while a contact is open, and if none is planned.
    pub fn next_begin(&self, now_ms: u64) -> Option<u64> {
        self.current(now_ms).map(|contact| contact.begin_ms).filter(|begin_ms| *begin_ms > now_ms)
    }

    /// Refuses an expiry before the next contact: the command could not be sent in its time.
    pub fn check_expiry(&self, now_ms: u64, expiry_ms: u64) -> Result<(), String> {
        match self.next_begin(now_ms) {
            Some(begin_ms) if expiry_ms <= begin_ms => Err(format!(
                "the command would expire at {}, and the next contact begins at {}: let it expire later than that, or change the contacts",
                utc_text(expiry_ms),
                utc_text(begin_ms)
            )),
            _ => Ok(()),
        }
    }

    /// Expected times of a command that the robot has not confirmed.
    pub fn expected(&self, given: GivenTimes, now_ms: u64) -> ExpectedTimes {
        let GivenTimes { given_ms, delay_ms, not_before_ms } = given;
        let begin_ms = self.current(now_ms).map_or(given_ms, |contact| contact.begin_ms);
        let sent_ms = given_ms.max(begin_ms);
        let arrives_ms = delay_ms.map(|delay_ms| sent_ms.saturating_add(delay_ms));
        ExpectedTimes {
            send_at_ms: Some(sent_ms).filter(|sent_ms| *sent_ms > now_ms),
            arrives_ms,
            effect_ms: arrives_ms.map(|arrives_ms| arrives_ms.max(not_before_ms.unwrap_or(0))),
        }
    }
}

impl Contact {
    /// True between begin and end.
    pub fn is_open(&self, now_ms: u64) -> bool {
        (self.begin_ms..self.end_ms).contains(&now_ms)
    }

    fn named(&self, number: usize) -> String {
        format!("window {number} ({} to {})", utc_text(self.begin_ms), utc_text(self.end_ms))
    }
}

/// Reads one window; the error has its fault and the remedy.
fn contact(window: &Value) -> Result<Contact, String> {
    let window: ContactWindow = ContactWindow::deserialize(window).map_err(|error| {
        format!("{error}; a window has begin, end, profile and, if you like, a note")
    })?;
    let ContactWindow { begin, end, profile, note } = window;
    let begin_ms = time("begin", &begin)?;
    let end_ms = time("end", &end)?;
    if !PROFILES.contains(&&*profile) {
        return Err(format!(
            "the profile {} is unknown: write lan, wifi, delay-2s or deep",
            quoted(&profile)
        ));
    }
    let note = note.filter(|note| !note.is_empty());
    if note.as_ref().is_some_and(|note| !is_note(note)) {
        return Err(format!("the note is no line of at most {NOTE_MAX} characters: shorten it"));
    }
    Ok(Contact { begin_ms, end_ms, profile, note })
}

fn check_order(
    number: usize,
    before: Option<&Contact>,
    contact: &Contact,
) -> Result<(), BadContacts> {
    let fault = match before {
        _ if contact.end_ms <= contact.begin_ms => {
            "it does not end after its begin: correct one of the times".to_owned()
        }
        Some(before) if contact.end_ms <= before.begin_ms => {
            format!(
                "it is earlier than {}: put the windows in the order of their times",
                before.named(number - 1)
            )
        }
        Some(before) if contact.begin_ms < before.end_ms => {
            format!(
                "it overlaps {}: let it begin at {} or later, or make one window of both",
                before.named(number - 1),
                utc_text(before.end_ms)
            )
        }
        _ => return Ok(()),
    };
    Err(BadContacts::Window { window: contact.named(number), fault })
}

fn time(field: &str, text: &str) -> Result<u64, String> {
    utc_ms(text).ok_or_else(|| {
        format!(
            "the {field} {} is no time in UTC: write it like 2026-11-28T14:00:00Z",
            quoted(text)
        )
    })
}

/// The beginning of a text, for an error.
fn quoted(text: &str) -> String {
    format!("{:?}", text.chars().take(40).collect::<String>())
}

fn is_note(note: &str) -> bool {
    note.chars().count() <= NOTE_MAX && !note.chars().any(char::is_control)
}

#[cfg(test)]
mod tests;
