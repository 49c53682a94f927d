//! Runners that are started without a terminal: real interpreters, the real extension, folders of their own.
//!
//! The extension must have been built: `cargo build --workspace`, or `cargo xtask test`, which does it.

#![expect(clippy::unwrap_used, reason = "a test ends where it goes wrong")]

mod detached;
