//! Requests of a station's users to a robot that concern no program in progress: it starts one.

use super::{MachineFile, ResumeRun, StartRun};
use crate::Answer;
use serde::{Deserialize, Serialize};

/// A request of a station's server to a robot.
#[derive(Debug, Clone, PartialEq)]
pub enum RobotRequest {
    /// To resume a run after a crash.
    Resume(ResumeRequest),
    /// To start a new run.
    Start(StartRequest),
}

impl RobotRequest {
    /// Id, unique at the station.
    pub fn id(&self) -> &str {
        match self {
            Self::Resume(resume) => &resume.asked.id,
            Self::Start(start) => &start.id,
        }
    }
}

/// A user's request to resume a run, between a station and its robot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResumeRequest {
    /// Id of the run.
    pub run: String,
    /// Name of the user.
    pub user: String,
    /// Content, under an id unique at the station.
    pub asked: ResumeRun,
    /// End of its validity in ms since 1970, UTC, by this computer's clock. None: as is usual over the link, or without end.
    pub expiry_ms: Option<u64>,
}

/// A user's request to start a run, between a station and its robot.
#[derive(Debug, Clone, PartialEq)]
pub struct StartRequest {
    /// Unique at the station.
    pub id: String,
    /// Name of the user.
    pub user: String,
    /// Machine and settings of the new run.
    pub of: StartOf,
    /// End of its validity, as in [`ResumeRequest`].
    pub expiry_ms: Option<u64>,
    /// Reason why the request may bring no Python into the run, if it may not. Set by the robot.
    pub no_edit: Option<String>,
}

/// Machine and settings of a run to start. Serialized under short names, because it crosses the link.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum StartOf {
    /// A machine of the robot. The id in it does not count.
    #[serde(rename = "m")]
    Machine(Box<StartRun>),
    /// The machine of an earlier run of the robot, as it is on disk now, with the inputs and settings of that run; and whether the user
    /// may edit, which a breakpoint with a condition requires.
    #[serde(rename = "a")]
    Again(String, bool),
}

/// The machines in the projects of a robot, as its station knows them.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RobotMachines {
    /// When the robot made this list, by its calendar: ms since 1970, UTC. It makes another one after each change of its machines.
    #[cfg_attr(feature = "schema", ts(type = "number"))]
    pub made_ms: u64,
    /// The machines, the one that changed last first; at most 200.
    pub machines: Vec<MachineFile>,
    /// Number of further machines.
    pub more: u32,
}

/// Which command list of a robot is replaced.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct ListChange {
    /// Only the list of this revision. Without it, any.
    #[serde(default)]
    pub revision: Option<String>,
}

/// A release of the command list of a robot, between a station's server and its link.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListRequest {
    /// Revision of the list that was reviewed.
    pub revision: String,
    /// Name of the user, who becomes the author of the commands.
    pub user: String,
    /// Knowledge of the server about each line.
    pub lines: Vec<LineRequest>,
}

/// Knowledge of a station's server about a line that is to be released.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LineRequest {
    /// Fault of the user's rights or of control.
    pub fault: Option<String>,
    /// True if the command has an answer, or its run is over: then it is not sent again.
    pub is_settled: bool,
}

/// Answer to a request to a robot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RobotAnswer {
    /// It was carried out.
    Done {
        /// Id of the run that was started or resumed; empty for a command.
        run: String,
    },
    /// The robot refused it.
    Refused {
        /// Reason for the user, as the robot gave it.
        reason: String,
    },
    /// Nothing was done by the end of its validity.
    Expired,
    /// Nobody knows whether it was carried out.
    Unknown {
        /// Reason for the user.
        reason: String,
    },
}

impl From<Answer> for RobotAnswer {
    fn from(answer: Answer) -> Self {
        match answer {
            Answer::Applied => Self::Done { run: String::new() },
            Answer::Refused { reason } => Self::Refused { reason },
            Answer::Expired => Self::Expired,
            Answer::Unknown { reason } => Self::Unknown { reason },
        }
    }
}

impl RobotAnswer {
    /// The answer to a command.
    pub fn to_command(&self) -> Answer {
        match self.clone() {
            Self::Done { .. } => Answer::Applied,
            Self::Refused { reason } => Answer::Refused { reason },
            Self::Expired => Answer::Expired,
            Self::Unknown { reason } => Answer::Unknown { reason },
        }
    }
}

/// Request to repeat a run: inputs and settings are those of the earlier run, the machine is read from disk again.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct StartAgain {
    /// Chosen by the sender. Repetitions with this id start no second run.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
}

/// A run that was started.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct StartedRun {
    /// Id of the run.
    pub run: String,
    /// The robot that started it, if this is a station: what it sends of the run arrives after the delay of the link.
    pub robot: Option<String>,
}
