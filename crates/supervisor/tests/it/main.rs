//! Runners without a terminal, with real interpreters, the real extension, and temporary folders.
//!
//! Build the extension first: `cargo build --workspace`, or use `cargo xtask test`, which builds it.

#![expect(clippy::unwrap_used, reason = "a test ends where it goes wrong")]

mod detached;
