//! Simulated runs: random machines, results, commands, edits and lost engines, in random orders. All depends only on the
//! seed.

mod commands;
mod counts;
mod edits;
mod history;
mod losses;
mod machine;
mod places;
mod twin;
mod watch;
mod world;

pub use counts::Counts;
pub use world::{Report, Width, simulate};
