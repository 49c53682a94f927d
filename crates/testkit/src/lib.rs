//! Shared test support: machines, journals and folders from text, edits chosen by numbers, and simulated runs and links
//! with seeds.
//!
//! Knows the public items of the tested crates. Only tests, benches and examples may depend on it, no product.

pub mod disturbed_link;
pub mod edits;
pub mod files;
pub mod journal_notation;
pub mod link_world;
pub mod machines;
pub mod notation;
mod random;
pub mod simulation;
