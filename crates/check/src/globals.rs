//! Global variables that are read and that nothing in the machine sets.

use crate::ScriptFacts;
use crate::finding::{Finding, Severity};
use crate::scripts::uses;
use rafcon_model::{Machine, StatePath};
use std::collections::BTreeSet;

/// A note for each global variable that a script reads and no script of the machine sets. Empty if a script was not read, or if a
/// script sets variables by computed names.
pub(crate) fn findings(machine: &Machine, facts: &ScriptFacts<'_>) -> Vec<Finding> {
    let uses = uses(machine);
    let mut set = BTreeSet::new();
    for used in &uses {
        match facts.get(used.text) {
            Some(facts) if !facts.sets_any_global => {
                set.extend(facts.globals_set.iter().map(String::as_str));
            }
            Some(_) | None => return Vec::new(),
        }
    }
    let mut found = Vec::new();
    for used in &uses {
        let read = facts.get(used.text).into_iter().flat_map(|facts| &facts.globals_read);
        let mut named = BTreeSet::new();
        for (line, name) in read {
            if !set.contains(name.as_str()) && named.insert(name) {
                found.push(note(&used.path, *line, name));
            }
        }
    }
    found
}

fn note(path: &StatePath, line: u64, name: &str) -> Finding {
    Finding {
        severity: Severity::Note,
        path: path.clone(),
        part: format!("script.py:{line}"),
        rule: "GlobalNeverSet",
        file: None,
        line: Some(line),
        what: format!(
            "no script of the machine sets the global variable {name:?}, which is read here"
        ),
        remedy: "set it in a script, or set it at the start of the machine".to_owned(),
        repairs: Vec::new(),
    }
}
