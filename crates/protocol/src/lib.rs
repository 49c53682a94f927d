//! The commands, events and snapshots that cross a process border, and their version.
//!
//! Defines the content of messages, not their transport: no sockets, files or threads.
//!
//! A message is one JSON object, on a line or in a frame ([`frame`]). The first line in each direction is a [`Hello`]. A different
//! [`VERSION`] ends the connection with a reason. `docs/protocol.md` describes all messages.

pub mod active;
pub mod api;
pub mod bare;
pub mod breakpoint;
pub mod calendar;
pub mod command;
pub mod command_list;
pub mod contacts;
pub mod document;
pub mod edit;
pub mod event;
pub mod form;
pub mod frame;
pub mod hello;
pub mod launch;
pub mod link;
pub mod message;
pub mod question;
pub mod run;
pub mod socket;
pub mod watched;

pub use bare::{is_about_values, short_error, without_values};
pub use breakpoint::{Breakpoint, Scope, Unattended, When};
pub use command::{Answer, Command, Envelope, Expiry, Given};
pub use command_list::{
    BadCommandList, CommandList, ContactTime, LIST_ID, LISTED_MAX, ListFate, ListLine, ListRelease,
    ListTime, ListTimes, ListedCommand, ReleaseList, list_times,
};
pub use contacts::{
    BadContacts, Contact, ContactPlan, ContactWindow, ExpectedTimes, GivenTimes, WINDOWS_MAX,
    wait_for_contact,
};
pub use event::{
    ActiveState, Event, HeldBy, Hold, LogLevel, Loss, Outcome, Phase, RunStatus, Snapshot, Stream,
    Values,
};
pub use frame::{
    FRAME_HEAD, FrameError, FrameKind, decode, encode, encode_frame, frame_head, read_frame,
    read_frame_head,
};
pub use hello::{Hello, VERSION, VersionMismatch};
pub use launch::{Beginning, Launch};
pub use link::{
    AT_ROBOT, AT_STATION, ClockOffset, CommandProgress, CommandStage, LinkHealth, LinkLifetime,
    LinkReport, LinkRights, LinkRun, LinkTraffic, OpenCommand,
};
pub use message::{EnginePulse, Join, StateData, ToRunner, ToViewer};
pub use question::{Closing, Form, Question};
pub use run::{Afterwards, Crash, Keeping, OnCrash, Resume};
pub use watched::{LongValue, WATCHED_MAX, WatchKind, WatchTarget, WatchedValue, Watching};
