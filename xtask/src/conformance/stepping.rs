//! Stepping, forward and back: both engines receive equal commands during a run, and the effects of each command on scripts
//! are compared.
//!
//! The machines are copies of those that the reference ships for it. Each script in the copy records the calls of its
//! functions, so that the comparison does not depend on reports of the engines.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};

use super::table::Row;
use crate::product::Product;
use crate::reference::Reference;
use crate::{process, workspace};

/// Appended to every script of a copy.
const TRACER: &str = r#"

import os as _os


def _traced(mark, function):
    def traced(self, inputs, outputs, gvm):
        with open(_os.environ["RAFCON_TRACE"], "a", encoding="utf-8") as file:
            file.write(mark + " " + self.get_path() + "\n")
        return function(self, inputs, outputs, gvm)

    return traced


execute = _traced("+", execute)
if "backward_execute" in globals():
    backward_execute = _traced("~", backward_execute)
"#;

/// Machines and commands on which the reference does not crash.
const CASES: [(&str, &str); 9] = [
    ("hierarchy", "into into into into into into into into"),
    ("hierarchy", "over over over over back back"),
    ("hierarchy", "into into into into out over back back"),
    ("barrier", "into into into into into into"),
    ("barrier", "over over back back back"),
    ("barrier", "into into into into into back back back back"),
    ("preemption", "into into into into into"),
    ("preemption", "over over back back back"),
    ("preemption", "into into into into into back back back back"),
];

/// Steps all machines in both engines.
pub(crate) fn rows(reference: &Reference, product: &Product, part: Option<&str>) -> Vec<Row> {
    let wanted = |(machine, commands): &(&str, &str)| {
        part.is_none_or(|part| name(machine, commands).contains(part))
    };
    // In sequence, because cases of one machine share its copy.
    let cases = CASES.into_iter().filter(wanted);
    cases.map(|(machine, commands)| row(reference, product, machine, commands)).collect()
}

fn name(machine: &str, commands: &str) -> String {
    format!("stepping {machine}: {commands}")
}

fn row(reference: &Reference, product: &Product, machine: &str, commands: &str) -> Row {
    let name = name(machine, commands);
    let both = copy(reference, machine).and_then(|copy| {
        Ok((theirs(reference, &copy, commands)?, ours(reference, product, &copy, commands)?))
    });
    match both {
        Ok((theirs, ours)) => Row::stepped(&name, &theirs, &ours),
        Err(reason) => Row::failed(&name, &reason),
    }
}

/// A copy with short sleeps, in which scripts record their calls.
fn copy(reference: &Reference, machine: &str) -> Result<PathBuf> {
    let shipped = reference.share.join("examples/functionality_examples");
    let folder = workspace::target()?.join("conformance/stepping").join(machine);
    super::case::remove(&folder)?;
    super::case::copy(&shipped.join(format!("backward_step_{machine}")), &folder)?;
    trace_scripts(&folder)?;
    Ok(folder)
}

fn trace_scripts(folder: &Path) -> Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            trace_scripts(&path)?;
        } else if path.ends_with("script.py") {
            let text = fs::read_to_string(&path)?;
            let text =
                text.replace("sleep(0.2)", "sleep(0.01)").replace("sleep(1.0)", "sleep(0.01)");
            fs::write(&path, text + TRACER)?;
        }
    }
    Ok(())
}

/// An empty file for the records of scripts.
fn trace(machine: &Path, engine: &str) -> Result<PathBuf> {
    let trace = machine.with_extension(engine);
    fs::write(&trace, "")?;
    Ok(trace)
}

fn theirs(reference: &Reference, machine: &Path, commands: &str) -> Result<Vec<String>> {
    let trace = trace(machine, "theirs")?;
    let mut command = process::command(&reference.python);
    command.arg(workspace::path("tests/conformance/reference_stepper.py")).arg(machine);
    command.args(commands.split(' ')).env("RAFCON_TRACE", &trace);
    process::quiet(&mut command)?;
    read(&trace)
}

fn ours(
    reference: &Reference,
    product: &Product,
    machine: &Path,
    commands: &str,
) -> Result<Vec<String>> {
    let trace = trace(machine, "ours")?;
    let mut command = process::command(&reference.python);
    command.arg(workspace::path("tests/conformance/our_stepper.py")).arg(&product.binary);
    command.arg(machine).args(commands.split(' ')).env("RAFCON_TRACE", &trace);
    process::quiet(&mut command)?;
    read(&trace)
}

/// One line for each command, with the calls of scripts that it caused. Calls of parallel branches have no order.
fn read(trace: &Path) -> Result<Vec<String>> {
    let text = fs::read_to_string(trace)?;
    let mut groups: Vec<(String, Vec<String>)> = Vec::new();
    for line in text.lines() {
        match (line.strip_prefix("= "), groups.last_mut()) {
            (Some(command), _) => groups.push((command.to_owned(), Vec::new())),
            (None, Some((_, calls))) => calls.push(line.to_owned()),
            (None, None) => bail!("{}: a script ran before the first command", trace.display()),
        }
    }
    let shown = groups.into_iter().map(|(command, mut calls)| {
        calls.sort();
        format!("{command}: {}", calls.join(", "))
    });
    Ok(shown.collect())
}
