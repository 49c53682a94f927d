//! Open machines: what several people edit at the same time, with everyone's own steps back, and what is needed so that
//! nothing of it gets lost.
//!
//! Knows machines, their folders and who edits them. Does not know how people log in, nor what runs.

mod broadcast;
mod disk;
#[expect(
    clippy::module_inception,
    reason = "the type that holds all open machines stands in the file of its name"
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
