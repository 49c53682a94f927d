//! One thing that is wrong, from whatever source, as people and programs read it.

use crate::view::names_of;
use rafcon_model::{Machine, Part, Problem, Severity, StatePath};
use rafcon_storage::LoadProblem;
use serde::Serialize;
use std::fmt;

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Level {
    /// The machine does not work as drawn.
    Error,
    /// Worth knowing.
    Note,
}

/// Something that is wrong: what, where, and the way out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct Finding {
    pub(super) level: Level,
    /// Ids from the root down, joined by `/`; empty for the machine as a whole.
    pub(super) path: String,
    /// The names along the path.
    pub(super) name: String,
    /// A part of the state; empty for the state as a whole.
    pub(super) part: String,
    /// The file, relative to the machine's folder; empty if it is not about a file.
    pub(super) file: String,
    /// What is wrong.
    pub(super) what: String,
    /// What can be done.
    pub(super) remedy: String,
}

impl Finding {
    /// A fault of a file.
    pub(super) fn of_file(machine: &Machine, problem: &LoadProblem) -> Self {
        let level = if problem.fault.is_note() { Level::Note } else { Level::Error };
        Self {
            level,
            file: problem.file.display().to_string(),
            what: problem.fault.to_string(),
            remedy: problem.fault.remedy().to_owned(),
            ..Self::at(machine, &problem.state)
        }
    }

    /// A rule that is broken.
    pub(super) fn of_rule(machine: &Machine, problem: &Problem) -> Self {
        let level = match problem.severity() {
            Severity::Error => Level::Error,
            Severity::Note => Level::Note,
        };
        let part =
            if problem.part == Part::State { String::new() } else { problem.part.to_string() };
        Self {
            level,
            part,
            what: problem.what.clone(),
            remedy: problem.way_out().to_owned(),
            ..Self::at(machine, &problem.path)
        }
    }

    /// Something wrong with a script.
    pub(super) fn of_script(machine: &Machine, path: &StatePath, script: Complaint) -> Self {
        let part = match script.line {
            Some(line) => format!("script.py:{line}"),
            None => "script.py".to_owned(),
        };
        let (level, what, remedy) = (script.level, script.what, script.remedy);
        Self { level, part, what, remedy, ..Self::at(machine, path) }
    }

    fn at(machine: &Machine, path: &StatePath) -> Self {
        Self {
            level: Level::Error,
            path: path.to_string(),
            name: names_of(machine, path).unwrap_or_default(),
            part: String::new(),
            file: String::new(),
            what: String::new(),
            remedy: String::new(),
        }
    }
}

/// What is wrong with a script, wherever it is used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Complaint {
    pub(super) level: Level,
    /// Counted from 1.
    pub(super) line: Option<u64>,
    pub(super) what: String,
    pub(super) remedy: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let level = match self.level {
            Level::Error => "error",
            Level::Note => "note",
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
