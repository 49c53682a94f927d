//! Comment lines of sources and sentences of documents.

use std::sync::LazyLock;

use regex::Regex;

use super::places::Language;
use super::{Hit, Share};

/// A line number, counted from 1, and its text.
pub(super) type Line = (usize, String);

/// Maximum number of words in a short doc.
const SHORT_WORDS: usize = 3;

/// The comments of a source, or the sentences of a document.
pub(super) fn of(text: &str, language: Language) -> Vec<Line> {
    match language {
        Language::Markdown => sentences(text),
        Language::Python => numbered(text, |line| line.trim_start().strip_prefix('#')),
        Language::Rust | Language::TypeScript => slashes(text),
    }
}

fn numbered<'a>(text: &'a str, comment: impl Fn(&'a str) -> Option<&'a str>) -> Vec<Line> {
    let lines = text.lines().enumerate();
    let found =
        lines.filter_map(|(at, line)| Some((at + 1, comment(line)?.trim_matches(['#', ' ']))));
    found.filter(|(_, text)| !text.is_empty()).map(|(at, text)| (at, text.to_owned())).collect()
}

/// Lines behind `//`, `///` and `//!`, and the lines of `/* … */`.
fn slashes(text: &str) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut is_inside = false;
    for (at, line) in text.lines().enumerate() {
        let trimmed = line.trim();
        let comment = if let Some(rest) = trimmed.strip_prefix("//") {
            rest.strip_prefix(['/', '!']).unwrap_or(rest)
        } else if is_inside || trimmed.starts_with("/*") {
            is_inside = !trimmed.contains("*/");
            let body = trimmed.strip_prefix('/').unwrap_or(trimmed).trim_start_matches('*');
            body.trim_end_matches("*/")
        } else {
            continue;
        };
        if !comment.trim().is_empty() {
            lines.push((at + 1, comment.trim().to_owned()));
        }
    }
    lines
}

/// Sentences of more than two words outside code; each cell of a table counts as at least one sentence.
fn sentences(text: &str) -> Vec<Line> {
    static CODE: LazyLock<Option<Regex>> = LazyLock::new(|| Regex::new(r"`[^`]*`|<!--.*?-->").ok());
    static END: LazyLock<Option<Regex>> = LazyLock::new(|| Regex::new(r"([.!?;:]) +").ok());
    let (Some(code), Some(end)) = (&*CODE, &*END) else { return Vec::new() };
    let mut found = Vec::new();
    let mut is_fenced = false;
    for (at, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            is_fenced = !is_fenced;
        } else if !is_fenced && !line.starts_with("    ") {
            let prose = code.replace_all(line, "x");
            for cell in prose.split('|') {
                let split = end.replace_all(cell.trim_matches([' ', '#', '*', '-']), "$1\n");
                let long = split.lines().filter(|line| line.split_whitespace().count() > 2);
                found.extend(long.map(|sentence| (at + 1, sentence.to_owned())));
            }
        }
    }
    found
}

/// Counts one-line documentation with three words or fewer.
pub(super) fn count_short_docs(share: &mut Share, text: &str) -> Vec<Hit> {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let is_doc = |at: Option<usize>| {
        at.and_then(|at| lines.get(at)).is_some_and(|line| line.starts_with("///"))
    };
    let mut hits = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let Some(doc) = line.strip_prefix("///") else { continue };
        if is_doc(at.checked_sub(1)) || is_doc(Some(at + 1)) {
            continue;
        }
        share.total += 1;
        if doc.split_whitespace().count() <= SHORT_WORDS {
            share.hits += 1;
            hits.push(Hit { measure: "short doc", line: at + 1, text: doc.trim().to_owned() });
        }
    }
    hits
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, language: Language, expected: &[(usize, &str)]) {
        let found = of(text, language);
        let found: Vec<_> = found.iter().map(|(at, text)| (*at, text.as_str())).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn comments_of_each_language_are_found() {
        let rust =
            "//! One.\nlet a = \"// no\"; // not a line of its own\n/* Two\n * three */\n//\n";
        check(rust, Language::Rust, &[(1, "One."), (3, "Two"), (4, "three")]);
        check("# One\nx = 1\n  ## Two\n", Language::Python, &[(1, "One"), (3, "Two")]);
        let document = "# A short title\n\n```\nno code here at all\n```\nOne `a b c` more. Two words\n| a cell of four | b |\n";
        let expected = [(1, "A short title"), (6, "One x more."), (7, "a cell of four")];
        check(document, Language::Markdown, &expected);
    }

    #[test]
    fn a_short_doc_stands_alone() {
        let mut share = Share::default();
        let text = "/// The state.\nfn a() {}\n/// The\n/// state.\nfn b() {}\n/// One that has more words.\nfn c() {}\n";
        assert_eq!(count_short_docs(&mut share, text).len(), 1);
        assert_eq!(share, Share { hits: 1, total: 2 });
    }
}
