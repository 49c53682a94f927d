//! Long tests at the limits, with their figures and bars: many short runs of one robot, edits between kills, silent
//! strangers, doubled signals, values of every kind.

use std::process::Command;

use anyhow::{Context as _, Result, bail};
use serde_json::{Value, json};

use crate::long_tests;
use crate::product::{Product, Profile};
use crate::{process, python, workspace};

/// Options of `cargo xtask limits`.
#[derive(clap::Args)]
pub(crate) struct LimitsOptions {
    /// Print lines of JSON only.
    #[arg(long)]
    json: bool,
    /// Divide the length of each test by this.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    shorter: u32,
}

/// A figure and its bar.
#[derive(Debug, Clone, Copy)]
struct Limit {
    name: &'static str,
    unit: &'static str,
    at_most: f64,
}

const fn limit(name: &'static str, unit: &'static str, at_most: f64) -> Limit {
    Limit { name, unit, at_most }
}

const LIMITS: [Limit; 8] = [
    limit("station_runs_missing", "runs", 0.0),
    limit("station_runs_open", "runs", 0.0),
    limit("station_memory_mb", "MB", 150.0),
    limit("station_descriptors", "files", 200.0),
    limit("edits_lost", "edits", 0.0),
    limit("owner_request_max_s", "s", 1.0),
    limit("value_identity_failures", "values", 0.0),
    limit("double_signal_killed", "runs", 0.0),
];

/// Runs the tests, prints their figures, and fails if one is over its bar or missing.
pub(crate) fn run(options: &LimitsOptions) -> Result<()> {
    let product = Product::build(Profile::Release)?;
    let mut found = Vec::new();
    for mut test in tests(options.shorter, &product)? {
        found.extend(figures(&process::text(&mut test)?));
    }
    let mut over = Vec::new();
    for limit in LIMITS {
        let values = found.iter().filter(|(name, _)| name == limit.name).map(|(_, value)| *value);
        let worst =
            values.reduce(f64::max).with_context(|| format!("no test printed {}", limit.name))?;
        if options.json {
            println!("{}", json!({ "name": limit.name, "value": worst, "unit": limit.unit }));
        } else {
            println!("{:28} {worst:>10} {} (at most {})", limit.name, limit.unit, limit.at_most);
        }
        if worst > limit.at_most {
            over.push(limit.name);
        }
    }
    if !over.is_empty() {
        bail!("over the bar: {}", over.join(", "));
    }
    Ok(())
}

/// The tests with the lengths that the bars are for, or shorter.
fn tests(shorter: u32, product: &Product) -> Result<Vec<Command>> {
    let length = |full: u32| (full / shorter).max(1).to_string();
    let mut tests = vec![long_tests::short_runs((100_000 / shorter).max(1))];
    let edits = "edit_torture::no_answered_edit_is_lost_to_kills_and_other_programs";
    for states in ["750", "10000"] {
        let mut torture = long_tests::long_form(edits);
        torture.env("RAFCON_TEST_KILLS", length(1_000)).env("RAFCON_TEST_STATES", states);
        tests.push(torture);
    }
    let crowd = "crowd::strangers_who_hold_every_file_of_a_server_delay_no_user_and_no_run";
    let mut strangers = long_tests::long_form(crowd);
    strangers.env("RAFCON_TEST_STRANGERS", length(2_000));
    let mut signals =
        long_tests::long_form("signals::a_doubled_signal_leaves_the_machine_its_recovery");
    signals.env("RAFCON_TEST_SIGNALS", length(100));
    tests.extend([strangers, signals, values(&length(100_000), product)?]);
    Ok(tests)
}

fn values(count: &str, product: &Product) -> Result<Command> {
    let mut python = Command::new(python::default()?.program);
    python.args(["-m", "unittest", "test_value_identity"]).env("RAFCON_TEST_VALUES", count);
    python.env("RAFCON_EXTENSION", &product.extension).env("RAFCON_BINARY", &product.binary);
    python.current_dir(workspace::path("crates/python/tests"));
    Ok(python)
}

/// The figures in the output of a test.
fn figures(output: &str) -> Vec<(String, f64)> {
    let lines = output.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    lines
        .filter_map(|line| Some((line["name"].as_str()?.to_owned(), line["value"].as_f64()?)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::figures;

    #[test]
    fn figures_are_found_among_other_lines() {
        let output = "running 1 test\n{\"name\":\"edits_lost\",\"value\":0,\"unit\":\"edits\"}\n{\"other\":1}\nok\n";
        assert_eq!(figures(output), [("edits_lost".to_owned(), 0.0)]);
    }
}
