//! What one state holds, as lines.

use super::Data;
use crate::view::{Style, TextLine, harmless, shown};
use rafcon_protocol::Values;

/// Values shown at most in each group.
const VALUES_MAX: usize = 12;

/// The data of the state at `path`; nothing yet, or nothing at all.
pub(super) fn lines(path: &str, data: &Data) -> Vec<TextLine> {
    let mut lines = vec![TextLine::of(Style::Strong, harmless(path))];
    match data {
        Data::Asked => lines.push(TextLine::of(Style::Dim, "  …")),
        Data::NotActive => lines.push(TextLine::of(Style::Dim, "  is not active any more")),
        Data::Told(data) => {
            let groups =
                [("in", &data.inputs), ("out", &data.outputs), ("var", &data.scoped_variables)];
            for (word, values) in groups {
                group(word, values, &mut lines);
            }
            if lines.len() == 1 {
                lines.push(TextLine::of(Style::Dim, "  holds no data"));
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
