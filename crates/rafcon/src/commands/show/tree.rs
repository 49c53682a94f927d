//! A machine as an indented tree: states with their children, and the targets of their outcomes.

use super::order;
use crate::view::{Paint, Style, TextLine, harmless};
use rafcon_model::{
    Container, Kind, LibraryContent, Machine, Origin, OutcomeId, Port, Ports, State, Target,
    literal,
};

/// The whole machine, without the contents of libraries.
pub(super) fn draw(machine: &Machine, paint: Paint) -> String {
    let mut tree = Tree { paint, out: String::new() };
    let root = &machine.root;
    tree.line(TextLine::default(), root, None);
    tree.children(root, "");
    tree.out
}

struct Tree {
    paint: Paint,
    out: String,
}

impl Tree {
    fn children(&mut self, parent: &State, above: &str) {
        let Some(inside) = parent.container() else { return };
        let [go_on, nothing, more, last, plain, begins] = if self.paint.unicode {
            ["│   ", "    ", "├─", "└─", "─ ", "▸ "]
        } else {
            ["|   ", "    ", "|-", "`-", "- ", "> "]
        };
        let start = order::start(inside, &parent.id);
        let children = order::children(inside, &parent.id);
        let count = children.len();
        for (number, child) in (1..).zip(children) {
            let is_last = number == count;
            let head =
                TextLine::of(Style::Dim, format!("{above}{}", if is_last { last } else { more }));
            let head = match &start {
                Some(start) if *start == child.id => head.and(Style::Good, begins),
                _ => head.and(Style::Dim, plain),
            };
            self.line(head, child, Some((parent, inside)));
            self.children(child, &format!("{above}{}", if is_last { nothing } else { go_on }));
        }
    }

    fn line(&mut self, head: TextLine, state: &State, place: Option<(&State, &Container)>) {
        let line = head
            .and(Style::Strong, harmless(&state.name))
            .and(Style::Dim, format!(" ({})", harmless(state.id.as_str())))
            .followed_by(kind(state))
            .followed_by(ports(" in", &state.inputs))
            .followed_by(ports(" out", &state.outputs))
            .followed_by(self.exits(state, place));
        self.out += &line.render(self.paint);
        self.out.push('\n');
    }

    /// Targets of the outcomes. Unconnected outcomes appear only in a hierarchy, and only if they are not mandatory.
    fn exits(&self, state: &State, place: Option<(&State, &Container)>) -> TextLine {
        let Some((parent, inside)) = place else { return TextLine::default() };
        let [arrow, end] = if self.paint.unicode { ["→", "●"] } else { ["->", "*"] };
        let is_waited_for = inside.transitions.from(&Origin::Income).next().is_some();
        let mut line = TextLine::default();
        for (outcome, target) in order::exits(inside, &parent.id, state) {
            let name = outcome_name(state, outcome);
            line = match target {
                Some(Target::State(target)) => {
                    let target = inside.states.get(&target).map_or(target.as_str(), |s| &s.name);
                    line.and(Style::Plain, format!("  {name} {arrow} {}", harmless(target)))
                }
                Some(Target::Outcome(target)) => {
                    let target = outcome_name(parent, target);
                    line.and(Style::Plain, format!("  {name} {arrow} {end}{target}"))
                }
                None if outcome.is_mandatory() || !is_waited_for => line,
                None => line.and(Style::Warning, format!("  {name} {arrow} ?")),
            };
        }
        line
    }
}

fn outcome_name(state: &State, id: OutcomeId) -> String {
    state.outcomes.get(id).map_or_else(|| id.to_string(), |outcome| harmless(&outcome.name))
}

fn kind(state: &State) -> TextLine {
    let text = match &state.kind {
        Kind::Execution(_) => return TextLine::default(),
        Kind::Library(library) => format!(" library {}/{}", library.path, library.name),
        other => format!(" {}", other.name()),
    };
    let line = TextLine::of(Style::Dim, harmless(&text));
    match &state.kind {
        Kind::Library(library) if matches!(library.content, LibraryContent::Missing { .. }) => {
            line.and(Style::Bad, " (missing)")
        }
        _ => line,
    }
}

fn ports(head: &str, ports: &Ports) -> TextLine {
    if ports.is_empty() {
        return TextLine::default();
    }
    let ports: Vec<_> = ports.iter().map(port).collect();
    TextLine::of(Style::Dim, harmless(&format!("{head}({})", ports.join(", "))))
}

fn port(port: &Port) -> String {
    let default = if port.default.is_none() { None } else { literal::write(&port.default) };
    let default = default.map(|text| format!(" = {text}")).unwrap_or_default();
    format!("{}: {}{default}", port.name, port.data_type)
}
