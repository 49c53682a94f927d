//! Checks that `docs/limits.md` lists every bound of the sources with its value.
//!
//! A bound is a constant whose name has one of the [`WORDS`]. A row names its file and its constant in backticks, then its
//! value, its effect, and the tests that reach it. A row without a test gives the reason why input cannot reach the bound.

mod value;

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;

use crate::workspace;
use value::Value;

/// The list, relative to the repository.
const DOCUMENT: &str = "docs/limits.md";
/// Parts of a constant's name that mark a bound.
const WORDS: [&str; 7] = ["MAX", "LIMIT", "MOST", "CAPACITY", "QUEUE", "WAITING", "LONGEST"];
/// Last column of a row whose bound no test reaches.
const UNTESTED: &str = "–";
/// Beginning of the reason in a row without a test.
const UNREACHABLE: &str = "no bound that input reaches";

/// Key of a row: file and constant.
type Key = (String, String);

/// A row of the list.
#[derive(Debug, Clone, PartialEq, Eq)]
struct LimitRow {
    value: String,
    /// True if a test reaches the bound, or input cannot.
    is_tested: bool,
}

/// Compares the list with the sources.
pub(super) fn check() -> Result<Vec<String>> {
    let rows = rows(&workspace::read(DOCUMENT)?);
    let mut bounds = BTreeMap::new();
    for file in workspace::files("*")? {
        if let Some(name) = file.to_str().filter(|_| is_source(&file)) {
            let found = constants(&workspace::read(&file)?);
            bounds.extend(found.into_iter().map(|(at, value)| ((name.to_owned(), at), value)));
        }
    }
    Ok(findings(&rows, &bounds))
}

/// True for product sources: no tests, benches, examples or developer tools.
fn is_source(file: &Path) -> bool {
    let parts: Vec<_> = file.iter().filter_map(|part| part.to_str()).collect();
    let is_shipped = matches!(
        parts.as_slice(),
        ["crates", _, "src" | "python", ..]
            | ["web", "src", "store" | "sync", ..]
            | ["ros" | "zenoh", "src", ..]
    );
    let extension = file.extension().and_then(|extension| extension.to_str());
    let is_code = matches!(extension, Some("rs" | "ts" | "tsx" | "py"));
    let is_test = parts.iter().any(|part| part.contains("test") || *part == "generated");
    is_shipped && is_code && !is_test
}

fn findings(rows: &BTreeMap<Key, LimitRow>, bounds: &BTreeMap<Key, String>) -> Vec<String> {
    let mut findings = Vec::new();
    for ((file, name), expression) in bounds {
        let Some(row) = rows.get(&(file.clone(), name.clone())) else {
            findings.push(format!("{DOCUMENT}: no row for `{name}` of {file}: add its value, what happens at the bound and the test that reaches it"));
            continue;
        };
        if Value::of_source(expression) != Value::of_document(&row.value) {
            let value = &row.value;
            findings.push(format!("{DOCUMENT}: `{name}` of {file} is `{expression}`, not {value}"));
        }
    }
    for (file, name) in rows.keys().filter(|key| !bounds.contains_key(*key)) {
        findings.push(format!("{DOCUMENT}: {file} has no bound `{name}`"));
    }
    for ((file, name), _) in rows.iter().filter(|(_, row)| !row.is_tested) {
        findings.push(format!("{DOCUMENT}: `{name}` of {file} has no test that reaches it: write one, or why it is \"{UNREACHABLE}\""));
    }
    findings
}

/// The bounds declared in a file, with their expressions.
fn constants(text: &str) -> Vec<(String, String)> {
    let production = text.split("\n#[cfg(test)]\nmod ").next().unwrap_or_default();
    let mut found = Vec::new();
    for line in production.lines() {
        let line = line.trim_start();
        let is_comment = line.starts_with("//") || line.starts_with('#');
        let Some((head, expression)) = line.split_once(" = ").filter(|_| !is_comment) else {
            continue;
        };
        let declared = head.split(':').next().unwrap_or_default().trim();
        let name = declared.rsplit(' ').next().unwrap_or_default();
        let is_constant = declared.contains("const ") || declared == name;
        if is_constant && is_bound(name) {
            let expression = expression.trim_end().trim_end_matches(';').to_owned();
            found.push((name.to_owned(), expression));
        }
    }
    found
}

fn is_bound(name: &str) -> bool {
    let is_upper = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
    name.chars().all(is_upper) && name.split('_').any(|part| WORDS.contains(&part))
}

/// The rows of the list: `| FILE CONSTANT | value | effect … | tests |`.
fn rows(document: &str) -> BTreeMap<Key, LimitRow> {
    let mut rows = BTreeMap::new();
    for line in document.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<_> = line.trim_matches('|').split('|').map(str::trim).collect();
        let [bound, value, .., tests] = cells.as_slice() else { continue };
        let mut names = bound.split('`').skip(1).step_by(2);
        if let (Some(file), Some(name)) = (names.next(), names.next()) {
            let is_tested = *tests != UNTESTED || line.contains(UNREACHABLE);
            let row = LimitRow { value: (*value).to_owned(), is_tested };
            rows.insert((file.to_owned(), name.to_owned()), row);
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = "/// Runs.\npub(crate) const RUNS_MAX: usize = 4_096;\nlet a = 1;\nconst OTHER: u8 = 1;\n\
                          export const SHOWN_MAX = 60;\n_QUEUE_MAX = 64 * 1024\n// const NO_MAX: u8 = 1;\n";

    fn check(row: &str) -> Vec<String> {
        let bounds = [(("a.rs".to_owned(), "RUNS_MAX".to_owned()), "4_096".to_owned())].into();
        findings(&rows(row), &bounds)
    }

    #[test]
    fn bounds_are_found_in_every_language() {
        let found = constants(SOURCE);
        let names: Vec<_> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["RUNS_MAX", "SHOWN_MAX", "_QUEUE_MAX"]);
        assert_eq!(found[2].1, "64 * 1024");
    }

    #[test]
    fn a_bound_needs_a_row_with_its_value_and_a_test() {
        let test = "`link::tests::a`";
        assert!(check(&format!("| `a.rs` `RUNS_MAX` | 4,096 | refused | {test} |")).is_empty());
        assert_eq!(check("").len(), 1);
        assert_eq!(check(&format!("| `a.rs` `RUNS_MAX` | 4,095 | refused | {test} |")).len(), 1);
        assert_eq!(check(&format!("| `a.rs` `NO_MAX` | 4,096 | refused | {test} |")).len(), 2);
        assert_eq!(check("| `a.rs` `RUNS_MAX` | 4,096 | refused | – |").len(), 1);
        assert!(
            check(&format!("| `a.rs` `RUNS_MAX` | 4,096 | {UNREACHABLE}: a pace | – |")).is_empty()
        );
    }
}
