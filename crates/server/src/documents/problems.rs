//! What is wrong with a machine, as clients are told.

use rafcon_model::{BuiltinTypes, Machine, Problem, problems};
use rafcon_protocol::api::{MachineProblem, Severity};
use rafcon_storage::LoadProblem;

/// Every rule that the machine breaks.
pub(super) fn of_machine(machine: &Machine) -> Vec<MachineProblem> {
    problems(machine, &BuiltinTypes).iter().map(of_rule).collect()
}

fn of_rule(problem: &Problem) -> MachineProblem {
    MachineProblem {
        path: problem.path.to_string(),
        part: problem.part.to_string(),
        rule: problem.rule.name().to_owned(),
        severity: match problem.severity() {
            rafcon_model::Severity::Error => Severity::Error,
            rafcon_model::Severity::Note => Severity::Note,
        },
        message: problem.to_string(),
        repairs: Vec::new(),
    }
}

/// A fault of a file.
pub(super) fn of_file(problem: &LoadProblem) -> MachineProblem {
    let is_note = problem.fault.is_note();
    MachineProblem {
        path: problem.state.to_string(),
        part: format!("file {}", problem.file.display()),
        rule: "File".to_owned(),
        severity: if is_note { Severity::Note } else { Severity::Error },
        message: problem.to_string(),
        repairs: Vec::new(),
    }
}
