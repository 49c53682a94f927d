//! What the server's HTTP requests and answers say. Knows words and shapes; must never know routes, sockets or files.

mod files;
mod history;
mod house;
mod machines;
mod past;
mod people;
mod refusal;
mod runs;

pub use files::{
    FileNode, LibraryNode, LibraryNodeKind, LibraryRoot, MachineFile, NodeKind, Project, TreeFrom,
};
pub use history::{
    EventDetail, EventQuery, ExportFormat, ExportQuery, KeptAs, KeptMachineQuery, KeptValue,
    LogLine, LogPage, LogQuery, MomentQuery, NamedValue,
};
pub use house::{Health, HouseStatus};
pub use machines::{
    CloseMachine, CopyStates, DiskState, Done, EditMachine, MachineAt, MachineDocument,
    MachineProblem, MachineStatus, MachineSummary, NewMachine, Presence, ReloadMachine, Revision,
    RevisionPage, RevisionsFrom, SaveMachine, Severity, Undo,
};
pub use past::{
    Comparison, DataChange, DataKind, Happened, Holding, OutcomeCount, Parting, Picture,
    PicturedEnd, PicturedState, StateStatistics, Statistics, TimeTaken, Timing,
};
pub use people::{
    ChangePassword, ChangeUser, Login, NewToken, NewUser, Right, Role, Session, TokenAbout,
    TokenMade, User,
};
pub use refusal::Refusal;
pub use runs::{
    CommandAnswer, Control, ControlMove, EventPage, HistoryEntry, LinkState, LoadedMachine,
    OutputEnd, Pruned, ResumeRun, Retention, RunNow, RunOutput, RunPhase, RunSummary, StartRun,
    StateAt,
};
