//! Checks that every module begins with `//!`, and has a readable size.

use std::path::{Component, Path};

use anyhow::Result;

use crate::workspace;

/// Number of lines above which a module must give a reason in its `//!`.
const LINES_WITHOUT_REASON: usize = 600;
/// Maximum number of lines of a module outside tests.
const LINES_MAX: usize = 1000;
/// Beginning of that reason.
const REASON: &str = "//! Long because";

/// Checks every Rust file of the repository.
pub(super) fn check() -> Result<Vec<String>> {
    let mut findings = Vec::new();
    for file in workspace::files("*.rs")? {
        let text = workspace::read(&file)?;
        findings.extend(
            findings_in(&file, &text).into_iter().map(|what| format!("{}: {what}", file.display())),
        );
    }
    Ok(findings)
}

fn findings_in(file: &Path, text: &str) -> Vec<String> {
    let mut findings = Vec::new();
    if !text.starts_with("//!") {
        findings.push(
            "does not open with `//!`: state what the module knows and knows nothing of".to_owned(),
        );
    }
    let lines = text.lines().count();
    if is_test(file) {
        return findings;
    }
    if lines > LINES_MAX {
        findings
            .push(format!("{lines} lines, the limit is {LINES_MAX}: split it by what it knows"));
    } else if lines > LINES_WITHOUT_REASON && !text.lines().any(|line| line.starts_with(REASON)) {
        findings.push(format!(
            "{lines} lines: above {LINES_WITHOUT_REASON} a line `{REASON} …` gives the reason"
        ));
    }
    findings
}

/// True if a file contains only tests.
pub(super) fn is_test(file: &Path) -> bool {
    file.ends_with("tests.rs")
        || file.components().any(|part| part == Component::Normal("tests".as_ref()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(file: &str, text: &str) -> usize {
        findings_in(Path::new(file), text).len()
    }

    #[test]
    fn a_module_needs_its_first_line_and_a_bounded_size() {
        assert_eq!(count("a.rs", "//! Knows a.\n"), 0);
        assert_eq!(count("a.rs", "fn a() {}\n"), 1);
        let long = |head: &str, lines: usize| {
            format!("//! Knows a.\n{head}{}", "fn a() {}\n".repeat(lines))
        };
        assert_eq!(count("a.rs", &long("", 700)), 1);
        assert_eq!(count("a.rs", &long("//! Long because it is one table.\n", 700)), 0);
        assert_eq!(count("a.rs", &long("//! Long because it is one table.\n", 1000)), 1);
        assert_eq!(count("a/tests.rs", &long("", 1000)), 0);
    }
}
