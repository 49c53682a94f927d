//! `rafcon check`: everything that is wrong with a machine, from its files, its rules and its scripts.

mod finding;
mod scripts;

use crate::cli::{self, CheckFormat};
use crate::environment::Environment;
use crate::machine::Source;
use crate::view::{counted, harmless};
use anyhow::Result;
use finding::{Finding, Level};
use rafcon_model::{BuiltinTypes, Machine, Rule, problems};
use rafcon_storage::{Fault, Loaded};
use rafcon_supervisor::Interpreter;
use std::io::{self, Write as _};
use std::process::ExitCode;

/// Lists every problem; the exit code is 1 if one of them is an error.
pub(super) fn check(raw: &cli::Check, environment: &Environment) -> Result<ExitCode> {
    let source = Source::new(&raw.path, &raw.libraries)?;
    let interpreter = Interpreter::choose(raw.python.python.as_deref(), &environment.surroundings)?;
    let loaded = source.load()?;
    let mut findings = of_machine(&loaded);
    findings.extend(scripts::findings(&loaded.machine, &interpreter)?);
    let text = match raw.format {
        CheckFormat::Text => for_people(&loaded.machine, &findings),
        CheckFormat::Json => lines(&findings)?,
    };
    io::stdout().write_all(text.as_bytes())?;
    let wrong = findings.iter().any(|finding| finding.level == Level::Error);
    Ok(ExitCode::from(u8::from(wrong)))
}

fn of_machine(loaded: &Loaded) -> Vec<Finding> {
    let is_missing = |problem: &&rafcon_storage::LoadProblem| {
        matches!(problem.fault, Fault::MissingLibrary { .. })
    };
    let missing: Vec<_> = loaded.problems.iter().filter(is_missing).map(|p| &p.state).collect();
    let of_files = loaded.problems.iter().map(|problem| Finding::of_file(&loaded.machine, problem));
    let of_rules = problems(&loaded.machine, &BuiltinTypes)
        .into_iter()
        .filter(|problem| problem.rule != Rule::LibraryMissing || !missing.contains(&&problem.path))
        .map(|problem| Finding::of_rule(&loaded.machine, &problem));
    of_files.chain(of_rules).collect()
}

fn for_people(machine: &Machine, findings: &[Finding]) -> String {
    let text: String = findings.iter().map(ToString::to_string).collect();
    let count = |level| findings.iter().filter(|finding| finding.level == level).count() as u64;
    let (errors, notes) = (count(Level::Error), count(Level::Note));
    let states = counted(machine.count() as u64, "state");
    let name = harmless(&machine.root.name);
    let (errors, notes) = (counted(errors, "error"), counted(notes, "note"));
    text + &format!("{name}: {states}, {errors}, {notes}\n")
}

fn lines(findings: &[Finding]) -> Result<String> {
    let mut text = String::new();
    for finding in findings {
        text += &serde_json::to_string(finding)?;
        text.push('\n');
    }
    Ok(text)
}
