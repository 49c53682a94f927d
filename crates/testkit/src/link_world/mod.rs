//! A robot and its stations in a virtual world: the real sessions of `rafcon-link`, a carrier with faults that depend on
//! the seed, servers that die, and persistent disks. All invariants are checked after every step.

mod carrier;
mod clock;
mod measures;
mod mission;
mod plan;
mod robot;
mod station;
mod watching;
mod world;

pub use carrier::{Carrier, Conditions, Cut};
pub use measures::{Figure, Measures};
pub use mission::{SampleEvent, sample_events};
pub use plan::Scenario;
pub use world::{run, run_watched};
