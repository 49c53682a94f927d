//! The table of `docs/ros.md`: each kind of message, size and call, by back end, distribution and direction.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use serde_json::{Value, json};

use crate::workspace;

/// The lines around the table in the document.
const BEGIN: &str = "<!-- table of `cargo xtask ros` -->\n";
const END: &str = "<!-- end of the table -->\n";

/// A back end and a distribution.
type Column = (String, String);

/// The cells in the order of the tests.
#[derive(Debug, Default)]
pub(super) struct Table {
    rows: Vec<(String, String)>,
    columns: Vec<Column>,
    /// The reason of each failure; `None` for a cell that passed.
    cells: BTreeMap<(usize, usize), Option<String>>,
}

impl Table {
    /// The file for the cells of one column; removes an earlier one.
    pub(super) fn file() -> Result<PathBuf> {
        let file = workspace::target()?.join("ros-table.jsonl");
        if file.exists() {
            fs::remove_file(&file).with_context(|| format!("cannot remove {}", file.display()))?;
        }
        Ok(file)
    }

    /// Adds the cells in a file. A missing file has no cells.
    pub(super) fn read(&mut self, file: &Path, backend: &str, distribution: &str) -> Result<()> {
        self.add(&fs::read_to_string(file).unwrap_or_default(), backend, distribution)
    }

    fn add(&mut self, text: &str, backend: &str, distribution: &str) -> Result<()> {
        let column = (backend.to_owned(), distribution.to_owned());
        let column = place(&mut self.columns, column);
        for line in text.lines() {
            let cell: Value =
                serde_json::from_str(line).with_context(|| format!("no cell: {line}"))?;
            let word = |name: &str| cell[name].as_str().unwrap_or_default().to_owned();
            let row = place(&mut self.rows, (word("kind"), word("direction")));
            let why = cell["why"].as_str().map(ToOwned::to_owned);
            let known = self.cells.entry((row, column)).or_default();
            *known = known.take().or(why);
        }
        Ok(())
    }

    /// The cells that failed, or that were not tested in one column but in another.
    pub(super) fn failures(&self) -> Vec<String> {
        let mut all = Vec::new();
        for (row, (kind, direction)) in self.rows.iter().enumerate() {
            for (column, (backend, distribution)) in self.columns.iter().enumerate() {
                let why = match self.cells.get(&(row, column)) {
                    Some(None) => continue,
                    Some(Some(why)) => why.as_str(),
                    None => "it was not tested",
                };
                all.push(format!("{kind}, {direction} ({distribution}, {backend}): {why}"));
            }
        }
        all
    }

    /// The number of failures as a figure.
    pub(super) fn figure(&self) -> Value {
        let failures = self.failures().len();
        json!({
            "name": "ros_table_failures", "value": failures, "limit": 0, "better": "is",
            "unit": "cells", "met": failures == 0 && !self.cells.is_empty(),
        })
    }

    /// The table as Markdown.
    fn markdown(&self) -> String {
        let mut text = "| kind | direction |".to_owned();
        for (backend, distribution) in &self.columns {
            let _infallible = write!(text, " {backend}, {distribution} |");
        }
        text.push_str("\n| --- | --- |");
        text.push_str(&" --- |".repeat(self.columns.len()));
        text.push('\n');
        for (row, (kind, direction)) in self.rows.iter().enumerate() {
            let _infallible = write!(text, "| {kind} | {direction} |");
            for column in 0..self.columns.len() {
                text.push_str(match self.cells.get(&(row, column)) {
                    Some(None) => " yes |",
                    Some(Some(_)) => " **no** |",
                    None => " – |",
                });
            }
            text.push('\n');
        }
        text
    }

    /// Writes the table into the document.
    pub(super) fn write(&self) -> Result<()> {
        let path = workspace::path("docs/ros.md");
        let text =
            fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let (before, rest) = text.split_once(BEGIN).context("docs/ros.md has no table")?;
        let (_, after) = rest.split_once(END).context("the table in docs/ros.md has no end")?;
        let text = format!("{before}{BEGIN}{}{END}{after}", self.markdown());
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))
    }
}

/// The index of an entry, which is added if it is new.
fn place<T: PartialEq>(list: &mut Vec<T>, one: T) -> usize {
    list.iter().position(|known| *known == one).unwrap_or_else(|| {
        list.push(one);
        list.len() - 1
    })
}

#[cfg(test)]
mod tests {
    use super::Table;

    #[test]
    fn a_cell_that_failed_or_is_missing_is_a_failure() {
        let mut table = Table::default();
        let good = |kind| format!(r#"{{"kind":"{kind}","direction":"to","why":null}}"#);
        table.add(&format!("{}\n{}\n", good("a"), good("b")), "native", "jazzy").unwrap();
        assert_eq!(table.figure()["met"], true);
        let lost = r#"{"kind":"a","direction":"to","why":"lost"}"#;
        table.add(lost, "native", "kilted").unwrap();
        assert_eq!(
            table.failures(),
            ["a, to (kilted, native): lost", "b, to (kilted, native): it was not tested"]
        );
        assert_eq!(
            table.markdown(),
            "| kind | direction | native, jazzy | native, kilted |\n| --- | --- | --- | --- |\n| a | to | yes | **no** |\n| b | to | yes | – |\n"
        );
    }
}
