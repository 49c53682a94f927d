//! Comparison of two runs.
//!
//! Concurrent branches may interleave in any order, so only the order within a branch is compared. The inner root of a
//! library and the decider of a barrier have no entry of their own in the reference's history, and are left out.

use std::collections::BTreeMap;

use serde_json::Value;

use super::expectations::Expected;
use super::observed::{Observed, Places};

/// The id of every decider.
const DECIDER: &str = "unique_decider_state_id";

/// A difference between two runs.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Difference {
    /// `end`, `outcome`, `outputs`, `globals`, `scoped_variables`, `states_run`, `order` or `log`; expectations use these
    /// terms.
    pub(crate) what: &'static str,
    /// Both sides, the reference first.
    pub(crate) detail: String,
}

/// Compares a live run of the reference with ours.
pub(crate) fn all(theirs: &Observed, ours: &Observed, expected: &Expected) -> Vec<Difference> {
    let mut found = Vec::from_iter(order(theirs, ours, &theirs.places, expected.endless));
    if expected.endless {
        found.extend(end(theirs, ours));
        return found;
    }
    found.extend(ends(theirs, ours));
    found.extend(log(theirs, ours));
    found
}

/// Compares a recorded run of the reference with ours; `live` has the paths of libraries and concurrency states.
pub(crate) fn recorded(recorded: &Observed, ours: &Observed, live: &Observed) -> Vec<Difference> {
    let mut found = Vec::from_iter(order(recorded, ours, &live.places, false));
    found.extend(ends(recorded, ours));
    for difference in &mut found {
        difference.detail.insert_str(0, "recorded run: ");
    }
    found
}

/// Differences in the ends of the two runs, and in their final values.
fn ends(theirs: &Observed, ours: &Observed) -> Vec<Difference> {
    let values = [
        ("outcome", &theirs.outcome, &ours.outcome),
        ("outputs", &theirs.outputs, &ours.outputs),
        ("globals", &theirs.globals, &ours.globals),
        ("scoped_variables", &theirs.scoped_variables, &ours.scoped_variables),
    ];
    let runs = theirs.states_run.zip(ours.states_run).filter(|(theirs, ours)| theirs != ours);
    let runs = runs.map(|(theirs, ours)| Difference {
        what: "states_run",
        detail: format!("{theirs} ≠ {ours}"),
    });
    let differ = values.into_iter().filter(|(_, theirs, ours)| normal(theirs) != normal(ours));
    let values = differ
        .map(|(what, theirs, ours)| Difference { what, detail: format!("{theirs} ≠ {ours}") });
    end(theirs, ours).into_iter().chain(runs).chain(values).collect()
}

/// Difference if only one of the two runs ended by itself.
fn end(theirs: &Observed, ours: &Observed) -> Option<Difference> {
    let detail = format!("ended by itself: {} ≠ {}", theirs.finished, ours.finished);
    (theirs.finished != ours.finished).then_some(Difference { what: "end", detail })
}

/// The value in a comparable form: a leaf has no scoped variables or an empty set of them, and a syntax error names the
/// user's file only in our engine.
fn normal(value: &Value) -> Value {
    match value {
        Value::Null => Value::Object(serde_json::Map::new()),
        other => without_places(other),
    }
}

fn without_places(value: &Value) -> Value {
    match value {
        Value::Object(entries) => Value::Object(
            entries.iter().map(|(key, value)| (key.clone(), without_places(value))).collect(),
        ),
        Value::Array(items) => Value::Array(items.iter().map(without_places).collect()),
        Value::String(text) => Value::String(without_place(text).to_owned()),
        other => other.clone(),
    }
}

/// The message without the script and line that Python adds to a syntax error.
fn without_place(message: &str) -> &str {
    let line = message.strip_suffix(')').and_then(|rest| rest.rsplit_once(", line "));
    let Some((head, _)) = line.filter(|(_, number)| number.parse::<u32>().is_ok()) else {
        return message;
    };
    head.find(" (script.py").or_else(|| head.rfind(" (")).map_or(message, |at| &message[..at])
}

/// The order of entered states, for each branch.
fn order(theirs: &Observed, ours: &Observed, places: &Places, endless: bool) -> Option<Difference> {
    let (theirs, ours) = (branches(&theirs.entered, places), branches(&ours.entered, places));
    let detail = theirs.keys().chain(ours.keys()).find_map(|name| {
        let [theirs, ours] =
            [&theirs, &ours].map(|side| side.get(name).map_or(&[][..], Vec::as_slice));
        let at = first_difference(theirs, ours, endless)?;
        let entry = |side: &[&str]| side.get(at).map_or("nothing", |path| *path).to_owned();
        Some(format!("branch `{name}`, entry {}: {} ≠ {}", at + 1, entry(theirs), entry(ours)))
    });
    detail.map(|detail| Difference { what: "order", detail })
}

/// Index of the first difference between two orders. Endless runs may be cut anywhere, but must have at least one entry in
/// common.
fn first_difference(theirs: &[&str], ours: &[&str], endless: bool) -> Option<usize> {
    let (shorter, longer) = (theirs.len().min(ours.len()), theirs.len().max(ours.len()));
    let compared = if endless { shorter.max(1) } else { longer };
    (0..compared).find(|at| theirs.get(*at) != ours.get(*at))
}

/// The entered paths by branch. A branch is named by the innermost concurrent child above it; the main branch has no name.
fn branches<'a>(entered: &'a [String], places: &Places) -> BTreeMap<&'a str, Vec<&'a str>> {
    let mut branches = BTreeMap::<_, Vec<_>>::new();
    for path in entered.iter().map(String::as_str).filter(|path| is_compared(path, places)) {
        branches.entry(branch(path, places)).or_default().push(path);
    }
    branches
}

fn is_compared(path: &str, places: &Places) -> bool {
    let in_decider = path.split('/').any(|id| id == DECIDER);
    let parent = path.rsplit_once('/').map_or("", |(parent, _)| parent);
    !in_decider && !places.libraries.iter().any(|library| library == parent)
}

fn branch<'a>(path: &'a str, places: &Places) -> &'a str {
    let ends =
        path.match_indices('/').map(|(at, _)| at).chain([path.len()]).map(|end| &path[..end]);
    let is_branch = |prefix: &&str| {
        prefix
            .rsplit_once('/')
            .is_some_and(|(parent, _)| places.concurrency.iter().any(|it| it == parent))
    };
    ends.rev().find(is_branch).unwrap_or("")
}

/// Differences in the output of scripts. The order is ignored, because concurrent scripts print in any order, and the order
/// of states is compared separately.
fn log(theirs: &Observed, ours: &Observed) -> Option<Difference> {
    let sorted = |side: &Observed| {
        let mut lines = side
            .log
            .iter()
            .map(|line| without_place(line.trim_end()).to_owned())
            .collect::<Vec<_>>();
        lines.sort();
        lines
    };
    let (theirs, ours) = (sorted(theirs), sorted(ours));
    let missing = theirs
        .iter()
        .find(|line| count(&theirs, line) > count(&ours, line))
        .map(|line| format!("ours lacks {line:?}"));
    let extra = || {
        ours.iter()
            .find(|line| count(&ours, line) > count(&theirs, line))
            .map(|line| format!("only ours has {line:?}"))
    };
    missing.or_else(extra).map(|detail| Difference { what: "log", detail })
}

fn count(lines: &[String], line: &str) -> usize {
    lines.iter().filter(|other| *other == line).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn observed(entered: &[&str], concurrency: &[&str], libraries: &[&str]) -> Observed {
        let texts = |texts: &[&str]| texts.iter().map(|text| (*text).to_owned()).collect();
        let places = Places { libraries: texts(libraries), concurrency: texts(concurrency) };
        Observed { entered: texts(entered), places, ..Observed::default() }
    }

    fn check(theirs: &Observed, ours: &[&str], endless: bool) -> bool {
        order(theirs, &observed(ours, &[], &[]), &theirs.places, endless).is_none()
    }

    #[test]
    fn branches_may_interleave_but_not_reorder() {
        let theirs = observed(&["R", "R/B", "R/B/X/1", "R/B/X/2", "R/B/Y/1"], &["R/B"], &[]);
        assert!(check(&theirs, &["R", "R/B", "R/B/Y/1", "R/B/X/1", "R/B/X/2"], false));
        assert!(!check(&theirs, &["R", "R/B", "R/B/Y/1", "R/B/X/2", "R/B/X/1"], false));
    }

    #[test]
    fn inner_roots_and_deciders_are_left_out() {
        let theirs = observed(&["R", "R/L"], &[], &["R/L"]);
        assert!(check(&theirs, &["R", "R/L", "R/L/INNER", "R/unique_decider_state_id"], false));
    }

    #[test]
    fn an_endless_run_may_be_shorter() {
        let theirs = observed(&["R", "R/A", "R/A"], &[], &[]);
        assert!(check(&theirs, &["R", "R/A"], true));
        assert!(!check(&theirs, &["R", "R/A"], false));
        assert!(!check(&theirs, &["R", "R/C"], true));
        assert!(!check(&theirs, &[], true));
    }

    #[test]
    fn a_syntax_error_is_the_same_in_another_file() {
        assert_eq!(without_place("invalid syntax (script.py (2), line 2)"), "invalid syntax");
        let place = "unterminated (detected at line 2) (script.py (2), line 2)";
        assert_eq!(without_place(place), "unterminated (detected at line 2)");
        assert_eq!(without_place("invalid syntax (a.py, line 2)"), "invalid syntax");
        assert_eq!(without_place("open failed (13)"), "open failed (13)");
    }
}
