//! Open machines: concurrent editing, undo per user, and recovery of unsaved edits.
//!
//! Knows machines, their folders and their editors. Does not know logins or runs.

mod broadcast;
mod disk;
#[expect(
    clippy::module_inception,
    reason = "the file has the name of the type that holds all open machines"
)]
mod documents;
mod draft;
mod group_sync;
mod machine;
mod merge;
mod operation;
mod places;
mod problems;
mod recover;
mod refusal;
mod revision_log;
mod routes;
mod save;
mod session;
mod set_aside;
#[cfg(test)]
mod tests;
mod usages;
mod versions;

pub(crate) use documents::Documents;
pub(crate) use operation::{EditRequest, Operation};
pub(crate) use revision_log::RevisionsPage;
pub(crate) use routes::routes;
pub(crate) use session::MachineSession;
