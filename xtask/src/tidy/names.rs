//! Checks that a type name has one meaning in its crate, and that functions with names of questions only return an answer.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Result;

use super::modules::is_test;
use crate::workspace;

/// Prefixes of names that are questions.
const QUESTIONS: [&str; 4] = ["is_", "has_", "are_", "was_"];
/// Names from traits of other crates.
const FOREIGN: [&str; 1] = ["is_open"];
/// Beginning of the tests in a file.
const TESTS: &str = "\n#[cfg(test)]\nmod ";

/// Checks every Rust file of the repository.
pub(super) fn check() -> Result<Vec<String>> {
    let mut findings = Vec::new();
    let mut types: BTreeMap<(PathBuf, String), PathBuf> = BTreeMap::new();
    for file in workspace::files("*.rs")? {
        let text = workspace::read(&file)?;
        let found = questions_that_act(&text);
        findings.extend(found.into_iter().map(|what| format!("{}: {what}", file.display())));
        let Some(folder) = source_folder(&file) else { continue };
        for name in type_names(&text) {
            let (key, place) = ((folder.clone(), name.clone()), file.clone());
            if let Some(other) = types.insert(key, place) {
                findings.push(format!(
                    "{}: the type `{name}` has the name of another in {}: add what it belongs to",
                    file.display(),
                    other.display()
                ));
            }
        }
    }
    Ok(findings)
}

/// The `src` folder of a product file; `None` for tests.
fn source_folder(file: &Path) -> Option<PathBuf> {
    let parts: Vec<_> = file.components().collect();
    let source = parts.iter().position(|part| part.as_os_str() == "src")?;
    (!is_test(file)).then(|| parts[..=source].iter().collect())
}

/// The types that a file declares outside functions and tests.
fn type_names(text: &str) -> impl Iterator<Item = String> {
    let production = text.split(TESTS).next().unwrap_or_default();
    production.lines().filter_map(|line| {
        let words = line.split(|c: char| !(c.is_alphanumeric() || c == '_' || "()".contains(c)));
        let mut words = words.skip_while(|word| word.starts_with("pub"));
        let is_type = matches!(words.next(), Some("struct" | "enum" | "trait" | "union"));
        let name = words.next().filter(|_| is_type)?;
        Some(name.split('(').next().unwrap_or_default().to_owned())
    })
}

/// Functions with names of questions that wait, may change their object, or return nothing.
fn questions_that_act(text: &str) -> Vec<String> {
    let mut findings = Vec::new();
    for (at, _) in text.match_indices("fn ") {
        let rest = &text[at + 3..];
        let name: String =
            rest.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
        if !QUESTIONS.iter().any(|question| name.starts_with(question))
            || FOREIGN.contains(&name.as_str())
        {
            continue;
        }
        let line = &text[text[..at].rfind('\n').map_or(0, |end| end + 1)..at];
        if line.contains("//") || line.contains('"') {
            continue;
        }
        let signature = rest.split(['{', ';']).next().unwrap_or_default();
        let acts =
            line.contains("async ") || signature.contains("&mut self") || !signature.contains("->");
        // Names of tests are statements.
        let is_test = text[..at].trim_end().ends_with("#[test]");
        if acts && !is_test {
            findings.push(format!(
                "`{name}` is called like a question, and waits or changes something: name it after its action"
            ));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::{questions_that_act, source_folder, type_names};
    use std::path::{Path, PathBuf};

    #[test]
    fn a_question_only_answers() {
        let count = |text| questions_that_act(text).len();
        assert_eq!(count("    pub fn is_live(&self) -> bool {"), 0);
        assert_eq!(count("    async fn is_live(&self) -> bool {"), 1);
        assert_eq!(count("    fn has_come(&self) {"), 1);
        assert_eq!(count("    fn is_same(\n        &mut self,\n    ) -> bool {"), 1);
        assert_eq!(count("    #[test]\n    fn is_told_once() {"), 0);
        assert_eq!(count("    // no fn is_told()"), 0);
    }

    #[test]
    fn types_of_products_are_found() {
        let text = "pub(crate) struct One<T>(T);\nenum Two {\n    Three,\n}\nfn four() {}\n\
                    struct Five;\n\n#[cfg(test)]\nmod tests {\nstruct Six;\n}\n";
        assert_eq!(type_names(text).collect::<Vec<_>>(), ["One", "Two", "Five"]);
        let folder = |file| source_folder(Path::new(file));
        assert_eq!(folder("crates/a/src/b/c.rs"), Some(PathBuf::from("crates/a/src")));
        assert_eq!(folder("crates/a/src/b/tests.rs"), None);
        assert_eq!(folder("crates/a/benches/b.rs"), None);
    }
}
