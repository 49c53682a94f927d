//! What lies on disk: RAFCON's format, library paths, config, atomic saves, journals of runs.
//!
//! Knows files and folders. Must never know execution: nothing here runs a state or asks Python.

pub mod calendar;
pub mod config;
pub mod files;
pub mod journal;
pub mod libraries;
pub mod place;
pub mod problem;
pub mod read;
mod whereabouts;
pub mod write;

#[cfg(test)]
mod testing;

pub use config::{Config, Environment, Naming};
pub use libraries::{Libraries, Root, roots};
pub use place::{Saved, StateFolder};
pub use problem::{Fault, LoadProblem, Wrong};
pub use read::{LoadError, Loaded, fill_library, load, load_packed, state_from_core_data};
pub use write::core_data;
pub use write::{FormatError, Formatted, SaveError, format, save};
