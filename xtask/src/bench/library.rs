//! Figures measured by the bench binaries of the `rafcon` package: inside one program, or as a client of a server.

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;

use super::Measured;
use crate::process;
use crate::product::{Product, Profile};

/// Figures measured inside one program.
pub(crate) fn measure() -> Result<Vec<Measured>> {
    printed("figures")
}

/// Figures measured by a client of a server.
pub(crate) fn measure_server() -> Result<Vec<Measured>> {
    // The server's runners need the extension next to the binary.
    Product::build(Profile::Release)?;
    printed("server")
}

/// Runs the part of the server's bench that reads the records of scripts, in a debug build, so that it keeps working. Its
/// figures are meaningless.
pub(crate) fn check_server_bench() -> Result<()> {
    let bench = ["bench", "--quiet", "--profile", "dev", "--workspace", "--bench", "server"];
    let printed = process::text(process::cargo().args(bench).args(["--", "command", "status"]))?;
    for name in ["server_command_ms", "server_status_ms"] {
        let figures = printed.lines().filter(|line| line.starts_with('{')).map(read);
        let is_measured = figures.flatten().any(|(measured, _)| measured == name);
        ensure!(is_measured, "the bench of the server does not measure {name}");
    }
    Ok(())
}

/// Runs a bench binary, which prints one JSON object a line.
fn printed(binary: &str) -> Result<Vec<Measured>> {
    let bench = ["bench", "--quiet", "--package", "rafcon", "--bench", binary, "--", "--json"];
    let printed = process::text(process::cargo().args(bench))?;
    printed.lines().filter(|line| line.starts_with('{')).map(read).collect()
}

fn read(line: &str) -> Result<Measured> {
    let figure: Value = serde_json::from_str(line).with_context(|| format!("not JSON: {line}"))?;
    let name = figure["name"].as_str().with_context(|| format!("no name in {line}"))?;
    let value = figure["value"].as_f64().with_context(|| format!("no value in {line}"))?;
    Ok((name.to_owned(), value))
}
