//! The figures of planning, with their bars. Knows nothing of the measurements.

use anyhow::{Result, bail};
use serde_json::{Map, json};

/// A figure, by its name in JSON.
pub(super) struct PlannerFigure {
    /// Its name; ends with its unit.
    name: &'static str,
    /// The bar, if the figure has one.
    bar: Option<f64>,
    meaning: &'static str,
}

const fn most(name: &'static str, bar: f64, meaning: &'static str) -> PlannerFigure {
    PlannerFigure { name, bar: Some(bar), meaning }
}

const fn told(name: &'static str, meaning: &'static str) -> PlannerFigure {
    PlannerFigure { name, bar: None, meaning }
}

/// All figures, in the order of the output.
const ALL: [PlannerFigure; 17] = [
    most(
        "blocks_40_ms",
        1500.0,
        "40 blocks, from the command to the shown plan, its machine built",
    ),
    told("blocks_40_steps", "steps of that plan"),
    most("logistics_12_40_ms", 2000.0, "40 packages in 12 cities, measured like 40 blocks"),
    told("logistics_12_40_steps", "steps of that plan"),
    most(
        "machine_ms",
        100.0,
        "a plan of at least 463 steps, from the engine's word to its machine",
    ),
    told("machine_steps", "steps of that plan"),
    told(
        "machine_saved_ms",
        "that plan, the whole command with reading skills and writing all files",
    ),
    most("machine_notes", 0.0, "errors and notes of `rafcon check` on that machine"),
    most(
        "replan_ms",
        500.0,
        "in a run: from the end of a step that fails to the first step of the next plan",
    ),
    told("replan_steps", "steps of the plan that failed"),
    told("replan_new_steps", "steps of the plan that took its place"),
    most(
        "cancel_ctrl_c_ms",
        200.0,
        "from Ctrl-C to the last process of an engine that heeds no signal",
    ),
    most(
        "cancel_request_ms",
        200.0,
        "at a server, from the end of the request's connection to the last process of such an engine",
    ),
    told(
        "restaurant_plan_ms",
        "the plugin's example, from the command to the shown plan, its machine built",
    ),
    told("restaurant_save_ms", "then, until the machine was written"),
    told(
        "plugin_plan_ms",
        "the plugin on this example with this engine, until the plan was complete",
    ),
    told("plugin_build_ms", "then, until its machine was written"),
];

/// Measured values by name.
#[derive(Debug, Default)]
pub(super) struct Measured(Vec<(&'static str, f64)>);

impl Measured {
    pub(super) fn note(&mut self, name: &'static str, value: f64) {
        self.0.push((name, value));
    }

    /// Prints all figures, and fails if a bar is missed or a figure is missing.
    pub(super) fn print(&self, as_json: bool) -> Result<()> {
        let of = |name| self.0.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
        let mut faults = Vec::new();
        let mut values = Map::new();
        let mut table = vec![
            "| figure | measured | at most | |".to_owned(),
            "| --- | ---: | ---: | --- |".to_owned(),
        ];
        for PlannerFigure { name, bar, meaning } in ALL {
            let Some(value) = of(name) else {
                faults.push(format!("{name} was not measured"));
                continue;
            };
            let limit = bar.map(|bar| bar.to_string()).unwrap_or_default();
            table.push(format!("| `{name}` | {} | {limit} | {meaning} |", rounded(value)));
            values.insert(name.to_owned(), json!(rounded(value)));
            if bar.is_some_and(|bar| value > bar) {
                faults.push(format!("{name} is {}, at most {limit}: {meaning}", rounded(value)));
            }
        }
        if as_json {
            println!("{}", serde_json::Value::Object(values));
        } else {
            println!("{}", table.join("\n"));
        }
        if !faults.is_empty() {
            bail!("{}", faults.join("; "));
        }
        Ok(())
    }
}

/// Rounds to one decimal.
fn rounded(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}
