//! A planner whose plans are machines: skills are library states with annotations, their domain is merged from a pool, each plan
//! of an engine is validated, explained, ordered and made a machine (`docs/guide/planning.md`).
//!
//! Knows PDDL, plans and the model. Knows nothing of engines as programs, of files, time or execution.

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
