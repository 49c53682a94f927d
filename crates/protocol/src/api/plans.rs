//! What is planned, and what an engine says to it.

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
    /// Which type is a kind of which.
    #[serde(default)]
    pub types: BTreeMap<String, String>,
}

/// What skills add up to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanDomain {
    /// All skills, sorted by library.
    pub skills: Vec<PlanSkill>,
    /// Each type and the one that it is a kind of.
    pub types: BTreeMap<String, String>,
    /// What can be a fact.
    pub predicates: Vec<PlanSignature>,
    /// What can be counted.
    pub functions: Vec<PlanSignature>,
    /// The domain as PDDL.
    pub pddl: String,
    /// What is wrong.
    pub findings: Vec<PlanFinding>,
}

/// A library state that an engine can plan with.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanSkill {
    /// Library path and name.
    pub library: String,
    /// The name of its root state.
    pub title: String,
    /// The name of its action.
    pub action: String,
    /// What it does, for people.
    pub description: String,
    /// What its action is done with.
    pub parameters: Vec<PlanParameter>,
    /// The action as PDDL.
    pub pddl: String,
}

/// A parameter of an action, or an argument of a predicate.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanParameter {
    /// Without the question mark.
    pub name: String,
    /// Any of these; none: anything.
    pub types: Vec<String>,
    /// The input port that it sets, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub port: Option<String>,
}

/// A predicate or a numeric function.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanSignature {
    /// Its name.
    pub name: String,
    /// What it takes.
    pub arguments: Vec<PlanParameter>,
}

/// Something that is wrong with skills, facts or a goal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanFinding {
    /// Whether it prevents plans.
    pub is_error: bool,
    /// The libraries that it is about.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub libraries: Vec<String>,
    /// What it is, and the way out.
    pub text: String,
}

/// What is wanted, with what, and of which engine.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MakePlan {
    /// The skills.
    pub pool: PlanPool,
    /// A PDDL problem: objects, facts, and a goal where none is given beside it.
    #[cfg_attr(feature = "schema", schema(max_length = 4_194_304))]
    pub facts: String,
    /// A PDDL condition; left out: the goal of the problem.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub goal: Option<String>,
    /// What objects are while a machine runs, by their names: the values of inputs.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub data: crate::Values,
    /// `kairos`, or the name of an engine of unified-planning; left out: `kairos`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub engine: Option<String>,
    /// How long the engine may take, in ms; left out: 10 s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(
        feature = "schema",
        schema(minimum = 1, maximum = 3_600_000),
        ts(optional, type = "number")
    )]
    pub time_limit_ms: Option<u64>,
    /// Whether it looks for better plans until then.
    #[serde(default)]
    pub anytime: bool,
    /// Whether a plan without times is done at the same time where it can be.
    #[serde(default)]
    pub parallel: bool,
    /// What failing steps do whose skills do not say.
    #[serde(default)]
    pub recovery: PlanRecovery,
    /// The library that observes the facts (output `facts`), for machines that plan again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub observe: Option<String>,
    /// How often such a machine plans again; left out: 5 times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schema(maximum = 1000), ts(optional))]
    pub replans_max: Option<u32>,
    /// The name of the machine; left out: the name of the problem.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub name: Option<String>,
}

/// What happens when a step fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanRecovery {
    /// How often it is tried again.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schema(maximum = 1000))]
    pub retries: u32,
    /// And when that did not help.
    #[serde(default)]
    pub then: PlanThen,
}

/// The last resort of a step that fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum PlanThen {
    /// The machine ends by *aborted*.
    #[default]
    GiveUp,
    /// A person decides.
    Ask,
    /// The world is observed, and another plan is made.
    Replan,
}

/// What is told while an engine plans, one a line. The last is never `found`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum PlanEvent {
    /// A valid plan; a later one is better.
    Found(Box<PlanFound>),
    /// The engine is done; the latest plan is the answer.
    Done(PlanEnd),
    /// There is no plan: the goal cannot be reached.
    Impossible(PlanEnd),
    /// The engine found none in the time that it had.
    NotFound(PlanEnd),
    /// Skills, facts or goal do not fit: there is nothing to plan.
    Refused(PlanRefused),
    /// The engine is missing, fails, or gives plans that are not valid.
    Failed(PlanEnd),
    /// Nobody wants it any more.
    Cancelled(PlanEnd),
}

/// How planning ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanEnd {
    /// In words, with the way out.
    pub reason: String,
    /// After how many ms.
    #[cfg_attr(feature = "schema", ts(type = "number"))]
    pub after_ms: u64,
    /// What is wrong all the same.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<PlanFinding>,
}

/// Why there is nothing to plan.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanRefused {
    /// What is wrong.
    pub findings: Vec<PlanFinding>,
}

/// A plan that is valid, and its machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanFound {
    /// The engine that found it.
    pub engine: String,
    /// After how many ms.
    #[cfg_attr(feature = "schema", ts(type = "number"))]
    pub after_ms: u64,
    /// What the engine says that it costs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub cost: Option<f64>,
    /// Whether its times mean something.
    pub temporal: bool,
    /// How long it takes as planned, in its units of time; 0 for a plan without times.
    pub makespan: f64,
    /// How much longer its machine takes, because what runs at the same time waits for each other.
    pub lost: f64,
    /// In the order of their beginnings.
    pub steps: Vec<PlanStep>,
    /// One hierarchy state with the whole plan inside, as the edit `paste` takes it.
    pub machine: Selection,
    /// What is wrong all the same.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<PlanFinding>,
}

/// A step of a plan, and why it is there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanStep {
    /// The name of the action.
    pub action: String,
    /// The library behind it.
    pub library: String,
    /// The name of the step, for people.
    pub title: String,
    /// The objects, one for each parameter.
    pub objects: Vec<String>,
    /// When it begins; of a plan without times, its index.
    pub start: f64,
    /// How long it takes, if it takes time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub duration: Option<f64>,
    /// Its state in the machine, from the hierarchy state down.
    pub path: String,
    /// What it needs.
    pub needs: Vec<PlanNeed>,
    /// What it brings that is needed.
    pub brings: Vec<PlanGain>,
}

/// A fact that a step needs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanNeed {
    /// What.
    pub fact: String,
    /// The index of the step that brought it; left out: it was there from the beginning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional, type = "number"))]
    pub from: Option<usize>,
}

/// A fact that a step brings.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PlanGain {
    /// What.
    pub fact: String,
    /// The indices of the steps that need it.
    #[cfg_attr(feature = "schema", ts(type = "number[]"))]
    pub steps: Vec<usize>,
    /// Whether the goal does.
    pub goal: bool,
}
