//! Plans from engines. Loads a pool of skills from libraries, and starts an engine as a process with a time limit. Each of its
//! plans is validated, explained and turned into a machine before it is reported (`docs/guide/planning.md`).
//!
//! Knows engines as programs, and requests in the format for clients. Does not know HTTP, terminals or Python objects.
//! `rafcon-planner` defines plans.

mod answer;
mod descendants;
mod engine;
mod found;
mod pool;
mod search;

#[cfg(test)]
mod tests;

pub use answer::{Planner, domain, machine_of};
pub use engine::{DEFAULT_ENGINE, Engine};
pub use search::Cancel;
