//! A machine as a graph for Graphviz: states are boxes, containers are clusters, their outcomes are small circles.

use super::order;
use rafcon_model::{Container, Machine, OutcomeId, State, StatePath, Target};
use std::fmt::Write as _;

pub(super) fn print(machine: &Machine) -> String {
    let mut out = String::from(
        "digraph machine {\n  compound=true; rankdir=LR; node [shape=box, style=rounded, fontname=\"sans-serif\"];\n",
    );
    state(&mut out, &machine.root, &StatePath::root(machine.root.id.clone()), &[]);
    out.push_str("}\n");
    out
}

/// Draws a state; `used` are its outcomes with transitions.
fn state(out: &mut String, state: &State, path: &StatePath, used: &[OutcomeId]) {
    let (id, name) = (quoted(&path.to_string()), quoted(&state.name));
    let indent = "  ".repeat(path.0.len());
    let Some(inside) = state.container() else {
        line(out, &indent, &format!("{id} [label={name}];"));
        return;
    };
    line(out, &indent, &format!("subgraph {} {{", quoted(&format!("cluster {path}"))));
    line(out, &indent, &format!("  label={name}; {} [shape=point, label=\"\"];", income(path)));
    for outcome in &state.outcomes {
        if used.contains(&outcome.id) || leads_somewhere(inside, state, outcome.id) {
            let (id, name) = (exit(path, outcome.id), quoted(&outcome.name));
            line(
                out,
                &indent,
                &format!(
                    "  {id} [shape=circle, width=0.2, fixedsize=true, label=\"\", xlabel={name}];"
                ),
            );
        }
    }
    for child in order::children(inside, &state.id) {
        let exits = order::exits(inside, &state.id, child).into_iter();
        let used: Vec<_> = exits.filter(|(_, target)| target.is_some()).map(|(id, _)| id).collect();
        self::state(out, child, &path.child(child.id.clone()), &used);
    }
    lines_between(out, &indent, state, inside, path);
    line(out, &indent, "}");
}

fn lines_between(
    out: &mut String,
    indent: &str,
    state: &State,
    inside: &Container,
    path: &StatePath,
) {
    for transition in inside.transitions.iter() {
        let Some(target) = transition.target(&state.id) else { continue };
        let to = match target {
            Target::State(child) => entry(inside, &child, path),
            Target::Outcome(outcome) => exit(path, outcome),
        };
        let (from, label) = match (&transition.from_state, transition.from_outcome) {
            (Some(child), Some(outcome)) => {
                let Some(child) = inside.states.get(child) else { continue };
                let name = child.outcomes.get(outcome).map_or("", |outcome| &outcome.name);
                (leave(child, outcome, path), quoted(name))
            }
            _ => (income(path), quoted("")),
        };
        line(out, indent, &format!("  {from} -> {to} [label={label}];"));
    }
}

fn leads_somewhere(inside: &Container, state: &State, outcome: OutcomeId) -> bool {
    let target = Some(Target::Outcome(outcome));
    !outcome.is_mandatory() || inside.transitions.iter().any(|t| t.target(&state.id) == target)
}

/// Target of an arrow to a child: its box, or the income in its cluster.
fn entry(inside: &Container, child: &rafcon_model::StateId, path: &StatePath) -> String {
    let path = path.child(child.clone());
    match inside.states.get(child).and_then(|child| child.container()) {
        Some(_) => income(&path),
        None => quoted(&path.to_string()),
    }
}

/// Source of an arrow from a child's outcome.
fn leave(child: &State, outcome: OutcomeId, path: &StatePath) -> String {
    let path = path.child(child.id.clone());
    match child.container() {
        Some(_) => exit(&path, outcome),
        None => quoted(&path.to_string()),
    }
}

fn income(path: &StatePath) -> String {
    quoted(&format!("{path} income"))
}

fn exit(path: &StatePath, outcome: OutcomeId) -> String {
    quoted(&format!("{path} outcome {outcome}"))
}

fn line(out: &mut String, indent: &str, text: &str) {
    writeln!(out, "{indent}{text}").unwrap_or_default();
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}
