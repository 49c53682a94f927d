//! What is wrong with skills, facts or a goal, named by the states it is about.

use smol_str::SmolStr;
use std::fmt;

/// Whether a plan can be made all the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// No plan can be made.
    Error,
    /// A plan can be made, and may not be what was meant.
    Warning,
}

/// Something that is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// The libraries that it is about; none if it is about facts, types or goal.
    pub libraries: Vec<SmolStr>,
    /// What it is, and the way out.
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

    /// Whether no plan can be made.
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
