//! A rule in the documents names the tests that hold it; this checks that they exist.
//!
//! A name is a path in backticks that begins with a crate's folder, such as `engine::barrier::tests::data_arrives`,
//! all in lower case; `conformance::name` is a machine below `tests/conformance/machines`.

use std::path::{Path, PathBuf};

use anyhow::Result;

use crate::workspace;

/// Folders with sources that are no crates of `crates/`.
const OTHER_HOMES: [&str; 3] = ["xtask", "ros", "zenoh"];

/// A source file: its path and its text.
type Source = (PathBuf, String);

/// Checks every document but the changelog, which names tests of its time.
pub(super) fn check() -> Result<Vec<String>> {
    let sources = sources()?;
    let crates = workspace::crates()?;
    let mut findings = Vec::new();
    for document in workspace::files("*.md")? {
        if document.as_path() == Path::new("CHANGELOG.md") {
            continue;
        }
        for name in names(&workspace::read(&document)?, &crates) {
            if !exists(&sources, &name) {
                let document = document.display();
                findings
                    .push(format!("{document}: no test `{name}`: correct the name or the rule"));
            }
        }
    }
    Ok(findings)
}

fn sources() -> Result<Vec<Source>> {
    let files = [
        workspace::files("crates/*.rs")?,
        workspace::files("crates/*.py")?,
        workspace::files("xtask/*.rs")?,
        workspace::files("ros/*.rs")?,
        workspace::files("zenoh/*.rs")?,
    ];
    files.concat().into_iter().map(|file| Ok((file.clone(), workspace::read(&file)?))).collect()
}

/// The test names in a document.
fn names(text: &str, crates: &[String]) -> Vec<String> {
    let code = text.lines().flat_map(|line| line.split('`').skip(1).step_by(2));
    code.filter(|word| is_name(word, crates)).map(str::to_owned).collect()
}

fn is_name(word: &str, crates: &[String]) -> bool {
    let known = |head: &str| {
        crates.iter().any(|name| name == head)
            || OTHER_HOMES.contains(&head)
            || head == "conformance"
    };
    let plain = word
        .chars()
        .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '_' | ':'));
    plain && word.split_once("::").is_some_and(|(head, _)| known(head))
}

fn exists(sources: &[Source], name: &str) -> bool {
    let parts = name.split("::").collect::<Vec<_>>();
    let [home, modules @ .., test] = parts.as_slice() else { return false };
    if *home == "conformance" {
        return workspace::path("tests/conformance/machines").join(test).is_dir();
    }
    sources.iter().any(|source| holds(source, home, modules, test))
}

fn holds((file, text): &Source, home: &str, modules: &[&str], test: &str) -> bool {
    let is_other = OTHER_HOMES.contains(&home);
    let folder = if is_other { PathBuf::from(home) } else { Path::new("crates").join(home) };
    let named = |module: &&str| {
        file.with_extension("").components().any(|part| part.as_os_str() == *module)
            || text.contains(&format!("mod {module} {{"))
            || text.contains(&format!("class {module}("))
    };
    file.starts_with(folder) && modules.iter().all(named) && defines(text, test)
}

/// Whether the text defines the test: in Rust behind a `#[test]` or `#[tokio::test]`, in Python by its name.
fn defines(text: &str, test: &str) -> bool {
    let mut marked = false;
    for line in text.lines().map(str::trim_start) {
        if line.starts_with(&format!("def {test}("))
            || marked && line.trim_start_matches("async ").starts_with(&format!("fn {test}("))
        {
            return true;
        }
        let is_mark = line.starts_with("#[test]") || line.starts_with("#[tokio::test");
        marked = is_mark || marked && (line.starts_with("#[") || line.starts_with("//"));
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_told_from_other_code() {
        let text = "Held by: `engine::tests::replay`, not `engine::Engine` or `let x`.\n| `conformance::barrier`, `ros::json::tests::text` |";
        let crates = ["engine".to_owned()];
        let expected = ["engine::tests::replay", "conformance::barrier", "ros::json::tests::text"];
        assert_eq!(names(text, &crates), expected);
    }

    #[test]
    fn a_test_is_found_by_its_crate_module_and_mark() {
        let text = "mod tests {\n    #[test]\n    fn replay() {}\n    fn helper() {}\n    \
                    #[tokio::test(start_paused = true)]\n    async fn later() {}\n}\n";
        let place = |file: &str| (PathBuf::from(file), text.to_owned());
        let sources = [place("crates/engine/src/walk.rs"), place("ros/src/walk.rs")];
        assert!(exists(&sources, "engine::walk::tests::replay"));
        assert!(exists(&sources, "engine::walk::tests::later"));
        assert!(exists(&sources, "ros::walk::tests::replay"));
        assert!(!exists(&sources, "zenoh::walk::tests::replay"));
        assert!(!exists(&sources, "engine::walk::tests::helper"));
        assert!(!exists(&sources, "model::walk::tests::replay"));
        assert!(!exists(&sources, "engine::other::tests::replay"));
    }
}
