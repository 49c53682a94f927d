//! Plans from engines, one JSON object each. This module checks their form; `validate.rs` checks their content.

use crate::pddl::{Name, Object, Renamed};
use rafcon_model::{Json, json};
use smol_str::SmolStr;
use std::fmt;

/// Limit of the steps in a plan. Longer plans are rejected.
const STEPS_MAX: usize = 100_000;

/// One action of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Name of the action.
    pub action: Name,
    /// Objects in lower case, one for each parameter.
    pub objects: Vec<Name>,
    /// Start time; in a plan without time, the index of the step.
    pub start: f64,
    /// Duration of the step; `None` for an action without duration.
    pub duration: Option<f64>,
}

/// The actions that reach a goal, with their times.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Steps by start time.
    pub steps: Vec<Step>,
    /// True if the plan has times.
    pub temporal: bool,
    /// Cost of the plan, as reported by the engine.
    pub cost: Option<f64>,
}

impl Step {
    /// The end time of the step.
    pub fn end(&self) -> f64 {
        self.start + self.duration.unwrap_or_default()
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}", self.action)?;
        self.objects.iter().try_for_each(|object| write!(f, " {object}"))?;
        f.write_str(")")
    }
}

impl Plan {
    /// Parses the output of an engine:
    /// `{"temporal": …, "cost": …, "steps": [{"action": "(cook bob pizza)", "time": …, "duration": …}]}`.
    /// The error describes the problem.
    pub fn read(text: &str) -> Result<Self, String> {
        let document =
            json::parse(text).map_err(|error| format!("the plan is not JSON: {error}"))?;
        let steps =
            document.get("steps").and_then(Json::as_list).ok_or("the plan has no `steps`")?;
        if steps.len() > STEPS_MAX {
            return Err(format!(
                "the plan has {} steps; at most {STEPS_MAX} are taken",
                steps.len()
            ));
        }
        let temporal = matches!(document.get("temporal"), Some(Json::Bool(true)));
        let mut steps = steps
            .iter()
            .enumerate()
            .map(|(at, step)| read_step(at, step, temporal))
            .collect::<Result<Vec<_>, _>>()?;
        steps.sort_by(|a, b| a.start.total_cmp(&b.start));
        let cost = document.get("cost").and_then(Json::as_number).filter(|cost| cost.is_finite());
        Ok(Self { steps, temporal, cost })
    }

    /// Replaces the engine's names of actions and objects with those of the user.
    pub fn restore_names(&mut self, names: &Renamed) {
        for step in &mut self.steps {
            step.action = names.original(&step.action);
            step.objects.iter_mut().for_each(|object| *object = names.original(object));
        }
    }

    /// The end time of the last step; 0 for a plan without time.
    pub fn makespan(&self) -> f64 {
        if !self.temporal {
            return 0.0;
        }
        self.steps.iter().map(Step::end).fold(0.0, f64::max)
    }
}

fn read_step(at: usize, step: &Json, temporal: bool) -> Result<Step, String> {
    let wrong = |what: &str| format!("step {} of the plan {what}", at + 1);
    let text = step.get("action").and_then(Json::as_str).ok_or_else(|| wrong("names no action"))?;
    let inner = text.trim().strip_prefix('(').and_then(|text| text.strip_suffix(')'));
    let inner = inner.ok_or_else(|| wrong("is no action in brackets"))?.to_ascii_lowercase();
    let mut words = inner.split_whitespace().map(Name::from);
    let action = words.next().ok_or_else(|| wrong("names no action"))?;
    let number = |key| step.get(key).and_then(Json::as_number);
    #[expect(clippy::cast_precision_loss, reason = "plans have far less than 2^52 steps")]
    let start = if temporal { number("time").unwrap_or_default() } else { at as f64 };
    let duration = number("duration").filter(|_| temporal);
    if !start.is_finite()
        || start < 0.0
        || duration.is_some_and(|duration| !duration.is_finite() || duration < 0.0)
    {
        return Err(wrong("has a time that is no time"));
    }
    Ok(Step { action, objects: words.collect(), start, duration })
}

/// The user's spelling of an object's name.
pub(crate) fn spelling(name: &str, objects: &[Object]) -> SmolStr {
    let found = objects.iter().find(|object| object.name == *name);
    found.map_or_else(|| SmolStr::new(name), |object| object.spelling.clone())
}
