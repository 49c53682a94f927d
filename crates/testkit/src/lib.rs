//! What the tests of several crates share: machines, journals and folders from text, edits chosen by
//! numbers, and runs simulated by seeds.
//!
//! Knows what is public in the crates that it helps to test. No product may depend on it; tests, benches and examples do.

pub mod disturbed_link;
pub mod edits;
pub mod files;
pub mod journal_notation;
pub mod link_world;
pub mod machines;
pub mod notation;
mod random;
pub mod simulation;
