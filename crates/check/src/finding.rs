//! One thing that is wrong, whatever found it: what, where, and the way out.

use rafcon_model::{Part, Problem, StatePath};
use rafcon_protocol::api::{MachineProblem, Repair};
use rafcon_storage::LoadProblem;
use std::fmt;
use std::path::PathBuf;

pub use rafcon_protocol::api::Severity;

/// Something that is wrong with a machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Severity of the finding.
    pub severity: Severity,
    /// The state; empty for the machine as a whole.
    pub path: StatePath,
    /// The part of the state in words, such as `outcome 0`; empty for the state as a whole.
    pub part: String,
    /// The rule, for programs.
    pub rule: &'static str,
    /// The file, below the machine's folder, if it is about a file.
    pub file: Option<PathBuf>,
    /// The line of the state's script, counted from 1.
    pub line: Option<u64>,
    /// Description of the fault in one sentence.
    pub what: String,
    /// Possible remedies, in one sentence.
    pub remedy: String,
    /// Edits that mend it, the one that keeps most first.
    pub repairs: Vec<Repair>,
}

impl Finding {
    /// A rule that is broken; without repairs.
    pub(crate) fn of_rule(problem: &Problem) -> Self {
        let severity = match problem.severity() {
            rafcon_model::Severity::Error => Severity::Error,
            rafcon_model::Severity::Note => Severity::Note,
        };
        let part =
            if problem.part == Part::State { String::new() } else { problem.part.to_string() };
        Self {
            severity,
            path: problem.path.clone(),
            part,
            rule: problem.rule.name(),
            file: None,
            line: None,
            what: problem.what.clone(),
            remedy: problem.way_out().to_owned(),
            repairs: Vec::new(),
        }
    }

    /// A fault of a file.
    pub(crate) fn of_file(problem: &LoadProblem) -> Self {
        let is_note = problem.fault.is_note();
        Self {
            severity: if is_note { Severity::Note } else { Severity::Error },
            path: problem.state.clone(),
            part: String::new(),
            rule: "File",
            file: Some(problem.file.clone()),
            line: None,
            what: problem.fault.to_string(),
            remedy: problem.fault.remedy().to_owned(),
            repairs: Vec::new(),
        }
    }

    /// Which file or part of the state it is about, in words.
    fn place(&self) -> String {
        match &self.file {
            Some(file) => format!("file {}", file.display()),
            None if self.part.is_empty() => "state".to_owned(),
            None => self.part.clone(),
        }
    }
}

/// In one line: `ROOT/A, outcome 0: what is wrong; what can be done`.
impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}: {}; {}", self.path, self.place(), self.what, self.remedy)
    }
}

impl From<&Finding> for MachineProblem {
    fn from(finding: &Finding) -> Self {
        Self {
            path: finding.path.to_string(),
            part: finding.place(),
            rule: finding.rule.to_owned(),
            severity: finding.severity,
            message: finding.to_string(),
            line: finding.line,
            repairs: finding.repairs.clone(),
        }
    }
}
