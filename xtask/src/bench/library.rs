//! Figures measured inside one program, by the bench binary of the `rafcon` package.

use anyhow::{Context as _, Result};
use serde_json::Value;

use super::Measured;
use crate::process;

/// Runs the bench binary, which prints one JSON object a line.
pub(crate) fn measure() -> Result<Vec<Measured>> {
    let bench = ["bench", "--quiet", "--package", "rafcon", "--bench", "figures", "--", "--json"];
    let printed = process::text(process::cargo().args(bench))?;
    printed.lines().filter(|line| line.starts_with('{')).map(read).collect()
}

fn read(line: &str) -> Result<Measured> {
    let figure: Value = serde_json::from_str(line).with_context(|| format!("not JSON: {line}"))?;
    let name = figure["name"].as_str().with_context(|| format!("no name in {line}"))?;
    let value = figure["value"].as_f64().with_context(|| format!("no value in {line}"))?;
    Ok((name.to_owned(), value))
}
