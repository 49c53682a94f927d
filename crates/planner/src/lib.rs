//! A planner whose plans become machines. Skills are library states with annotations, and a pool of them is merged into
//! a domain. Each plan from an engine is validated, explained, ordered and turned into a machine
//! (`docs/guide/planning.md`).
//!
//! The planner knows PDDL, plans and the model. It knows no engine programs, files, time or execution.

mod explain;
mod finding;
mod ground;
mod machine;
mod merge;
mod order;
pub mod pddl;
mod plan;
mod skill;
mod structure;
mod task;
mod validate;

#[cfg(test)]
mod tests;

pub use explain::{Gain, Need, Reason, explain};
pub use finding::{Finding, Severity};
pub use ground::{Fact, Literal, World};
pub use machine::{Build, BuildError, Built, Data, FindLibrary, REPLAN, Replanning, build};
pub use merge::Pool;
pub use order::Order;
pub use plan::{Plan, Step};
pub use skill::{ANNOTATION, PLANNING, Recovery, Skill, Then, read_skill};
pub use structure::Structure;
pub use task::Task;
pub use validate::{Invalid, validate};
