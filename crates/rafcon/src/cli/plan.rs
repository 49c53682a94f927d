//! The options of `rafcon plan`.

use super::{Libraries, Python};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Make a plan, and a machine of it, from skills: libraries with a planner annotation.
///
/// Prints the steps with what each needs and brings. The exit code is 1 if there is no plan. Each plan of the engine is validated
/// before it is shown. Ctrl-C ends the engine.
#[derive(Debug, Args)]
pub(crate) struct Plan {
    /// Folders with skills, or library paths such as `root/folder`
    #[arg(required = true, value_name = "POOL")]
    pub(crate) pool: Vec<String>,
    /// PDDL problem: objects, facts, and the goal if `--goal` does not give it; left out: print the domain of the pool
    #[arg(long, value_name = "FILE")]
    pub(crate) facts: Option<PathBuf>,
    /// PDDL condition that is to hold at the end, such as `(and (at kitchen bob))`
    #[arg(long, value_name = "CONDITION", requires = "facts")]
    pub(crate) goal: Option<String>,
    /// JSON file that says which type is a kind of which
    #[arg(long, value_name = "FILE")]
    pub(crate) types: Option<PathBuf>,
    /// JSON file with the runtime data of objects, by their names
    #[arg(long, value_name = "FILE")]
    pub(crate) data: Option<PathBuf>,
    /// `kairos`, or the name of an engine of unified-planning
    #[arg(long, value_name = "NAME", default_value = "kairos")]
    pub(crate) engine: String,
    /// Seconds that the engine may take
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = clap::value_parser!(f64))]
    pub(crate) time_limit: f64,
    /// Look for better plans until then
    #[arg(long)]
    pub(crate) anytime: bool,
    /// Do at the same time what is independent, also where skills have no duration
    #[arg(long)]
    pub(crate) parallel: bool,
    /// How often a failing step is tried again, if its skill does not say
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) retries: u32,
    /// What happens when that did not help
    #[arg(long, value_enum, default_value = "give-up")]
    pub(crate) then: Then,
    /// Library with an output `facts`, for machines that plan again
    #[arg(long, value_name = "LIBRARY")]
    pub(crate) observe: Option<String>,
    /// How often such a machine plans again
    #[arg(long, value_name = "N")]
    pub(crate) replans_max: Option<u32>,
    /// Folder for the machine; it must not exist or be empty
    #[arg(long, value_name = "FOLDER", requires = "facts")]
    pub(crate) out: Option<PathBuf>,
    /// Print events as lines of JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) libraries: Libraries,
    #[command(flatten)]
    pub(crate) python: Python,
}

/// The last resort of a step that fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Then {
    /// The machine ends by *aborted*
    GiveUp,
    /// A person decides
    Ask,
    /// The facts are observed, and another plan is made
    Replan,
}
