//! Plans from engines: a pool of skills is read from libraries, an engine is started as a process with a time limit, each of its
//! plans is validated, explained and made a machine before anyone sees it (`docs/guide/planning.md`).
//!
//! Knows engines as programs and requests as clients see them. Knows nothing of HTTP, terminals or Python objects; what a plan is
//! knows `rafcon-planner`.

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
