//! The reference's `config.yaml`: found, read, never written. Knows its keys and how it writes paths.
//! Must never read the environment itself.

mod find;
mod paths;
mod read;

pub use find::{ConfigError, find};
pub use paths::{Environment, clean_path};
pub use read::{Config, ConfigNote, Naming, parse};

#[cfg(test)]
mod tests;
