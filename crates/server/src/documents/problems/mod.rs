//! What is wrong with a machine, as clients are told, with edits that mend it.

mod changed;
mod repairs;

pub(super) use changed::of_libraries;

use rafcon_model::{BuiltinTypes, Machine, Problem, problems};
use rafcon_protocol::api::{MachineProblem, Repair, Severity};
use rafcon_storage::{Fault, LoadProblem};
use repairs::repairs;

/// Of so many problems it is found out how they are mended.
const REPAIRED_MAX: usize = 1000;

/// Every rule that the machine breaks.
pub(super) fn of_machine(machine: &Machine) -> Vec<MachineProblem> {
    let problems = problems(machine, &BuiltinTypes);
    let told = problems.iter().enumerate().map(|(index, problem)| {
        let repairs = if index < REPAIRED_MAX { repairs(machine, problem) } else { Vec::new() };
        of_rule(problem, repairs)
    });
    told.collect()
}

fn of_rule(problem: &Problem, repairs: Vec<Repair>) -> MachineProblem {
    MachineProblem {
        path: problem.path.to_string(),
        part: problem.part.to_string(),
        rule: problem.rule.name().to_owned(),
        severity: match problem.severity() {
            rafcon_model::Severity::Error => Severity::Error,
            rafcon_model::Severity::Note => Severity::Note,
        },
        message: problem.to_string(),
        repairs,
    }
}

/// A fault of a file; nothing if it is told of the machine as it is now.
pub(super) fn of_file(problem: &LoadProblem) -> Option<MachineProblem> {
    if let Fault::LibraryVersion { .. } | Fault::ValueWithoutPort { .. } = problem.fault {
        return None;
    }
    let is_note = problem.fault.is_note();
    Some(MachineProblem {
        path: problem.state.to_string(),
        part: format!("file {}", problem.file.display()),
        rule: "File".to_owned(),
        severity: if is_note { Severity::Note } else { Severity::Error },
        message: problem.to_string(),
        repairs: Vec::new(),
    })
}
