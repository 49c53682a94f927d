//! Messages between a station and a robot's server, inside commands and status.

use rafcon_protocol::api::{Control, ControlMove, StartOf};
use rafcon_protocol::{AT_ROBOT, Command, Envelope, OnCrash};
use serde::{Deserialize, Serialize};

/// Limit of named users who request control: the status has to fit into a datagram.
const REQUESTS_MAX: usize = 4;

/// Message of a station. Its names are short, because it has to fit into small datagrams.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum StationRequest {
    /// A command: id, author, the last event that the author had seen, and what is asked.
    #[serde(rename = "c")]
    Command(String, String, Option<u64>, Command),
    /// Request about control: id, author and move.
    #[serde(rename = "m")]
    MoveControl(String, String, ControlMove),
    /// A user who holds control is here.
    #[serde(rename = "p")]
    Present(String),
    /// A run whose runner died is to be resumed: id, author, the run's id, what becomes of interrupted scripts, and the event of the
    /// history to begin at, if not the end. The station may number the run otherwise than the robot, so its id is named.
    #[serde(rename = "r")]
    Resume(String, String, String, OnCrash, Option<u64>),
    /// A run is to be started: id, author, and what.
    #[serde(rename = "s")]
    Start(String, String, StartOf),
}

impl StationRequest {
    pub(crate) fn of(envelope: Envelope) -> Self {
        let Envelope { id, author, decided_on, command, .. } = envelope;
        Self::Command(id, author, decided_on, command)
    }

    /// Its type, as it is shown.
    pub(crate) fn asks(&self) -> &'static str {
        match self {
            Self::Command(_, _, _, command) => command.type_name(),
            Self::MoveControl(..) => "move_control",
            Self::Present(_) => "present",
            Self::Resume(..) => "resume_run",
            Self::Start(..) => "start_run",
        }
    }
}

/// Fate of a run by its robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(crate) enum RunFate {
    /// It continues.
    #[default]
    #[serde(rename = "l")]
    Live,
    /// It has ended.
    #[serde(rename = "f")]
    Finished,
    /// Its runner died.
    #[serde(rename = "c")]
    Crashed,
    /// It was deleted on the robot: what the station has of it stays.
    #[serde(rename = "r")]
    Removed,
}

/// State of a run, as its robot reports it with each status.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct ReportedRunState {
    #[serde(rename = "f")]
    pub(crate) fate: RunFate,
    #[serde(rename = "h", skip_serializing_if = "Option::is_none")]
    holder: Option<String>,
    #[serde(rename = "s", skip_serializing_if = "is_zero")]
    since_ms: u64,
    #[serde(rename = "q", skip_serializing_if = "is_zero")]
    silence_ms: u64,
    /// The silence of the holder allows others to take over.
    #[serde(rename = "i", skip_serializing_if = "std::ops::Not::not")]
    is_silent: bool,
    #[serde(rename = "r", skip_serializing_if = "Vec::is_empty")]
    requests: Vec<String>,
    #[serde(rename = "o", skip_serializing_if = "Option::is_none")]
    offered_to: Option<String>,
    #[serde(rename = "e", skip_serializing_if = "is_zero")]
    epoch: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks so")]
fn is_zero(number: &u64) -> bool {
    *number == 0
}

impl ReportedRunState {
    /// At this time of the robot's calendar.
    pub(crate) fn of(fate: RunFate, control: Option<Control>, now_ms: u64) -> Self {
        let Some(control) = control else { return Self { fate, ..Self::default() } };
        let Control { holder, since_ms, heard_ms, silence_ms, requests, offered_to, epoch } =
            control;
        let requests = requests.into_iter().take(REQUESTS_MAX).collect();
        let is_silent = holder.is_some() && now_ms.saturating_sub(heard_ms) >= silence_ms;
        Self { fate, holder, since_ms, silence_ms, is_silent, requests, offered_to, epoch }
    }

    /// Control of the run with the names of users at this station, received at `now_ms`. `None` if the robot did not report it.
    pub(crate) fn control(&self, station: &str, now_ms: u64) -> Option<Control> {
        let Self { holder, since_ms, silence_ms, is_silent, requests, offered_to, .. } = self;
        let heard_ms = if *is_silent { now_ms.saturating_sub(*silence_ms) } else { now_ms };
        (*silence_ms > 0).then(|| Control {
            holder: holder.as_deref().map(|name| here(name, station)),
            since_ms: *since_ms,
            heard_ms,
            silence_ms: *silence_ms,
            requests: requests.iter().map(|name| here(name, station)).collect(),
            offered_to: offered_to.as_deref().map(|name| here(name, station)),
            epoch: self.epoch,
        })
    }
}

/// Name at the robot of a user of this station. Whatever the station sends, it never equals the name of a user of the robot or
/// of another station.
pub(crate) fn author_at_robot(user: &str, station: &str) -> String {
    // A command on the station's own computer, without its server, is from its owner.
    let user = if user.is_empty() { "owner" } else { user };
    format!("{}@{station}", user.replace('@', "-"))
}

/// Name at the robot of a user of this station. No user's own name contains an `@`.
pub(crate) fn at_robot(user: &str, station: &str) -> String {
    match user.strip_suffix(AT_ROBOT) {
        Some(user) => user.to_owned(),
        None if user.contains('@') => user.to_owned(),
        None => format!("{user}@{station}"),
    }
}

/// Name at this station of a user of the robot.
fn here(user: &str, station: &str) -> String {
    match user.split_once('@') {
        Some((name, at)) if at == station => name.to_owned(),
        Some(_) => user.to_owned(),
        None => format!("{user}{AT_ROBOT}"),
    }
}

#[cfg(test)]
mod tests {
    use super::{ReportedRunState, RunFate, StationRequest, at_robot, author_at_robot, here};
    use expect_test::expect;
    use rafcon_protocol::Command;
    use rafcon_protocol::api::{Control, ControlMove};

    #[test]
    fn words_are_short() {
        let run_to = Command::RunTo { path: "ROOT01/ABCDEF".to_owned() };
        let id = "ana/0f8c2f0e-5b7e-4a3e-9e0c-5c0b7f1f7a11".to_owned();
        let control = Control {
            holder: Some("ana@station".to_owned()),
            since_ms: 1_764_000_000_000,
            heard_ms: 1_764_000_000_000,
            silence_ms: 30_000,
            epoch: 3,
            ..Control::default()
        };
        let words = [
            serde_json::to_string(&StationRequest::Command(id, "ana".to_owned(), Some(7), run_to)),
            serde_json::to_string(&StationRequest::MoveControl(
                "1".to_owned(),
                "ana".to_owned(),
                ControlMove::TakeOver,
            )),
            serde_json::to_string(&StationRequest::Present("ana".to_owned())),
            serde_json::to_string(&ReportedRunState::of(RunFate::Live, None, 0)),
            serde_json::to_string(&ReportedRunState::of(
                RunFate::Live,
                Some(control),
                1_764_000_001_000,
            )),
        ];
        let words: Vec<_> = words.into_iter().map(Result::unwrap).collect();
        expect![[r#"
            {"c":["ana/0f8c2f0e-5b7e-4a3e-9e0c-5c0b7f1f7a11","ana",7,{"type":"run_to","path":"ROOT01/ABCDEF"}]}
            {"m":["1","ana",{"move":"take_over"}]}
            {"p":"ana"}
            {"f":"l"}
            {"f":"l","h":"ana@station","s":1764000000000,"q":30000,"e":3}"#]]
        .assert_eq(&words.join("\n"));
    }

    #[test]
    fn users_of_all_sides_are_told_apart() {
        let names = ["ana", "cy@robot", "bo@base"];
        let at_robot = names.map(|name| at_robot(name, "field"));
        assert_eq!(at_robot, ["ana@field", "cy", "bo@base"]);
        assert_eq!(at_robot.map(|name| here(&name, "field")), names);
    }

    #[test]
    fn nobody_at_a_station_speaks_as_a_user_of_the_robot_or_of_another_station() {
        let names = ["", "ana", "cy@robot", "cy@base"].map(|name| author_at_robot(name, "field"));
        assert_eq!(names, ["owner@field", "ana@field", "cy-robot@field", "cy-base@field"]);
    }

    #[test]
    fn a_status_is_short_however_many_ask_for_control() {
        let requests = vec!["a".repeat(64); 64];
        let control = Control { requests, silence_ms: 1, ..Control::default() };
        let reported = ReportedRunState::of(RunFate::Live, Some(control), 0);
        assert!(serde_json::to_vec(&reported).expect("words").len() < 400);
    }

    #[test]
    fn a_holder_who_was_silent_for_long_can_be_taken_over_at_the_station_too() {
        let holder = Some("cy".to_owned());
        let control = Control { holder, heard_ms: 1_000, silence_ms: 500, ..Control::default() };
        let heard = |now_ms| {
            let reported = ReportedRunState::of(RunFate::Live, Some(control.clone()), now_ms);
            let control = reported.control("station", 90_000).expect("control");
            (control.holder.expect("a holder"), 90_000 - control.heard_ms)
        };
        assert_eq!(heard(1_499), ("cy@robot".to_owned(), 0));
        assert_eq!(heard(1_500), ("cy@robot".to_owned(), 500));
    }
}
