//! String literals that are sentences: errors, help, texts of the page.

use std::sync::LazyLock;

use regex::Regex;

use super::comments::Line;
use super::places::Language;

/// First line of the tests of a Rust file.
const TESTS: &str = "\n#[cfg(test)]\nmod ";
/// Minimum number of words of a literal that counts as a sentence.
const SENTENCE_WORDS: usize = 3;

/// The literals of three words and more, line by line, without those of the tests at the end of a Rust file.
pub(super) fn of(text: &str, language: Language) -> Vec<Line> {
    static QUOTED: LazyLock<Option<Regex>> =
        LazyLock::new(|| Regex::new(r#""((?:[^"\\]|\\.)*)"|`((?:[^`\\]|\\.)*)`"#).ok());
    let Some(quoted) = &*QUOTED else { return Vec::new() };
    let production = text.split(TESTS).next().unwrap_or_default();
    let mut found = Vec::new();
    for (at, line) in production.lines().enumerate() {
        let trimmed = line.trim_start();
        if trimmed.starts_with("//") || trimmed.starts_with(['*', '#']) && !is_error(trimmed) {
            continue;
        }
        let literals = quoted.captures_iter(trimmed).filter_map(|found| {
            found.get(1).or_else(|| found.get(2)).map(|literal| literal.as_str())
        });
        let markup = (language == Language::TypeScript).then(|| markup_text(trimmed)).flatten();
        let sentences = literals.chain(markup).filter(|text| is_sentence(text));
        found.extend(sentences.map(|sentence| (at + 1, sentence.to_owned())));
    }
    found
}

fn is_error(line: &str) -> bool {
    line.starts_with("#[error(")
}

/// A line of text between two tags.
fn markup_text(line: &str) -> Option<&str> {
    let is_text = line.starts_with(|c: char| c.is_uppercase())
        && !line.contains(['"', '`', '=', '(', '{', '<', ';']);
    is_text.then_some(line)
}

fn is_sentence(text: &str) -> bool {
    let words = text.split_whitespace().filter(|word| word.chars().any(char::is_alphabetic));
    words.count() >= SENTENCE_WORDS
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, language: Language, expected: &[&str]) {
        let found = of(text, language);
        assert_eq!(found.iter().map(|(_, text)| text.as_str()).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn sentences_are_found_and_other_literals_are_not() {
        let rust = "// \"not in a comment\"\n#[error(\"cannot read {file}: it is damaged\")]\nlet a = \"key\";\n\
                    bail!(\"say \\\"what\\\" failed\");\n\n#[cfg(test)]\nmod tests {\n\"not in a test\"\n";
        let expected = ["cannot read {file}: it is damaged", "say \\\"what\\\" failed"];
        check(rust, Language::Rust, &expected);
        let page = "<p>\n    The run has ended\n</p>\nconst a = \"Stop this run\";\n";
        check(page, Language::TypeScript, &["The run has ended", "Stop this run"]);
    }
}
