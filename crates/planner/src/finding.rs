//! Problems of skills, facts or a goal, with the libraries that they concern.

use smol_str::SmolStr;
use std::fmt;

/// The severity of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Planning is impossible until this is fixed.
    Error,
    /// Planning is possible, but the plan may not be the intended one.
    Warning,
}

/// A problem of skills, facts or a goal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Severity of the problem.
    pub severity: Severity,
    /// The libraries with the problem. Empty if it concerns facts, types or the goal.
    pub libraries: Vec<SmolStr>,
    /// A description of the problem and its remedy.
    pub text: String,
}

impl Finding {
    pub(crate) fn error(libraries: &[&SmolStr], text: impl Into<String>) -> Self {
        Self::new(Severity::Error, libraries, text)
    }

    pub(crate) fn warning(libraries: &[&SmolStr], text: impl Into<String>) -> Self {
        Self::new(Severity::Warning, libraries, text)
    }

    fn new(severity: Severity, libraries: &[&SmolStr], text: impl Into<String>) -> Self {
        let mut libraries: Vec<SmolStr> =
            libraries.iter().map(|&library| library.clone()).collect();
        libraries.dedup();
        Self { severity, libraries, text: text.into() }
    }

    /// True if planning is impossible.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.severity {
            Severity::Error => "error: ",
            Severity::Warning => "warning: ",
        })?;
        if !self.libraries.is_empty() {
            write!(f, "{}: ", self.libraries.join(", "))?;
        }
        f.write_str(&self.text)
    }
}
