//! Overlays of the view on request: the meaning of the keys, or the data of one state.

use super::Data;
use crate::view::{Style, TextLine, harmless, shown};
use rafcon_protocol::Values;

const KEYS: [(&str, &str); 15] = [
    ("p", "pause"),
    ("c, space", "continue"),
    ("s", "step into the next state"),
    ("n", "step over it"),
    ("o", "step out of its container"),
    ("b", "step back"),
    ("m", "step mode: pause before each next state"),
    ("C S N O B", "the same for the branch of the selected state only"),
    ("up, down", "select a state"),
    ("i", "show its data"),
    ("k, K", "set a breakpoint, remove one"),
    ("t", "run to a state"),
    ("f", "end a paused or waiting state with an outcome, or skip the next one"),
    ("a", "answer a question"),
    ("A, R", "abort what a crash interrupted, or run it again"),
];

/// The keys, one a line.
pub(super) fn help(may_leave: bool) -> Vec<TextLine> {
    let rest = [("e", "ask the selected state to end"), ("X", "stop the run")];
    let leave = may_leave.then_some(("q", "leave; the run continues"));
    let line = |(key, meaning): (&str, &str)| {
        TextLine::of(Style::Strong, format!("{key:>10}")).and(Style::Plain, format!("  {meaning}"))
    };
    KEYS.into_iter().chain(rest).chain(leave).map(line).collect()
}

/// Values shown at most in each group.
const VALUES_MAX: usize = 12;

/// Lines for the data of the state at `path`: pending, no longer active, or received.
pub(super) fn inspection(path: &str, data: &Data) -> Vec<TextLine> {
    let mut lines = vec![TextLine::of(Style::Strong, harmless(path))];
    match data {
        Data::Asked => lines.push(TextLine::of(Style::Dim, "  …")),
        Data::NotActive => lines.push(TextLine::of(Style::Dim, "  is no longer active")),
        Data::Told(data) => {
            let groups =
                [("in", &data.inputs), ("out", &data.outputs), ("var", &data.scoped_variables)];
            for (word, values) in groups {
                group(word, values, &mut lines);
            }
            if lines.len() == 1 {
                lines.push(TextLine::of(Style::Dim, "  has no data"));
            }
        }
    }
    lines
}

fn group(word: &str, values: &Values, lines: &mut Vec<TextLine>) {
    let width = values.keys().map(|name| name.chars().count()).max().unwrap_or(0);
    lines.extend(values.iter().take(VALUES_MAX).map(|(name, value)| {
        TextLine::of(Style::Dim, format!("  {word:>3} "))
            .and(Style::Plain, format!("{:width$} = ", harmless(name)))
            .and(Style::Strong, harmless(&shown(value)))
    }));
    if let Some(more) = values.len().checked_sub(VALUES_MAX).filter(|more| *more > 0) {
        lines.push(TextLine::of(Style::Dim, format!("  {word:>3} and {more} more")));
    }
}

#[cfg(test)]
mod tests {
    use super::{VALUES_MAX, group};
    use crate::view::Paint;
    use expect_test::expect;
    use rafcon_protocol::Values;

    #[test]
    fn of_more_values_than_are_shown_the_number_is() {
        let shown = |count: usize| {
            let values: Values = (0..count).map(|n| (format!("v{n:02}"), n.into())).collect();
            let mut lines = Vec::new();
            group("in", &values, &mut lines);
            let paint = Paint { colour: false, unicode: true };
            lines.iter().map(|line| line.render(paint)).collect::<Vec<_>>()
        };
        assert_eq!(shown(VALUES_MAX).len(), VALUES_MAX);
        expect!["   in and 2 more"].assert_eq(&shown(VALUES_MAX + 2)[VALUES_MAX]);
    }
}
