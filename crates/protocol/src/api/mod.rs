//! Content of the server's HTTP requests and responses. Defines data types only, without routes, sockets or files.

mod files;
mod history;
mod machines;
mod past;
mod people;
mod plans;
mod python;
mod robots;
mod run_wait;
mod runs;
mod server;
mod set_aside;
mod steps;
mod window;

pub use files::{
    FileNode, LibraryName, LibraryNode, LibraryNodeKind, LibraryRoot, LibraryUsage, LibraryUsages,
    MachineFile, MachineVersion, MachineVersions, NodeKind, Project, TreeFrom, UsagesOf,
};
pub use history::{
    EventDetail, EventQuery, ExportFormat, ExportQuery, FetchValue, KeptAs, KeptMachineQuery,
    KeptValue, LogLine, LogPage, LogQuery, MomentQuery, NamedValue, ValueFetch,
};
pub use machines::{
    CloseMachine, CopyStates, DiskState, Done, EditMachine, MachineAt, MachineDocument,
    MachineProblem, MachineStatus, MachineSummary, NewMachine, Presence, ReloadMachine, Repair,
    Revision, RevisionPage, RevisionsFrom, SaveMachine, SaveState, SavedState, Severity, Undo,
};
pub use past::{
    Comparison, DataChange, DataKind, Happened, Holding, Moment, MomentEnd, MomentState,
    OutcomeCount, Parting, StateStatistics, Statistics, TimeTaken, Timing,
};
pub use people::{
    ChangePassword, ChangeUser, Login, NewToken, NewUser, Right, Role, Session, TokenAbout,
    TokenMade, User,
};
pub use plans::{
    MakePlan, PlanDomain, PlanEnd, PlanEvent, PlanFinding, PlanFound, PlanGain, PlanNeed,
    PlanParameter, PlanPool, PlanRecovery, PlanRefused, PlanSignature, PlanSkill, PlanStep,
    PlanThen,
};
pub use python::{CheckScript, ScriptPlace, ScriptProblem};
pub use robots::{
    LineRequest, ListChange, ListRequest, ResumeRequest, RobotAnswer, RobotMachines, RobotRequest,
    StartAgain, StartOf, StartRequest, StartedRun,
};
pub use run_wait::RunWait;
pub use runs::{
    CommandAnswer, Control, ControlMove, EventPage, HistoryEntry, LinkState, LoadedMachine,
    OutputEnd, Pruned, ResumeRun, Retention, RunNow, RunOutput, RunPhase, RunResults, RunSummary,
    StartRun, StateAt,
};
pub use server::{Health, Refusal, ServerStatus};
pub use set_aside::{SetAsideDraft, SetAsideEdit};
pub use steps::{JumpMachine, MachineStep, MachineSteps, RevisionKind};
pub use window::{
    ActiveSince, Before, CallEnd, EarlierHistory, EarlierState, EndTime, EventTime, HitQuery,
    Overview, OverviewBar, OverviewQuery, OverviewRow, StatisticsQuery, Window, WindowQuery,
};
