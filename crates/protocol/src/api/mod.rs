//! What the server's HTTP requests and answers say. Knows words and shapes; must never know routes, sockets or files.

mod files;
mod history;
mod library_usages;
mod machines;
mod past;
mod people;
mod python;
mod refusal;
mod run_wait;
mod runs;
mod server;
mod steps;
mod versions;

pub use files::{
    FileNode, LibraryNode, LibraryNodeKind, LibraryRoot, MachineFile, NodeKind, Project, TreeFrom,
};
pub use history::{
    EventDetail, EventQuery, ExportFormat, ExportQuery, KeptAs, KeptMachineQuery, KeptValue,
    LogLine, LogPage, LogQuery, MomentQuery, NamedValue,
};
pub use library_usages::{LibraryName, LibraryUsage, LibraryUsages, UsagesOf};
pub use machines::{
    CloseMachine, CopyStates, DiskState, Done, EditMachine, MachineAt, MachineDocument,
    MachineProblem, MachineStatus, MachineSummary, NewMachine, Presence, ReloadMachine, Repair,
    Revision, RevisionPage, RevisionsFrom, SaveMachine, SaveState, SavedState, Severity, Undo,
};
pub use past::{
    Comparison, DataChange, DataKind, Happened, Holding, OutcomeCount, Parting, Picture,
    PicturedEnd, PicturedState, StateStatistics, Statistics, TimeTaken, Timing,
};
pub use people::{
    ChangePassword, ChangeUser, Login, NewToken, NewUser, Right, Role, Session, TokenAbout,
    TokenMade, User,
};
pub use python::{CheckScript, ScriptPlace, ScriptProblem};
pub use refusal::Refusal;
pub use run_wait::RunWait;
pub use runs::{
    CommandAnswer, Control, ControlMove, EventPage, HistoryEntry, LinkState, LoadedMachine,
    OutputEnd, Pruned, ResumeRun, Retention, RunNow, RunOutput, RunPhase, RunSummary, StartRun,
    StateAt,
};
pub use server::{Health, ServerStatus};
pub use steps::{JumpMachine, MachineStep, MachineSteps, RevisionKind};
pub use versions::{MachineVersion, MachineVersions};
