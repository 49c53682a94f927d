//! `rafcon check`: all problems of a machine, from its files, its rules and its scripts.

use crate::cli::{self, CheckFormat};
use crate::environment::Environment;
use crate::machine::Source;
use crate::view::{counted, harmless, names_of};
use anyhow::{Context as _, Result, bail};
use rafcon_check::{
    Facts, Finding, SCRIPT_READER, ScriptFacts, Severity, findings, read_facts, request,
};
use rafcon_model::Machine;
use rafcon_supervisor::Interpreter;
use serde::Serialize;
use std::fmt;
use std::io::{self, Write as _};
use std::process::{Command, ExitCode, Stdio};

/// Lists every problem; the exit code is 1 if one of them is an error.
pub(super) fn check(raw: &cli::Check, environment: &Environment) -> Result<ExitCode> {
    let source = Source::new(&raw.path, &raw.libraries)?;
    let interpreter = Interpreter::choose(raw.python.python.as_deref(), &environment.locations)?;
    let loaded = source.load()?;
    let texts = rafcon_check::scripts(&loaded.machine);
    let facts = read_scripts(&texts, &interpreter)?;
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

/// A problem: description, location and remedy.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
struct FindingLine {
    level: Severity,
    /// Ids from the root down, joined by `/`; empty for the machine as a whole.
    path: String,
    /// The names along the path.
    name: String,
    /// A part of the state; empty for the state as a whole.
    part: String,
    /// File relative to the machine's folder; empty if none is concerned.
    file: String,
    /// Description of the problem.
    what: String,
    remedy: String,
}

impl FindingLine {
    fn of(machine: &Machine, finding: &Finding) -> Self {
        Self {
            level: finding.severity,
            path: finding.path.to_string(),
            name: names_of(machine, &finding.path).unwrap_or_default(),
            part: finding.part.clone(),
            file: finding.file.as_ref().map(|file| file.display().to_string()).unwrap_or_default(),
            what: finding.what.clone(),
            remedy: finding.remedy.clone(),
        }
    }
}

impl fmt::Display for FindingLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let level = match self.level {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        let places = [self.name.as_str(), &self.part].into_iter().filter(|place| !place.is_empty());
        let places = places.map(|place| format!("{place}: ")).collect::<Vec<_>>();
        writeln!(f, "{level}: {}{}", places.concat(), self.what)?;
        writeln!(f, "    {}", self.remedy)?;
        let at = [self.path.as_str(), &self.file].into_iter().filter(|place| !place.is_empty());
        let at = at.collect::<Vec<_>>().join(", ");
        if !at.is_empty() {
            writeln!(f, "    at {at}")?;
        }
        Ok(())
    }
}

/// Reads all scripts in one Python process, without running them. Fails if Python is not available.
fn read_scripts(texts: &[&str], interpreter: &Interpreter) -> Result<Vec<Facts>> {
    if texts.is_empty() {
        return Ok(Vec::new());
    }
    let mut child = Command::new(&interpreter.program)
        .args(["-I", "-c", SCRIPT_READER])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| {
            format!(
                "cannot start the Python interpreter `{interpreter}`: {}",
                interpreter.way_out()
            )
        })?;
    if let Some(mut stdin) = child.stdin.take() {
        // If the interpreter ends before it has read everything, its error output has the reason.
        stdin.write_all(&request(texts)?).unwrap_or_default();
    }
    let output = child.wait_with_output()?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        bail!(
            "the Python interpreter `{interpreter}` cannot read scripts ({}): {}\n{}",
            output.status,
            interpreter.way_out(),
            said.trim_end()
        );
    }
    read_facts(&output.stdout, texts.len())
        .with_context(|| format!("the Python interpreter `{interpreter}`"))
}
