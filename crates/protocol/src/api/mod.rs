//! What the server's HTTP requests and answers say. Knows words and shapes; must never know routes, sockets or files.

mod files;
mod house;
mod machines;
mod people;
mod refusal;
mod runs;

pub use files::{
    FileNode, LibraryNode, LibraryNodeKind, LibraryRoot, MachineFile, NodeKind, Project, TreeFrom,
};
pub use house::{Health, HouseStatus};
pub use machines::{
    CloseMachine, DiskState, EditMachine, MachineAt, MachineProblem, MachineStatus, MachineSummary,
    NewMachine, Presence, Revision, SaveMachine, Severity, Undo,
};
pub use people::{
    ChangePassword, ChangeUser, Login, NewToken, NewUser, Right, Role, Session, TokenAbout,
    TokenMade, User,
};
pub use refusal::Refusal;
pub use runs::{
    CommandAnswer, Control, ControlMove, EventPage, HistoryEntry, LinkState, Pruned, ResumeRun,
    Retention, RunNow, RunPhase, RunSummary, StartRun,
};
