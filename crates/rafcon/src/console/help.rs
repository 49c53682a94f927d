//! What the keys mean, for people.

use crate::view::{Style, TextLine};

const KEYS: [(&str, &str); 15] = [
    ("p", "pause"),
    ("c, space", "go on"),
    ("s", "step into the next state"),
    ("n", "step over it"),
    ("o", "step out of its container"),
    ("b", "step back"),
    ("m", "step mode: hold wherever a next state would begin"),
    ("C S N O B", "the same for the branch of the selected state only"),
    ("up, down", "select a state"),
    ("i", "look at its data"),
    ("k, K", "set, remove a breakpoint"),
    ("t", "run to a state"),
    ("f", "end a held or waiting state by an outcome, or skip the next"),
    ("a", "answer a question"),
    ("A, R", "abort, run again what a crash interrupted"),
];

/// The keys, one a line.
pub(super) fn lines(may_leave: bool) -> Vec<TextLine> {
    let rest = [("e", "ask the selected state to end"), ("X", "stop the run")];
    let leave = may_leave.then_some(("q", "leave; the run goes on"));
    let line = |(key, meaning): (&str, &str)| {
        TextLine::of(Style::Strong, format!("{key:>10}")).and(Style::Plain, format!("  {meaning}"))
    };
    KEYS.into_iter().chain(rest).chain(leave).map(line).collect()
}
