//! How the link between a robot and its station is.

use crate::contacts::Contact;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// At a robot, users of its station have this after their names. No user's own name has an `@` in it.
pub const AT_STATION: &str = "@station";
/// At a station, users of a robot have this after their names.
pub const AT_ROBOT: &str = "@robot";

/// How the link to the other side is, as the side knows it that says so.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LinkHealth {
    /// The name of the robot.
    pub robot: String,
    /// Whether the other side is heard: else this is a blackout, or its program is not there.
    pub is_heard: bool,
    /// When the other side was heard last: ms since 1970, UTC, by the clock of whoever says so; none if it never was.
    pub heard_ms: Option<u64>,
    /// While the link is whole, the other side is heard at least this often, in ms.
    pub expected_every_ms: u64,
    /// When something left of which the other side said that it arrived: ms since 1970, UTC; none if it never said so. Known at a
    /// station only.
    pub reached_ms: Option<u64>,
    /// How long the way there and back takes, in ms; none if it is unknown. Known at a station only.
    pub round_trip_ms: Option<u64>,
    /// Lifetime of a command that has no expiry, in ms: two round trips, the uncertainty of the robot's clock, and 10 s. It counts from
    /// the begin of the next contact if none is open. Known at a station only.
    #[serde(default)]
    pub lifetime_ms: Option<u64>,
    /// Rate at which long commands are sent, in bytes per second. Known at a station only.
    #[serde(default)]
    pub command_bytes_per_s: Option<u64>,
    /// From the robot, in bytes per second, with the headers of IP and UDP.
    pub down_bytes_per_s: u64,
    /// To the robot, likewise.
    pub up_bytes_per_s: u64,
    /// Events that the robot has and the station lacks, as far as this side knows: of one run if it is told with that run.
    pub missing: u64,
    /// Commands whose fate is not known yet: of one run if it is told with that run. Known at a station only.
    pub commands: Vec<OpenCommand>,
    /// The open contact, or else the next one. Empty if no contact is planned. Known at a station only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub contact: Option<Contact>,
    /// Reason why the planned contacts are unknown, if they are. Known at a station only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub contacts_problem: Option<String>,
    /// By how much the robot's calendar is ahead. Known at a station only.
    pub clock: Option<ClockOffset>,
    /// Rights of the station's users on the robot, by the pairing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub rights: Option<LinkRights>,
}

/// Rights of a station's users on a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum LinkRights {
    /// See runs.
    Observe,
    /// Command and start runs as well.
    Command,
    /// Change what runs execute as well: scripts, machines, conditions.
    Change,
}

/// A command on its way to a robot, or its answer on the way back.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct OpenCommand {
    /// Its id, with the user's name before it.
    pub id: String,
    /// Type of the command; `resume_run` and `start_run` for requests about a whole run.
    #[serde(default)]
    pub asks: String,
    /// Its newest known stage.
    pub stage: CommandStage,
    /// When it was sent first: ms since 1970, UTC, by the station's clock.
    pub sent_ms: u64,
    /// Begin of the planned contact in which it is sent, by the station's clock. Empty if it is sent now or has arrived.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub send_at_ms: Option<u64>,
    /// When it arrives at the robot if the link is whole, likewise; none if the delay is unknown.
    pub arrives_ms: Option<u64>,
    /// Expected time of effect, by the station's clock. Empty if the delay is unknown or the run has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub effect_ms: Option<u64>,
    /// Expiry, likewise; none for a stop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub expires_ms: Option<u64>,
    /// Before which time it is not carried out, likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub not_before_ms: Option<u64>,
    /// Progress of a command that is sent in parts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub progress: Option<CommandProgress>,
}

/// Progress of a command that is sent in parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct CommandProgress {
    /// Bytes that the robot has reported.
    pub arrived_bytes: u64,
    /// Length of the command, as it is sent.
    pub bytes: u64,
}

/// Lifetime of commands over a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LinkLifetime {
    /// Lifetime of a short command, in ms.
    pub lifetime_ms: u64,
    /// Rate at which long commands are sent, in bytes per second.
    pub bytes_per_s: u64,
    /// Begin of the open or next contact, in ms since 1970, UTC, by the station's clock: a lifetime counts from there if it is later.
    pub contact_ms: Option<u64>,
}

impl LinkLifetime {
    /// Lifetime of a command whose JSON has this length, in ms: the time to send it is added twice, for parts that are lost.
    pub fn of_length(&self, bytes: u64) -> u64 {
        self.lifetime_ms.saturating_add(bytes.saturating_mul(2_000) / self.bytes_per_s.max(1))
    }
}

impl LinkHealth {
    /// Lifetime of commands over this link, if it is known.
    pub fn lifetime(&self) -> Option<LinkLifetime> {
        let (lifetime_ms, bytes_per_s) = (self.lifetime_ms?, self.command_bytes_per_s);
        let contact_ms = self.contact.as_ref().map(|contact| contact.begin_ms);
        Some(LinkLifetime { lifetime_ms, bytes_per_s: bytes_per_s.unwrap_or(u64::MAX), contact_ms })
    }
}

/// How far a command is that has no answer yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum CommandStage {
    /// It is sent repeatedly until the robot acknowledges it.
    Sent,
    /// The robot has it.
    Received,
    /// The run has it.
    Started,
    /// It expired without an answer. The station asks the robot until it answers.
    Overdue,
}

/// By how much one clock is ahead of another, in ms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ClockOffset {
    /// At least so much.
    pub least_ms: i64,
    /// At most so much; none without an up-link.
    pub most_ms: Option<i64>,
}

/// What `rafcon link` shows of one link.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkReport {
    /// Whether the station says so, or else the robot.
    pub is_station: bool,
    /// The name of the station, if the robot gave it one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub station: Option<String>,
    /// What keeps the station from keeping what arrives.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub problems: Vec<String>,
    /// The profile of the link.
    pub profile: String,
    /// When this was so: ms since 1970, UTC.
    pub now_ms: u64,
    /// How the link is.
    pub health: LinkHealth,
    /// Rate from the robot that the station's reports allow, in bytes per second. `None` at a station.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub send_bytes_per_s: Option<u64>,
    /// What was sent since the program began.
    pub sent: LinkTraffic,
    /// What was received since then.
    pub received: LinkTraffic,
    /// How many datagrams could not be used: of strangers, damaged, or received before.
    pub unusable: u64,
    /// Why the last one could not.
    pub unusable_because: Option<String>,
    /// The runs, by their ids.
    pub runs: Vec<LinkRun>,
}

/// The datagrams of one direction.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LinkTraffic {
    /// How many.
    pub datagrams: u64,
    /// Their bytes, with the headers of IP and UDP.
    pub bytes: u64,
    /// The bytes of what is in them, by its kind.
    pub by_kind: BTreeMap<String, u64>,
}

/// One run on a link.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkRun {
    /// Its id.
    pub id: String,
    /// The number of its last event, as far as this side knows.
    pub head: u64,
    /// Events that the station lacks, as far as this side knows.
    pub missing: u64,
}
