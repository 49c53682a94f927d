//! Scripts against their states: outcomes that they return, ports that they read and write.

use crate::ScriptFacts;
use crate::facts::{Facts, Returned};
use crate::finding::{Finding, Severity};
use crate::repairs::possible;
use rafcon_model::{
    CONFLICT_REMEDY, Kind, LibraryContent, Machine, Outcomes, Ports, State, StatePath,
};
use rafcon_protocol::api::Repair;
use rafcon_protocol::edit::{Edit, PortList};
use std::collections::BTreeSet;
use std::sync::Arc;

/// The input under which the error of the state before arrives, also without a port.
const ERROR: &str = "error";

/// A script where it is used.
pub(crate) struct Use<'m> {
    pub(crate) path: StatePath,
    pub(crate) state: &'m State,
    pub(crate) text: &'m str,
}

/// All scripts from the root down; the content of a library once, below the first state that uses it.
pub(crate) fn uses(machine: &Machine) -> Vec<Use<'_>> {
    let mut found = Vec::new();
    let mut seen: BTreeSet<*const State> = BTreeSet::new();
    let mut open = vec![(StatePath::root(machine.root.id.clone()), &machine.root)];
    while let Some((path, state)) = open.pop() {
        if let Some(text) = state.script().and_then(|script| script.text.as_deref()) {
            found.push(Use { path: path.clone(), state, text });
        }
        if let Kind::Library(library) = &state.kind
            && let LibraryContent::Found(root) = &library.content
            && seen.insert(Arc::as_ptr(root))
        {
            open.push((path.child(root.id.clone()), root));
        }
        let children =
            state.container().into_iter().flat_map(|inside| inside.states.values().rev());
        open.extend(children.map(|child| (path.child(child.id.clone()), child)));
    }
    found
}

/// The texts of all scripts, each once.
pub(crate) fn texts(machine: &Machine) -> Vec<&str> {
    let texts: BTreeSet<&str> = uses(machine).iter().map(|used| used.text).collect();
    texts.into_iter().collect()
}

/// Everything that is wrong with scripts, state by state.
pub(crate) fn findings(machine: &Machine, facts: &ScriptFacts<'_>) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut unread = 0;
    for used in uses(machine).into_iter().filter(|used| used.state.damage.is_none()) {
        match facts.get(used.text) {
            Some(facts) => found.extend(of_state(machine, &used.path, used.state, facts)),
            None => unread += 1,
        }
    }
    if unread > 0 {
        let scripts = if unread == 1 { "1 script".to_owned() } else { format!("{unread} scripts") };
        found.push(Finding {
            severity: Severity::Warning,
            path: StatePath::default(),
            part: "scripts".to_owned(),
            rule: "ScriptsUnchecked",
            file: None,
            line: None,
            what: format!("{scripts} could not be checked"),
            remedy: "make sure that Python starts, and check again".to_owned(),
            repairs: Vec::new(),
        });
    }
    found
}

/// Faults of a text as the script of this state.
pub(crate) fn of_state(
    machine: &Machine,
    path: &StatePath,
    state: &State,
    facts: &Facts,
) -> Vec<Finding> {
    let judge = Judge { machine, path, state };
    if facts.conflict.is_some() {
        let what = "the script has conflict markers of a merge";
        return vec![judge.error("ScriptSyntax", facts.conflict, what, CONFLICT_REMEDY)];
    }
    if let Some(syntax) = &facts.syntax {
        let what = format!("the script does not parse: {}", syntax.message);
        let remedy = "correct the line; the state aborts until then";
        return vec![judge.error("ScriptSyntax", syntax.line, what, remedy)];
    }
    if let Some(line) = facts.r#async.first() {
        let remedy = "write `def execute`, and run coroutines with `asyncio.run(…)` inside; the state aborts until then";
        return vec![judge.error("ScriptExecute", Some(*line), "`execute` is a coroutine", remedy)];
    }
    if !facts.execute {
        let remedy =
            "write `def execute(self, inputs, outputs, gvm):`; the state aborts until then";
        let what = "the script has no function `execute`";
        return vec![judge.error("ScriptExecute", None, what, remedy)];
    }
    let mut found = judge.signature(facts);
    found.extend(
        facts.outcomes.iter().filter_map(|(line, returned)| judge.returned(*line, returned)),
    );
    found.extend(facts.inputs.iter().filter_map(|(line, name)| judge.input(*line, name)));
    found.extend(facts.outputs.iter().filter_map(|(line, name)| judge.output(*line, name)));
    found
}

/// The inputs or the outputs of a state.
struct PortGroup<'s> {
    /// Name of such a port in messages.
    kind: &'static str,
    /// Kind of the ports in edits.
    list: PortList,
    /// The ports that the state has.
    ports: &'s Ports,
}

/// A state whose script is checked.
struct Judge<'m> {
    machine: &'m Machine,
    path: &'m StatePath,
    state: &'m State,
}

impl Judge<'_> {
    fn error(
        &self,
        rule: &'static str,
        line: Option<u64>,
        what: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Finding {
        let part = line.map_or_else(|| "script.py".to_owned(), |line| format!("script.py:{line}"));
        Finding {
            severity: Severity::Error,
            path: self.path.clone(),
            part,
            rule,
            file: None,
            line,
            what: what.into(),
            remedy: remedy.into(),
            repairs: Vec::new(),
        }
    }

    fn signature(&self, facts: &Facts) -> Vec<Finding> {
        let mut found = Vec::new();
        if facts.line.is_some() && !facts.takes_four {
            let what = "`execute` cannot be called with four arguments";
            let remedy = "write `def execute(self, inputs, outputs, gvm):`";
            found.push(self.error("ScriptExecute", facts.line, what, remedy));
        }
        if facts.line.is_some() && facts.returns_nothing {
            let what = "`execute` never returns an outcome, so the state aborts";
            let remedy = format!("return one of {}", listed(&self.state.outcomes));
            let severity = if facts.raises { Severity::Note } else { Severity::Error };
            let finding = self.error("ScriptOutcome", facts.line, what, remedy);
            found.push(Finding { severity, ..finding });
        }
        found
    }

    fn returned(&self, line: u64, returned: &Returned) -> Option<Finding> {
        let outcomes = &self.state.outcomes;
        let (shown, name) = match returned {
            Returned::Name(name) if outcomes.by_name(name).is_none() => {
                (format!("{name:?}"), Some(name))
            }
            Returned::Id(id) if !outcomes.iter().any(|one| Some(one.id.0) == id.as_i64()) => {
                (id.to_string(), None)
            }
            Returned::Name(_) | Returned::Id(_) => return None,
        };
        let what = format!("`execute` returns {shown}, which is not an outcome of the state");
        let remedy = format!("return one of {}, or add the outcome", listed(outcomes));
        let added = name.and_then(|name| self.add_outcome(name));
        let finding = self.error("ScriptOutcome", Some(line), what, remedy);
        Some(Finding { repairs: added.into_iter().collect(), ..finding })
    }

    fn add_outcome(&self, name: &str) -> Option<Repair> {
        let (path, outcome) = (self.path.to_string(), self.state.free_outcome_id().0);
        let edit = Edit::AddOutcome { path, outcome, name: name.to_owned() };
        possible(self.machine, format!("Add the outcome \"{name}\""), edit)
    }

    fn input(&self, line: u64, name: &str) -> Option<Finding> {
        if has(&self.state.inputs, name) || name == ERROR {
            return None;
        }
        let what = format!(
            "`execute` reads the input {name:?}, but the state has no such input and aborts"
        );
        let ports = &self.state.inputs;
        let inputs = PortGroup { kind: "input", list: PortList::Input, ports };
        Some(self.port_finding(line, name, what, &inputs))
    }

    fn output(&self, line: u64, name: &str) -> Option<Finding> {
        if has(&self.state.outputs, name) {
            return None;
        }
        let what = format!(
            "`execute` writes the output {name:?}, but the state has no such output, and the value is lost"
        );
        let ports = &self.state.outputs;
        let outputs = PortGroup { kind: "output", list: PortList::Output, ports };
        Some(self.port_finding(line, name, what, &outputs))
    }

    fn port_finding(&self, line: u64, name: &str, what: String, group: &PortGroup<'_>) -> Finding {
        let kind = group.kind;
        let known: Vec<_> = group.ports.iter().map(|port| format!("{:?}", port.name)).collect();
        let remedy = if known.is_empty() {
            format!("add the {kind} {name:?}")
        } else {
            format!("use one of {}, or add the {kind}", known.join(", "))
        };
        let finding = self.error("ScriptPort", Some(line), what, remedy);
        Finding { repairs: self.add_port(name, group).into_iter().collect(), ..finding }
    }

    fn add_port(&self, name: &str, group: &PortGroup<'_>) -> Option<Repair> {
        let PortGroup { kind, list, .. } = *group;
        let edit = Edit::AddPort {
            path: self.path.to_string(),
            list,
            port: self.state.free_port_id().0,
            name: name.to_owned(),
            data_type: "object".to_owned(),
            default: serde_json::Value::Null,
        };
        possible(self.machine, format!("Add the {kind} \"{name}\""), edit)
    }
}

fn has(ports: &Ports, name: &str) -> bool {
    ports.iter().any(|port| port.name == name)
}

fn listed(outcomes: &Outcomes) -> String {
    let names = outcomes.iter().filter(|outcome| !outcome.id.is_mandatory());
    let names: Vec<_> = names.map(|outcome| format!("{:?}", outcome.name)).collect();
    if names.is_empty() { "\"aborted\", \"preempted\"".to_owned() } else { names.join(", ") }
}

#[cfg(test)]
mod tests;
