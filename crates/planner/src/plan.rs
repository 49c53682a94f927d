//! Plans as engines give them: one JSON object a plan. Knows their form, not whether they are right.

use crate::pddl::{Name, Object, Renamed};
use rafcon_model::{Json, json};
use smol_str::SmolStr;
use std::fmt;

/// More steps are no plan that a machine is made of.
const STEPS_MAX: usize = 100_000;

/// One action of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// The name of the action.
    pub action: Name,
    /// The objects, one for each parameter, in lower case.
    pub objects: Vec<Name>,
    /// When it begins; of a plan without time, its index.
    pub start: f64,
    /// How long it takes; `None` for an action without duration.
    pub duration: Option<f64>,
}

/// Actions that lead to a goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// In the order of their beginnings.
    pub steps: Vec<Step>,
    /// Whether the times mean something.
    pub temporal: bool,
    /// What the engine says that it costs.
    pub cost: Option<f64>,
}

impl Step {
    /// When it ends.
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
    /// Reads what an engine says: `{"temporal": …, "cost": …, "steps": [{"action": "(cook bob pizza)", "time": …, "duration": …}]}`.
    /// `Err` says what is wrong with it.
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

    /// Gives actions and objects the names that the user has given them.
    pub fn restore_names(&mut self, names: &Renamed) {
        for step in &mut self.steps {
            step.action = names.original(&step.action);
            step.objects.iter_mut().for_each(|object| *object = names.original(object));
        }
    }

    /// When the last step ends; 0 for a plan without time.
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

/// How people wrote the name of an object.
pub(crate) fn spelling(name: &str, objects: &[Object]) -> SmolStr {
    let found = objects.iter().find(|object| object.name == *name);
    found.map_or_else(|| SmolStr::new(name), |object| object.spelling.clone())
}
