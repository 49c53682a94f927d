//! `rafcon check`: everything that is wrong with a machine, from its files, its rules and its scripts.

mod finding;
mod scripts;

use crate::cli::{self, CheckFormat};
use crate::environment::Environment;
use crate::machine::Source;
use crate::view::{counted, harmless};
use anyhow::Result;
use finding::FindingLine;
use rafcon_check::{ScriptFacts, Severity, findings};
use rafcon_model::Machine;
use rafcon_supervisor::Interpreter;
use std::io::{self, Write as _};
use std::process::ExitCode;

/// Lists every problem; the exit code is 1 if one of them is an error.
pub(super) fn check(raw: &cli::Check, environment: &Environment) -> Result<ExitCode> {
    let source = Source::new(&raw.path, &raw.libraries)?;
    let interpreter = Interpreter::choose(raw.python.python.as_deref(), &environment.surroundings)?;
    let loaded = source.load()?;
    let texts = rafcon_check::scripts(&loaded.machine);
    let facts = scripts::read(&texts, &interpreter)?;
    let facts: ScriptFacts<'_> = texts.into_iter().zip(&facts).collect();
    let found = findings(&loaded.machine, &loaded.problems, &facts);
    let lines: Vec<_> =
        found.iter().map(|finding| FindingLine::of(&loaded.machine, finding)).collect();
    let text = match raw.format {
        CheckFormat::Text => for_people(&loaded.machine, &lines),
        CheckFormat::Json => for_programs(&lines)?,
    };
    io::stdout().write_all(text.as_bytes())?;
    let wrong = lines.iter().any(|line| line.level == Severity::Error);
    Ok(ExitCode::from(u8::from(wrong)))
}

fn for_people(machine: &Machine, lines: &[FindingLine]) -> String {
    let text: String = lines.iter().map(ToString::to_string).collect();
    let count = |levels: &[Severity]| {
        lines.iter().filter(|line| levels.contains(&line.level)).count() as u64
    };
    let states = counted(machine.count() as u64, "state");
    let name = harmless(&machine.root.name);
    let errors = counted(count(&[Severity::Error]), "error");
    let notes = counted(count(&[Severity::Warning, Severity::Note]), "note");
    text + &format!("{name}: {states}, {errors}, {notes}\n")
}

fn for_programs(lines: &[FindingLine]) -> Result<String> {
    let mut text = String::new();
    for line in lines {
        text += &serde_json::to_string(line)?;
        text.push('\n');
    }
    Ok(text)
}
