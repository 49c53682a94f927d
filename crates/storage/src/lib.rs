//! What lies on disk: RAFCON's format, library paths, config, atomic saves.
//!
//! Knows files and folders. Must never know execution: nothing here runs a state or asks Python.

pub mod config;
pub mod files;
pub mod libraries;
pub mod place;
pub mod problem;
pub mod read;

pub use config::{Config, Environment};
pub use libraries::{Libraries, Root, roots};
pub use place::{Place, Saved};
pub use problem::{Fault, LoadProblem, Wrong};
pub use read::{LoadError, Loaded, load};
