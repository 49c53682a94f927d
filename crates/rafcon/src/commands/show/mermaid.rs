//! A machine as a Mermaid state diagram, for Markdown pages.

use super::order;
use rafcon_model::{Container, Kind, Machine, State, Target};
use std::fmt::Write as _;

pub(super) fn print(machine: &Machine) -> String {
    let mut diagram = Diagram { out: "stateDiagram-v2\n".to_owned(), numbers: 0 };
    diagram.state(&machine.root, 1);
    diagram.out
}

struct Diagram {
    out: String,
    /// Number of the next name. Mermaid requires plain names, unique in the whole diagram.
    numbers: usize,
}

impl Diagram {
    /// Draws a state and returns its name in the diagram.
    fn state(&mut self, state: &State, depth: usize) -> String {
        self.numbers += 1;
        let id = format!("s{}", self.numbers);
        let label = label(&state.name);
        match state.container().filter(|inside| !inside.states.is_empty()) {
            None => self.line(depth, &format!("state \"{label}\" as {id}")),
            Some(inside) => {
                self.line(depth, &format!("state \"{label}\" as {id} {{"));
                self.inside(state, inside, depth + 1);
                self.line(depth, "}");
            }
        }
        id
    }

    fn inside(&mut self, state: &State, inside: &Container, depth: usize) {
        let children = order::children(inside, &state.id);
        let concurrent = matches!(state.kind, Kind::Barrier(_) | Kind::Preemptive(_));
        let mut names = Vec::new();
        for (number, child) in children.iter().enumerate() {
            if concurrent && number > 0 {
                self.line(depth, "--");
            }
            let name = self.state(child, depth);
            names.push((child.id.clone(), name));
        }
        let name = |id: &rafcon_model::StateId| {
            names.iter().find(|(child, _)| child == id).map(|(_, name)| name.clone())
        };
        if let Some(start) = order::start(inside, &state.id).and_then(|start| name(&start)) {
            self.line(depth, &format!("[*] --> {start}"));
        }
        for child in children.iter().filter(|_| !concurrent) {
            for (outcome, target) in order::exits(inside, &state.id, child) {
                let outcome =
                    child.outcomes.get(outcome).map(|o| label(&o.name)).unwrap_or_default();
                let to = match target {
                    Some(Target::State(target)) => name(&target),
                    Some(Target::Outcome(_)) => Some("[*]".to_owned()),
                    None => None,
                };
                if let (Some(from), Some(to)) = (name(&child.id), to) {
                    self.line(depth, &format!("{from} --> {to} : {outcome}"));
                }
            }
        }
    }

    fn line(&mut self, depth: usize, text: &str) {
        writeln!(self.out, "{}{text}", "  ".repeat(depth)).unwrap_or_default();
    }
}

/// Text without characters that are special in Mermaid.
fn label(text: &str) -> String {
    text.chars()
        .map(
            |c| {
                if c.is_control() || matches!(c, '"' | ';' | ':' | '#' | '{' | '}') {
                    ' '
                } else {
                    c
                }
            },
        )
        .collect()
}
