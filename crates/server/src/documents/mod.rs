//! Open machines: what several people edit at the same time, with everybody's own steps back, and what is needed so that
//! nothing of it gets lost.
//!
//! Knows machines, their folders and who edits them. Must never know how people log in, nor what runs.

mod disk;
#[expect(
    clippy::module_inception,
    reason = "the type that holds all open machines stands in the file of its name"
)]
mod documents;
mod draft;
mod kept;
mod log;
mod machine;
mod merge;
mod past;
mod places;
mod problems;
mod recover;
mod room;
mod routes;
mod save;
mod steps;
#[cfg(test)]
mod tests;
mod usages;
mod versions;
mod wires;

pub(crate) use documents::{Documents, Wish};
pub(crate) use log::Page;
pub(crate) use room::Room;
pub(crate) use routes::{change, routes};
