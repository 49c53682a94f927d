//! Everything that is wrong with a machine: faults of its files, broken rules, and scripts that do not fit their states.
//!
//! The only checker of `rafcon check`, the server and the page. Knows machines and Python's facts about the texts of scripts. Does
//! not know the caller, HTTP, terminals, or how an interpreter is started.

mod facts;
mod finding;
mod globals;
mod repairs;
mod scripts;

pub use facts::{Facts, FactsError, SCRIPT_READER, read_facts, request};
pub use finding::{Finding, Severity};

use rafcon_model::{BuiltinTypes, Machine, Rule, problems};
use rafcon_storage::{Fault, LoadProblem};
use repairs::repairs;
use std::collections::BTreeMap;

/// Limit of the findings for which repairs are computed.
const REPAIRED_MAX: usize = 1000;

/// Facts about scripts by their text. A missing script is reported as not checked.
pub type ScriptFacts<'t> = BTreeMap<&'t str, &'t Facts>;

/// The texts of all scripts of a machine, each once; those of a library too.
pub fn scripts(machine: &Machine) -> Vec<&str> {
    scripts::texts(machine)
}

/// Every rule that the machine breaks.
pub fn of_rules(machine: &Machine) -> Vec<Finding> {
    problems(machine, &BuiltinTypes).iter().map(Finding::of_rule).collect()
}

/// Every rule that the machine breaks, with the edits that mend it. Looking for them takes long where there are many.
pub fn of_rules_with_repairs(machine: &Machine) -> Vec<Finding> {
    let problems = problems(machine, &BuiltinTypes);
    let found = problems.iter().enumerate().map(|(index, problem)| {
        let repairs = if index < REPAIRED_MAX { repairs(machine, problem) } else { Vec::new() };
        Finding { repairs, ..Finding::of_rule(problem) }
    });
    found.collect()
}

/// Everything that is wrong with the scripts of a machine, and with the global variables that they read.
pub fn of_scripts(machine: &Machine, facts: &ScriptFacts<'_>) -> Vec<Finding> {
    let mut found = scripts::findings(machine, facts);
    found.extend(globals::findings(machine, facts));
    found
}

/// Faults of a text as the script of one state of the machine.
pub fn of_script(machine: &Machine, path: &rafcon_model::StatePath, facts: &Facts) -> Vec<Finding> {
    machine
        .state(path)
        .map_or_else(Vec::new, |state| scripts::of_state(machine, path, state, facts))
}

/// Faults of files as they were read.
pub fn of_files(problems: &[LoadProblem]) -> Vec<Finding> {
    problems.iter().map(Finding::of_file).collect()
}

/// All of it, for a machine as it was just read.
pub fn findings(machine: &Machine, files: &[LoadProblem], facts: &ScriptFacts<'_>) -> Vec<Finding> {
    let is_missing = |problem: &&LoadProblem| matches!(problem.fault, Fault::MissingLibrary { .. });
    let missing: Vec<_> = files.iter().filter(is_missing).map(|problem| &problem.state).collect();
    let mut found = of_files(files);
    // A library that is missing was a fault of its file.
    found.extend(of_rules(machine).into_iter().filter(|finding| {
        finding.rule != Rule::LibraryMissing.name() || !missing.contains(&&finding.path)
    }));
    found.extend(of_scripts(machine, facts));
    found
}

#[cfg(test)]
mod tests {
    use super::{REPAIRED_MAX, of_rules_with_repairs};
    use rafcon_testkit::notation;

    #[test]
    fn the_first_findings_have_repairs_and_all_are_reported() {
        let count = REPAIRED_MAX + 1;
        let lines = |line: fn(usize) -> String| (0..count).map(line).collect::<String>();
        let outcomes = lines(|nth| format!("    outcome o{nth}\n"));
        let ways = lines(|nth| format!("  AAAAAA.o{nth} -> GONEEE\n"));
        let text = format!("hierarchy ROOT\n{ways}  execution AAAAAA\n{outcomes}");
        let machine = notation::parse(&text).expect("a machine");
        let findings = of_rules_with_repairs(&machine);
        let rule = findings[REPAIRED_MAX].rule;
        let broken: Vec<_> = (0..).zip(&findings).filter(|(_, it)| it.rule == rule).collect();
        assert_eq!(broken.len(), count);
        for (nth, finding) in broken {
            assert_eq!(finding.repairs.is_empty(), nth >= REPAIRED_MAX, "finding {nth}");
        }
    }
}
