//! The model from outside: machines in the notation in, what becomes of them out.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its machines has failed")]

mod diff;
mod edits;
mod history;
mod problems;
