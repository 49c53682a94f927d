//! RAFCON's data on disk: the machine format, library paths, config, atomic saves, journals of runs.
//!
//! Handles files and folders, not execution: it never runs a state or calls Python.

pub mod config;
pub mod files;
pub mod journal;
mod packer;
pub mod problem;
pub mod read;
mod remedy;
mod staging;
mod whereabouts;
pub mod write;

pub use config::{Config, Environment, Naming};
pub use files::{Saved, StateFolder};
pub use packer::Packer;
pub use problem::{Fault, LoadError, LoadProblem, Wrong};
pub use read::libraries::{self, Libraries, Root, roots};
pub use read::{Loaded, fill_library, load, load_packed, state_from_core_data};
pub use remedy::remedy;
pub use write::{FormatError, Formatted, SaveError, core_data, format, save};
