//! The commands and options of the link between robots and stations.

use super::remote::Remote;
use super::serve::{Serve, State};
use clap::{Args, ValueEnum};
use rafcon_relay::PairingRights;
use std::net::SocketAddr;
use std::path::PathBuf;

/// Serve the runs of robots far away, and command them.
///
/// Robots send their runs to the address of `--listen`; each becomes an ordinary run here. First pair the robot with this station
/// (`rafcon pair`). All else is as with `rafcon serve`.
#[derive(Debug, Args)]
pub(crate) struct Station {
    /// Address at which robots are received, by UDP, and by TCP over a WebSocket
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:4748")]
    pub(crate) listen: SocketAddr,
    #[command(flatten)]
    pub(crate) serve: Serve,
}

/// What a robot's server needs to send its runs to a station.
#[derive(Debug, Args)]
pub(crate) struct Link {
    /// Send the runs to the station at this address, such as `udp://ground.example:4748`, or `wss://ground.example:4748` where UDP
    /// is closed
    ///
    /// Repeat it for several stations, with the name of each in its pairing: `--station base=udp://ground.example:4748`.
    #[arg(long = "station", value_name = "[NAME=]ADDRESS")]
    pub(crate) stations: Vec<String>,
    /// Fingerprint of the station's certificate for `wss://`, as `rafcon station` prints it; it is saved
    ///
    /// Repeat it for several stations at `wss://`, in their order.
    #[arg(long = "station-fingerprint", value_name = "HEX", requires = "stations")]
    pub(crate) station_fingerprints: Vec<String>,
    /// Name of this robot in its pairing; needed only if there are several
    #[arg(long, value_name = "NAME", requires = "stations")]
    pub(crate) robot: Option<String>,
    /// Properties of the link
    #[arg(long = "link", value_enum, default_value = "wifi", value_name = "PROFILE")]
    pub(crate) profile: LinkProfile,
}

/// Initial assumptions about a link, until it is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum LinkProfile {
    /// A cable or a good wireless network: 50 Mbit/s
    Lan,
    /// A wireless network at the edge of its range: 4 Mbit/s down, 1 Mbit/s up
    Wifi,
    /// Seconds of delay and long blackouts: 256 kbit/s down, 32 kbit/s up
    #[value(name = "delay-2s")]
    Delay2s,
    /// Minutes of delay: 8 kbit/s down, 1 kbit/s up
    Deep,
}

/// Pair a robot with a station: both get the key with which they talk.
///
/// On the robot, `rafcon pair NAME` makes the key and prints a line. On the station, `rafcon pair --paste` reads that line. Each
/// station of a robot needs a pairing of its own, with its name: `rafcon pair NAME --station STATION`.
#[derive(Debug, Args)]
pub(crate) struct Pair {
    /// Name of the robot: letters, digits, `.`, `-`, `_`
    #[arg(value_name = "NAME", required_unless_present = "paste", conflicts_with = "paste")]
    pub(crate) robot: Option<String>,
    /// Name of the station, for a robot with several
    #[arg(long, value_name = "STATION", requires = "robot")]
    pub(crate) station: Option<String>,
    /// Rights of the station on the robot
    ///
    /// `observe`: see runs. `command`: command them, too. `change`: also change scripts, reload machines and set conditions, which
    /// runs any Python on the robot. The robot checks it.
    #[arg(long, value_name = "RIGHTS", default_value = "command", conflicts_with_all = ["paste", "renew"])]
    pub(crate) rights: PairingRights,
    /// On the robot: make another key and offer it to the station over the link
    ///
    /// Both sides use the old key until the robot receives a signal of the station with the new one. `rafcon link` shows whether the
    /// offer is pending.
    #[arg(long, requires = "robot")]
    pub(crate) renew: bool,
    /// Read the line that the robot printed
    #[arg(long)]
    pub(crate) paste: bool,
    #[command(flatten)]
    pub(crate) state: State,
}

/// Show how the links of this computer's robots or station are.
///
/// For each link: the age of the last signal of the other side, the round trip, what was sent and received, and which events the station
/// still lacks. Works while `rafcon serve --station` or `rafcon station` runs.
#[derive(Debug, Args)]
pub(crate) struct LinkStatus {
    /// Print each link as one line of JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) state: State,
}

/// Show or set the planned contacts with a robot.
///
/// A contact is a window of time in which the station expects a link to the robot. The plan sets the expected times of commands and
/// the begin of their lifetimes; the station sends outside of contacts, too. The file is a list in JSON:
/// `[{"begin": "2026-11-28T14:00:00Z", "end": "2026-11-28T14:20:00Z", "profile": "deep", "note": "Kiruna"}]`, in the order of the
/// times, without overlaps. A list that is refused changes nothing.
#[derive(Debug, Args)]
pub(crate) struct Contacts {
    /// Name of the robot at its station
    pub(crate) robot: String,
    /// Replace the plan by the one in this file; `-` reads the standard input
    #[arg(long, value_name = "FILE")]
    pub(crate) set: Option<PathBuf>,
    /// Remove the plan of contacts
    #[arg(long, conflicts_with = "set")]
    pub(crate) clear: bool,
    /// Output format; with `json` the output can be set again
    #[arg(long, value_enum, default_value_t = ListFormat::Text)]
    pub(crate) format: ListFormat,
    #[command(flatten)]
    pub(crate) remote: Remote,
}

/// List the machines in the projects of a robot, which it can start.
///
/// The robot sends the list to its station after each change. `rafcon run PROJECT/FOLDER --robot ROBOT --server URL` starts a machine
/// of it.
#[derive(Debug, Args)]
pub(crate) struct Machines {
    /// Name of the robot at its station
    pub(crate) robot: String,
    /// Output format
    #[arg(long, value_enum, default_value_t = ListFormat::Text)]
    pub(crate) format: ListFormat,
    #[command(flatten)]
    pub(crate) remote: Remote,
}

/// Show, set or release the list of timed commands for a robot.
///
/// A list is composed and reviewed before a pass, and released as one: all of its commands are sent, or none. The file is a list in JSON:
/// `[{"run": "RUN", "command": {"type": "resume"}, "not_before": "2026-11-28T14:05:00Z", "expiry": {"contact": "2026-11-28T14:00:00Z",
/// "after_s": 900}}]`. A time is in UTC, or counts from the begin of a planned contact; both times may be missing. The further commands of a
/// run need rising times. A list has at most 100 commands.
#[derive(Debug, Args)]
pub(crate) struct CommandList {
    /// Name of the robot at its station
    pub(crate) robot: String,
    /// Replace the list by the one in this file; `-` reads the standard input
    #[arg(long, value_name = "FILE")]
    pub(crate) set: Option<PathBuf>,
    /// Remove the list
    #[arg(long, conflicts_with = "set")]
    pub(crate) clear: bool,
    /// Release the list; with a revision, only if the list still has it
    ///
    /// Needs --server. A second release sends the same commands again, as far as their fate is unknown; the robot carries out each
    /// at most once.
    #[arg(
        long,
        value_name = "REVISION",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "",
        conflicts_with_all = ["set", "clear"]
    )]
    pub(crate) release: Option<String>,
    /// Output format; with `json` the output can be set again
    #[arg(long, value_enum, default_value_t = ListFormat::Text)]
    pub(crate) format: ListFormat,
    #[command(flatten)]
    pub(crate) remote: Remote,
}

/// Output format of planned contacts and command lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ListFormat {
    /// Lines for people
    Text,
    /// The list in JSON
    Json,
}
