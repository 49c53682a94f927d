//! Lists of timed commands for one robot, which an operator composes, reviews and releases as one. Knows neither files nor clocks.

use crate::calendar::{utc_ms, utc_text};
use crate::contacts::ContactPlan;
use crate::{Answer, Command, CommandStage};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// Capacity of a list, in commands.
pub const LISTED_MAX: usize = 100;

/// The beginning of the ids of listed commands. Ids of other commands begin with the name of a user.
pub const LIST_ID: &str = "//list/";

/// A command of a list, as users write it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ListedCommand {
    /// Id of the run at the station.
    pub run: String,
    /// Command that the run gets.
    pub command: Command,
    /// Earliest time of effect. Without it, the command takes effect on arrival.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub not_before: Option<ListTime>,
    /// Expiry. Without it, the default over the link counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub expiry: Option<ListTime>,
}

/// A time in a list of commands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub enum ListTime {
    /// A time in UTC, such as `2026-11-28T14:05:00Z`.
    Utc(String),
    /// A time after the begin of a planned contact.
    Contact(ContactTime),
}

/// A time after the begin of a planned contact.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ContactTime {
    /// Begin of the contact in UTC, as in the plan of contacts.
    pub contact: String,
    /// Seconds after the begin.
    pub after_s: u32,
}

/// Times of a listed command, in ms since 1970, UTC, by the station's clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ListTimes {
    /// Earliest time of effect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_before_ms: Option<u64>,
    /// Expiry. `None` for the default over the link.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expiry_ms: Option<u64>,
}

/// Reason why a text is no list of commands.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum BadCommandList {
    /// It is no list in JSON.
    #[error(
        r#"the commands are no list in JSON ({0}): write [{{"run": "RUN", "command": {{"type": "pause"}}, "not_before": "2026-11-28T14:00:00Z"}}]"#
    )]
    NotJson(String),
    /// It is longer than the capacity.
    #[error("the list has {0} commands and the limit is {LISTED_MAX}: remove some of them")]
    TooMany(usize),
    /// One command is wrong.
    #[error("line {line}: {fault}")]
    Line {
        /// Number of the command in the list, from 1.
        line: usize,
        /// Description of the fault and its remedy.
        fault: String,
    },
}

/// A list of commands at a station, with the state of each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct CommandList {
    /// Revision. Each list that is set has another one. A release names the revision that was reviewed.
    pub revision: String,
    /// First release. Empty while the list is not released.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub released: Option<ListRelease>,
    /// The commands, in their order.
    pub lines: Vec<ListLine>,
}

/// Release of a list.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ListRelease {
    /// Time in ms since 1970, UTC, by the station's clock.
    pub at_ms: u64,
    /// Name of the user.
    pub user: String,
}

/// A command of a list at a station. Times are in ms since 1970, UTC, by the station's clock.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ListLine {
    /// The command, as it was set.
    pub listed: ListedCommand,
    /// Earliest time of effect, if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub not_before_ms: Option<u64>,
    /// Expiry. Before a release, the one that a release now would give. Empty if it is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub expires_ms: Option<u64>,
    /// Begin of the planned contact in which it is sent. Empty if it is sent at the release.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub send_at_ms: Option<u64>,
    /// Expected time of effect. Empty if the delay is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub effect_ms: Option<u64>,
    /// Fault and remedy. A list with a fault is not released.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub fault: Option<String>,
    /// Fate after a release.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub fate: Option<ListFate>,
}

/// Fate of a released command.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "fate", rename_all = "snake_case")]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub enum ListFate {
    /// The robot has not answered.
    Open {
        /// Newest stage that the station knows.
        stage: CommandStage,
    },
    /// It has an answer, which may be that its fate is unknown.
    Answered {
        /// Answer of the robot or the run.
        answer: Answer,
    },
}

/// Release of a list, as a user requests it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ReleaseList {
    /// Revision of the list that was reviewed. A list that was changed since is not released.
    pub revision: String,
}

impl ListTime {
    /// The time in ms since 1970; the error has the fault and the remedy.
    fn ms(&self, plan: &ContactPlan) -> Result<u64, String> {
        match self {
            Self::Utc(text) => read(text),
            Self::Contact(ContactTime { contact, after_s }) => {
                let begin_ms = read(contact)?;
                if !plan.contacts().iter().any(|contact| contact.begin_ms == begin_ms) {
                    return Err(format!(
                        "no planned contact begins at {}: choose a contact of `rafcon contacts`",
                        utc_text(begin_ms)
                    ));
                }
                Ok(begin_ms.saturating_add(u64::from(*after_s) * 1_000))
            }
        }
    }

    /// Checks that it names a time, whatever the plan of contacts.
    fn check(&self) -> Result<(), String> {
        let (Self::Utc(text) | Self::Contact(ContactTime { contact: text, .. })) = self;
        read(text).map(drop)
    }
}

fn read(text: &str) -> Result<u64, String> {
    let shown: String = text.chars().take(40).collect();
    let fault = || format!("{shown:?} is no time in UTC: write it like 2026-11-28T14:00:00Z");
    utc_ms(text).ok_or_else(fault)
}

impl ListedCommand {
    /// Reads a list of commands in JSON.
    pub fn list_of_text(text: &str) -> Result<Vec<Self>, BadCommandList> {
        let list = serde_json::from_str(text);
        Self::list_of_json(&list.map_err(|error| BadCommandList::NotJson(error.to_string()))?)
    }

    /// Reads a list of commands.
    pub fn list_of_json(list: &Value) -> Result<Vec<Self>, BadCommandList> {
        let Value::Array(list) = list else {
            return Err(BadCommandList::NotJson("it is another value".to_owned()));
        };
        if list.len() > LISTED_MAX {
            return Err(BadCommandList::TooMany(list.len()));
        }
        let line = |(index, value)| {
            let fault = |fault| BadCommandList::Line { line: index + 1, fault };
            Self::of_json(value).map_err(fault)
        };
        list.iter().enumerate().map(line).collect()
    }

    fn of_json(value: &Value) -> Result<Self, String> {
        for field in ["not_before", "expiry"] {
            let time = value.get(field).filter(|time| !time.is_null());
            if time.is_some_and(|time| ListTime::deserialize(time).is_err()) {
                return Err(format!(
                    r#"{field} is no time: write "2026-11-28T14:00:00Z" or {{"contact": "2026-11-28T14:00:00Z", "after_s": 30}}"#
                ));
            }
        }
        let listed = Self::deserialize(value).map_err(|error| {
            format!("{error}; a line has run, command and, if you like, not_before and expiry")
        })?;
        for (field, time) in [("not_before", &listed.not_before), ("expiry", &listed.expiry)] {
            let time = time.as_ref().map_or(Ok(()), ListTime::check);
            time.map_err(|fault| format!("{field}: {fault}"))?;
        }
        Ok(listed)
    }

    /// The times, or their fault and the remedy.
    fn times(&self, plan: &ContactPlan, now_ms: u64) -> Result<ListTimes, String> {
        let ms = |time: &Option<ListTime>| time.as_ref().map(|time| time.ms(plan)).transpose();
        let (not_before_ms, expiry_ms) = (ms(&self.not_before)?, ms(&self.expiry)?);
        if let Some(at_ms) = not_before_ms.filter(|at_ms| *at_ms <= now_ms) {
            return Err(format!("its time {} is past: choose a later one", utc_text(at_ms)));
        }
        if let Some(expiry_ms) = expiry_ms {
            let expiry = utc_text(expiry_ms);
            if expiry_ms <= now_ms {
                return Err(format!("its expiry {expiry} is past: choose a later one"));
            }
            if let Some(at_ms) = not_before_ms.filter(|at_ms| *at_ms >= expiry_ms) {
                return Err(format!(
                    "it expires at {expiry} and takes effect at {} at the earliest: correct one of the times",
                    utc_text(at_ms)
                ));
            }
            plan.check_expiry(now_ms, expiry_ms)?;
        }
        Ok(ListTimes { not_before_ms, expiry_ms })
    }
}

/// Times of all commands of a list, each with its fault if it has one.
///
/// Commands that arrive together have no order, so each further command of a run needs a later time than the one before.
pub fn list_times(
    list: &[ListedCommand],
    plan: &ContactPlan,
    now_ms: u64,
) -> Vec<Result<ListTimes, String>> {
    let mut before: BTreeMap<&str, (usize, u64)> = BTreeMap::new();
    let mut all = Vec::with_capacity(list.len());
    for (index, listed) in list.iter().enumerate() {
        let times = listed.times(plan, now_ms);
        let at_ms = times.as_ref().map(|times| times.not_before_ms.unwrap_or(0));
        let earlier = at_ms.ok().and_then(|at_ms| {
            let earlier = before.insert(&listed.run, (index + 1, at_ms))?;
            (earlier.1 >= at_ms).then_some(earlier.0)
        });
        all.push(match earlier {
            Some(line) => Err(format!(
                "it has no later time than line {line} of this run: give it a later not_before, or move it up"
            )),
            None => times,
        });
    }
    all
}

impl CommandList {
    /// Id of the command in this line, from 0. It does not depend on the user who releases the list.
    pub fn id(revision: &str, line: usize) -> String {
        format!("{LIST_ID}{revision}/{}", line + 1)
    }

    /// Sentences about all faults: number, command and run of each line.
    pub fn faults(&self) -> Vec<String> {
        let fault = |(index, line): (usize, &ListLine)| {
            let ListedCommand { run, command, .. } = &line.listed;
            let fault = line.fault.as_ref()?;
            Some(format!("line {} ({} of run {run}): {fault}", index + 1, command.type_name()))
        };
        self.lines.iter().enumerate().filter_map(fault).collect()
    }
}

#[cfg(test)]
mod tests;
