//! One finding as people and programs read it.

use crate::view::names_of;
use rafcon_check::{Finding, Severity};
use rafcon_model::Machine;
use serde::Serialize;
use std::fmt;

/// Something that is wrong: what, where, and the way out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct FindingLine {
    pub(super) level: Severity,
    /// Ids from the root down, joined by `/`; empty for the machine as a whole.
    path: String,
    /// The names along the path.
    name: String,
    /// A part of the state; empty for the state as a whole.
    part: String,
    /// The file, relative to the machine's folder; empty if it is not about a file.
    file: String,
    /// What is wrong.
    what: String,
    /// What can be done.
    remedy: String,
}

impl FindingLine {
    pub(super) fn of(machine: &Machine, finding: &Finding) -> Self {
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
