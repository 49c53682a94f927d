//! A robot and its stations in one virtual world: the real sessions of `rafcon-link`, a carrier that is as bad as a seed wants it,
//! servers that die, disks that stay. What must always be true is checked after every step.

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
