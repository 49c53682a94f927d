//! Planning requests, and the events that an engine produces.

use crate::document::Selection;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A pool of skills: library states with a planner annotation.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanPool {
    /// Library paths: roots, folders below them or single libraries, such as `restaurant/skills`.
    #[cfg_attr(feature = "schema", schema(max_items = 100))]
    pub libraries: Vec<String>,
    /// Each type and its supertype.
    #[serde(default)]
    pub types: BTreeMap<String, String>,
}

/// Planning domain that results from the skills.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanDomain {
    /// All skills, sorted by library.
    pub skills: Vec<PlanSkill>,
    /// Each type and its supertype.
    pub types: BTreeMap<String, String>,
    /// Predicates that facts can use.
    pub predicates: Vec<PlanSignature>,
    /// Numeric functions of the domain.
    pub functions: Vec<PlanSignature>,
    /// The domain as PDDL.
    pub pddl: String,
    /// Errors and warnings about the skills.
    pub findings: Vec<PlanFinding>,
}

/// A library state that an engine can plan with.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanSkill {
    /// Path and name of the library.
    pub library: String,
    /// Name of the library's root state.
    pub title: String,
    /// Name of the PDDL action.
    pub action: String,
    /// Description from the skill's annotation, for people.
    pub description: String,
    /// Parameters of the action.
    pub parameters: Vec<PlanParameter>,
    /// The action as PDDL.
    pub pddl: String,
}

/// A parameter of an action, or an argument of a predicate.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanParameter {
    /// Name without the question mark.
    pub name: String,
    /// Allowed types: any of these. Empty for any type.
    pub types: Vec<String>,
    /// Input port that receives the object, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub port: Option<String>,
}

/// A predicate or a numeric function.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanSignature {
    /// Name of the predicate or function.
    pub name: String,
    /// Arguments in their order.
    pub arguments: Vec<PlanParameter>,
}

/// A fault in skills, facts or a goal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanFinding {
    /// True if the fault prevents planning.
    pub is_error: bool,
    /// Libraries that cause the fault.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub libraries: Vec<String>,
    /// Description of the fault and its remedy.
    pub text: String,
}

/// Request for a plan: the goal, the skills and the engine.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MakePlan {
    /// Skills that the plan may use.
    pub pool: PlanPool,
    /// A PDDL problem: objects, facts, and a goal unless `goal` gives one.
    #[cfg_attr(feature = "schema", schema(max_length = 4_194_304))]
    pub facts: String,
    /// A PDDL condition. The default is the goal of the problem.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub goal: Option<String>,
    /// Values of the objects at run time, by object name. They become inputs of states.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub data: crate::Values,
    /// `kairos` or the name of an engine of unified-planning. The default is `kairos`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub engine: Option<String>,
    /// Time limit of the engine, in ms. The default is 10 s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(
        feature = "schema",
        schema(minimum = 1, maximum = 3_600_000),
        ts(optional, type = "number")
    )]
    pub time_limit_ms: Option<u64>,
    /// True to keep improving the plan until the time limit.
    #[serde(default)]
    pub anytime: bool,
    /// True to run independent steps of an untimed plan in parallel.
    #[serde(default)]
    pub parallel: bool,
    /// Recovery for failing steps whose skills define none.
    #[serde(default)]
    pub recovery: PlanRecovery,
    /// Library that observes the facts (output `facts`), for machines that replan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub observe: Option<String>,
    /// Maximum number of replans of such a machine. The default is 5.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schema(maximum = 1000), ts(optional))]
    pub replans_max: Option<u32>,
    /// Name of the machine. The default is the name of the problem.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub name: Option<String>,
}

/// Recovery after a step fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanRecovery {
    /// Number of retries of the step.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schema(maximum = 1000))]
    pub retries: u32,
    /// Action after the last retry.
    #[serde(default)]
    pub then: PlanThen,
}

/// Last action for a failing step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum PlanThen {
    /// End the machine by *aborted*.
    #[default]
    GiveUp,
    /// Ask a person to decide.
    Ask,
    /// Observe the world and make a new plan.
    Replan,
}

/// An event of a planning request, one per line. The last event is never `found`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum PlanEvent {
    /// A valid plan. Each later plan is better.
    Found(Box<PlanFound>),
    /// Planning is complete. The latest plan is the result.
    Done(PlanEnd),
    /// The goal cannot be reached, so no plan exists.
    Impossible(PlanEnd),
    /// The engine found no plan within its time limit.
    NotFound(PlanEnd),
    /// Skills, facts or goal do not fit together. The engine was not started.
    Refused(PlanRefused),
    /// The engine is missing, failed, or produced invalid plans.
    Failed(PlanEnd),
    /// The client cancelled the request.
    Cancelled(PlanEnd),
}

/// End of a planning request.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanEnd {
    /// Cause and remedy, in words.
    pub reason: String,
    /// Time since the request, in ms.
    #[cfg_attr(feature = "schema", ts(type = "number"))]
    pub after_ms: u64,
    /// Warnings about skills, facts or goal.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<PlanFinding>,
}

/// Reasons why planning was refused.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanRefused {
    /// Faults that prevent planning.
    pub findings: Vec<PlanFinding>,
}

/// A valid plan and its machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanFound {
    /// Engine that found the plan.
    pub engine: String,
    /// Time since the request, in ms.
    #[cfg_attr(feature = "schema", ts(type = "number"))]
    pub after_ms: u64,
    /// Cost of the plan, as reported by the engine.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub cost: Option<f64>,
    /// True if the plan is timed.
    pub temporal: bool,
    /// Planned duration, in the plan's time units. 0 for an untimed plan.
    pub makespan: f64,
    /// Extra duration of the machine, because parallel steps wait for each other.
    pub lost: f64,
    /// Steps sorted by start time.
    pub steps: Vec<PlanStep>,
    /// A hierarchy state that contains the whole plan, in the form that the edit `paste` accepts.
    pub machine: Selection,
    /// Warnings about skills, facts or goal.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<PlanFinding>,
}

/// A step of a plan, and the reasons for it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanStep {
    /// Name of the PDDL action.
    pub action: String,
    /// Library that implements the action.
    pub library: String,
    /// Title of the step, for people.
    pub title: String,
    /// Objects, one for each parameter.
    pub objects: Vec<String>,
    /// Start time. For an untimed plan, the index of the step.
    pub start: f64,
    /// Duration of the step, if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub duration: Option<f64>,
    /// Path of its state, from the plan's hierarchy state down.
    pub path: String,
    /// Facts that the step needs.
    pub needs: Vec<PlanNeed>,
    /// Facts of the step that other steps or the goal need.
    pub brings: Vec<PlanGain>,
}

/// A fact that a step needs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanNeed {
    /// The fact in PDDL.
    pub fact: String,
    /// Index of the step that provides the fact. Empty if it holds initially.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional, type = "number"))]
    pub from: Option<usize>,
}

/// A fact that a step provides.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanGain {
    /// The fact in PDDL.
    pub fact: String,
    /// Indices of the steps that need it.
    #[cfg_attr(feature = "schema", ts(type = "number[]"))]
    pub steps: Vec<usize>,
    /// True if the goal needs it.
    pub goal: bool,
}
