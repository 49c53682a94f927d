//! Words and openings that plain technical text avoids.

use std::sync::LazyLock;

use regex::Regex;

use super::comments::Line;
use super::{Hit, Share};

/// The patterns, one for each tic. Each is searched for in a comment line or a sentence.
const TICS: [&str; 17] = [
    r"\b[Ss]o (?:many|much|often|long|far)\b",
    r"\b[Ww]hoever\b",
    r"\btold\b|\btells?\b",
    r"\bstands?\b",
    r"\bgoes on\b|\bgo on\b|\bgoing on\b",
    r"\b[Nn]othing if\b|; nothing\b|; none\b",
    r"\bsays?\b|\bsaid\b",
    r"\bheard?\b|\bhears?\b",
    r"^(?:Of|What|Where|How|Why|Whether|Who)\b",
    r"\blooks?\b|\blooked\b",
    r"\bthe same\b",
    r"\blikewise\b",
    r"\bletting go|lets? go\b",
    r"\bwish(?:ed|es)?\b|\bwants?\b|\bwanted\b",
    r"\b[Aa]nswers\b",
    r"\bis there\b|\bare there(?:[.,;]|$)",
    r"\bis gone\b|\bare gone\b",
];

static ANY: LazyLock<Option<Regex>> = LazyLock::new(|| Regex::new(&TICS.join("|")).ok());

/// Adds the lines to the share and returns those with a tic.
pub(super) fn count(share: &mut Share, measure: &'static str, lines: &[Line]) -> Vec<Hit> {
    let mut hits = Vec::new();
    for (line, text) in lines {
        share.total += 1;
        if has_tic(text) {
            share.hits += 1;
            hits.push(Hit { measure, line: *line, text: text.clone() });
        }
    }
    hits
}

fn has_tic(text: &str) -> bool {
    ANY.as_ref().is_some_and(|any| any.is_match(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pattern_is_valid_and_finds_its_tic() {
        assert!(ANY.is_some());
        for text in [
            "So many events wait",
            "for whoever reads",
            "is told",
            "stands here",
            "it goes on",
            "Nothing if empty",
            "it said so",
            "it was heard",
            "Of a run",
            "Whether it is open",
            "looks at it",
            "the same line",
            "likewise",
            "lets go",
            "a wish",
            "Answers with it",
            "it is there",
            "they are there",
            "it is gone",
        ] {
            assert!(has_tic(text), "{text}");
        }
        for text in [
            "Key of the last datagram opened.",
            "they are there again",
            "The number of events.",
            "if the file is missing, and of what kind",
        ] {
            assert!(!has_tic(text), "{text}");
        }
    }
}
