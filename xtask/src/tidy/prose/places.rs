//! The places that have a budget: a crate, a folder of the page, a document.

use std::path::Path;

/// The name of a place: a path relative to the repository.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place(String);

impl Place {
    pub(super) fn new(name: impl Into<String>) -> Self {
        Self(name.into())
    }

    pub(super) fn as_str(&self) -> &str {
        &self.0
    }
}

/// Syntax of comments and strings in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Language {
    Rust,
    TypeScript,
    Python,
    Markdown,
}

/// Folders whose files are not measured.
const SKIPPED: [&str; 8] =
    ["tests", "benches", "examples", "test_data", "generated", "testing", "e2e", "bench"];

/// The place of a file; `None` for tests, generated files and other kinds of files.
pub(super) fn of(file: &Path) -> Option<Place> {
    let extension = file.extension()?.to_str()?;
    let parts: Vec<&str> = file.iter().filter_map(|part| part.to_str()).collect();
    let (name, folders) = parts.split_last()?;
    if extension == "md" {
        let is_measured = !folders.contains(&"tests");
        return is_measured.then(|| Place::new(parts.join("/")));
    }
    let is_code = ["rs", "ts", "tsx", "py", "pyi"].contains(&extension);
    let is_skipped = folders.iter().any(|folder| SKIPPED.contains(folder));
    if !is_code || is_skipped || name.contains("test") {
        return None;
    }
    let depth = match folders {
        ["web", "src", _, ..] => 3,
        ["crates", _, ..] | ["web", "src"] => 2,
        ["xtask" | "ros" | "zenoh" | "fuzz", ..] => 1,
        _ => return None,
    };
    Some(Place::new(parts[..depth].join("/")))
}

/// The language of a file that has a place.
pub(super) fn language(file: &Path) -> Language {
    match file.extension().and_then(|extension| extension.to_str()) {
        Some("md") => Language::Markdown,
        Some("py" | "pyi") => Language::Python,
        Some("ts" | "tsx") => Language::TypeScript,
        _ => Language::Rust,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crates_page_folders_and_documents_are_places() {
        let place = |file: &str| of(Path::new(file)).map(|place| place.as_str().to_owned());
        assert_eq!(place("crates/link/src/a/b.rs").as_deref(), Some("crates/link"));
        assert_eq!(place("web/src/panels/log/log.tsx").as_deref(), Some("web/src/panels"));
        assert_eq!(place("web/src/main.tsx").as_deref(), Some("web/src"));
        assert_eq!(place("docs/link.md").as_deref(), Some("docs/link.md"));
        assert_eq!(place("xtask/src/main.rs").as_deref(), Some("xtask"));
        assert_eq!(place("crates/link/src/a/tests.rs"), None);
        assert_eq!(place("crates/link/tests/a.rs"), None);
        assert_eq!(place("tests/conformance/README.md"), None);
        assert_eq!(place("examples/hello/script.py"), None);
    }
}
