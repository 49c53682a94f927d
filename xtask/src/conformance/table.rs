//! The printed table: machine, verdict, difference.

use std::fmt::Write as _;

use super::compare::Difference;
use super::expectations::Expected;

/// Result for one machine.
#[derive(Debug)]
pub(crate) struct Row {
    machine: String,
    verdict: &'static str,
    notes: Vec<String>,
}

const SAME: &str = "same";
const EXPLAINED: &str = "explained";
const DIFFERS: &str = "DIFFERS";
const SKIPPED: &str = "skipped";

impl Row {
    /// Row of a skipped machine.
    pub(crate) fn skipped(machine: &str, reason: &str) -> Self {
        Self { machine: machine.to_owned(), verdict: SKIPPED, notes: vec![reason.to_owned()] }
    }

    /// A machine that could not be compared, with the reason.
    pub(crate) fn failed(machine: &str, reason: &anyhow::Error) -> Self {
        Self { machine: machine.to_owned(), verdict: DIFFERS, notes: vec![format!("{reason:#}")] }
    }

    /// Row of a compared machine.
    pub(crate) fn compared(machine: &str, differences: &[Difference], expected: &Expected) -> Self {
        let explained = |difference: &&Difference| expected.explanation(difference.what).is_some();
        let verdict = match differences.iter().find(|it| !explained(it)) {
            Some(_) => DIFFERS,
            None if differences.is_empty() => SAME,
            None => EXPLAINED,
        };
        let needs =
            expected.needs.iter().map(|needs| format!("takes its error path: needs {needs}"));
        let notes =
            needs.chain(differences.iter().map(|difference| note(difference, expected))).collect();
        Self { machine: machine.to_owned(), verdict, notes }
    }

    /// A machine that both engines stepped, with the effects of each command on its scripts.
    pub(crate) fn stepped(machine: &str, theirs: &[String], ours: &[String]) -> Self {
        let differs = |(theirs, ours): &(&String, &String)| theirs != ours;
        let note = match theirs.iter().zip(ours).find(differs) {
            Some((theirs, ours)) => Some(format!("reference {theirs}; here {ours}")),
            None if theirs.len() == ours.len() => None,
            None => {
                Some(format!("{} commands in the reference, {} here", theirs.len(), ours.len()))
            }
        };
        let verdict = if note.is_some() { DIFFERS } else { SAME };
        Self { machine: machine.to_owned(), verdict, notes: note.into_iter().collect() }
    }

    /// True if this row fails the run.
    pub(crate) fn is_failure(&self) -> bool {
        self.verdict == DIFFERS
    }
}

fn note(difference: &Difference, expected: &Expected) -> String {
    let Difference { what, detail } = difference;
    match expected.explanation(what) {
        Some(heading) => format!("{what}: see differences, “{heading}”"),
        None => format!("{what}: {detail}"),
    }
}

/// All rows, aligned, and the number of rows with each verdict.
pub(crate) fn render(rows: &[Row]) -> String {
    let width = rows.iter().map(|row| row.machine.chars().count()).max().unwrap_or_default();
    let mut text = String::new();
    for row in rows {
        let notes = if row.notes.is_empty() { String::new() } else { row.notes.join("; ") };
        let line = format!("{:width$}  {:9}  {notes}", row.machine, row.verdict);
        writeln!(text, "{}", line.trim_end()).unwrap_or_default();
    }
    let count = |verdict| rows.iter().filter(|row| row.verdict == verdict).count();
    let counts =
        [SAME, EXPLAINED, SKIPPED, DIFFERS].map(|verdict| format!("{} {verdict}", count(verdict)));
    writeln!(text, "\n{} machines: {}", rows.len(), counts.join(", ")).unwrap_or_default();
    text
}
