//! Status of the link between a robot and its station.

use crate::contacts::Contact;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Suffix of the names of station users, at a robot. Names of users contain no `@`.
pub const AT_STATION: &str = "@station";
/// Suffix of the names of robot users, at a station.
pub const AT_ROBOT: &str = "@robot";

/// Health of a link, as known to the side that reports it.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LinkHealth {
    /// Name of the robot.
    pub robot: String,
    /// True while there is contact with the other side. False in a blackout, or if the other program is not running.
    pub is_heard: bool,
    /// Last contact: ms since 1970, UTC, by the reporter's clock. Empty before the first contact.
    pub heard_ms: Option<u64>,
    /// Maximum interval between messages from the other side while the link works, in ms.
    pub expected_every_ms: u64,
    /// Send time of the newest data that the other side acknowledged: ms since 1970, UTC. Empty before the first acknowledgement.
    /// Known at a station only.
    pub reached_ms: Option<u64>,
    /// Round-trip time, in ms. Empty if it is unknown. Known at a station only.
    pub round_trip_ms: Option<u64>,
    /// Lifetime of a command without expiry, in ms: two round trips, the uncertainty of the robot's clock, and 10 s. It counts from
    /// the begin of the next contact if none is open. Known at a station only.
    #[serde(default)]
    pub lifetime_ms: Option<u64>,
    /// Rate at which long commands are sent, in bytes per second. Known at a station only.
    #[serde(default)]
    pub command_bytes_per_s: Option<u64>,
    /// Rate from the robot, in bytes per second, including IP and UDP headers.
    pub down_bytes_per_s: u64,
    /// Rate to the robot, in bytes per second, including IP and UDP headers.
    pub up_bytes_per_s: u64,
    /// Number of events that the robot has and the station lacks, as far as this side knows. Counts one run if the report is about
    /// a run.
    pub missing: u64,
    /// Commands without a final result. Those of one run if the report is about a run. Known at a station only.
    pub commands: Vec<OpenCommand>,
    /// The open contact, or else the next one. Empty if no contact is planned. Known at a station only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub contact: Option<Contact>,
    /// Reason why the planned contacts are unknown, if they are. Known at a station only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub contacts_problem: Option<String>,
    /// Lead of the robot's clock over the station's. Known at a station only.
    pub clock: Option<ClockOffset>,
    /// Rights of the station's users on the robot, defined by the pairing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub rights: Option<LinkRights>,
}

/// Rights of a station's users on a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum LinkRights {
    /// See the robot's runs.
    Observe,
    /// Also command and start runs.
    Command,
    /// Also change what runs execute: scripts, machines, conditions.
    Change,
}

/// A command on its way to a robot, or its answer on the way back.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct OpenCommand {
    /// Id of the command, including the user's name.
    pub id: String,
    /// Type of the command; `resume_run` and `start_run` for requests about a whole run.
    #[serde(default)]
    pub asks: String,
    /// Its newest known stage.
    pub stage: CommandStage,
    /// First send time: ms since 1970, UTC, by the station's clock.
    pub sent_ms: u64,
    /// Begin of the planned contact in which it is sent, by the station's clock. Empty if it is sent now or has arrived.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub send_at_ms: Option<u64>,
    /// Expected arrival at the robot, by the station's clock. Empty if the delay is unknown.
    pub arrives_ms: Option<u64>,
    /// Expected time of effect, by the station's clock. Empty if the delay is unknown or the run has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub effect_ms: Option<u64>,
    /// Expiry, by the station's clock. Empty for a stop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub expires_ms: Option<u64>,
    /// Earliest time of effect, by the station's clock.
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
    /// Number of bytes that the robot has acknowledged.
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
    /// Begin of the open or next contact: ms since 1970, UTC, by the station's clock. A lifetime counts from it if it is in the
    /// future.
    pub contact_ms: Option<u64>,
}

impl LinkLifetime {
    /// Returns the lifetime of a command with this length of JSON, in ms. The time to send it counts twice, to allow for lost
    /// parts.
    pub fn of_length(&self, bytes: u64) -> u64 {
        self.lifetime_ms.saturating_add(bytes.saturating_mul(2_000) / self.bytes_per_s.max(1))
    }
}

impl LinkHealth {
    /// Returns the lifetime of commands over this link, if it is known.
    pub fn lifetime(&self) -> Option<LinkLifetime> {
        let (lifetime_ms, bytes_per_s) = (self.lifetime_ms?, self.command_bytes_per_s);
        let contact_ms = self.contact.as_ref().map(|contact| contact.begin_ms);
        Some(LinkLifetime { lifetime_ms, bytes_per_s: bytes_per_s.unwrap_or(u64::MAX), contact_ms })
    }
}

/// Stage of a command without a final result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum CommandStage {
    /// Sent repeatedly until the robot acknowledges it.
    Sent,
    /// Received by the robot.
    Received,
    /// Received by the run.
    Started,
    /// Expired without a reply. The station queries the robot until it replies.
    Overdue,
}

/// Range of the offset between two clocks, in ms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ClockOffset {
    /// Minimum offset, in ms.
    pub least_ms: i64,
    /// Maximum offset, in ms. Empty without an up-link.
    pub most_ms: Option<i64>,
}

/// Report of one link, for `rafcon link`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkReport {
    /// True for a report of the station, false for one of the robot.
    pub is_station: bool,
    /// Name of the station, if the robot defines one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub station: Option<String>,
    /// Faults that prevent the station from storing received data.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub problems: Vec<String>,
    /// Profile of the link.
    pub profile: String,
    /// Time of the report: ms since 1970, UTC.
    pub now_ms: u64,
    /// Health of the link.
    pub health: LinkHealth,
    /// Rate from the robot that the station's reports allow, in bytes per second. `None` at a station.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub send_bytes_per_s: Option<u64>,
    /// Datagrams sent since the program started.
    pub sent: LinkTraffic,
    /// Datagrams received since the program started.
    pub received: LinkTraffic,
    /// Number of unusable datagrams: from unknown senders, damaged, or duplicates.
    pub unusable: u64,
    /// Reason for the last unusable datagram.
    pub unusable_because: Option<String>,
    /// Runs on the link, sorted by id.
    pub runs: Vec<LinkRun>,
}

/// The datagrams of one direction.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LinkTraffic {
    /// Number of datagrams in this direction.
    pub datagrams: u64,
    /// Total size in bytes, including IP and UDP headers.
    pub bytes: u64,
    /// Size of the payload in bytes, by its kind.
    pub by_kind: BTreeMap<String, u64>,
}

/// One run on a link.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkRun {
    /// Id of the run.
    pub id: String,
    /// Sequence number of its last event, as far as this side knows.
    pub head: u64,
    /// Number of events that the station lacks, as far as this side knows.
    pub missing: u64,
}
