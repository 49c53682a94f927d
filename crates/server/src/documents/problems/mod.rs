//! Problems of an open machine: findings of the checker, and changed libraries.

mod changed;

pub(super) use changed::of_libraries;

use crate::ServerState;
use rafcon_check::{Finding, ScriptFacts, of_files, of_rules_with_repairs, of_scripts};
use rafcon_model::Machine;
use rafcon_protocol::api::MachineProblem;
use rafcon_storage::LoadProblem;

/// All rules that the machine breaks.
pub(super) fn rules(machine: &Machine) -> Vec<MachineProblem> {
    told(&of_rules_with_repairs(machine))
}

/// Problems of its scripts. Parses new scripts, so call it only from blocking threads.
pub(super) fn scripts(machine: &Machine, server: &ServerState) -> Vec<MachineProblem> {
    let texts = rafcon_check::scripts(machine);
    let facts = server.python.facts(&server.settings, &texts);
    let pairs = texts.into_iter().zip(&facts);
    let facts: ScriptFacts<'_> =
        pairs.filter_map(|(text, facts)| Some((text, &**facts.as_ref()?))).collect();
    told(&of_scripts(machine, &facts))
}

/// Faults of its files, without those that the rules report for the current machine.
pub(super) fn files(problems: &[LoadProblem]) -> Vec<MachineProblem> {
    let rest: Vec<_> =
        problems.iter().filter(|problem| !problem.is_found_by_rules()).cloned().collect();
    told(&of_files(&rest))
}

fn told(findings: &[Finding]) -> Vec<MachineProblem> {
    findings.iter().map(MachineProblem::from).collect()
}
