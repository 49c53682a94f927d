//! Measures the language of comments, documents and texts, and compares it with budgets that may only fall.
//!
//! `CONTRIBUTING.md` explains the measures. `xtask/prose_budgets.txt` has the figures of each place.

mod budgets;
mod comments;
mod identifiers;
mod places;
mod subjects;
mod texts;
mod tics;

use std::collections::BTreeMap;

use anyhow::Result;

use crate::workspace;
use budgets::Budgets;
use places::Place;

/// A count out of a total.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Share {
    hits: u32,
    total: u32,
}

/// The figures of one place.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Measures {
    /// Comment lines with a tic; sentences in a document.
    comments: Share,
    /// String literals that are sentences, with a tic.
    texts: Share,
    /// One-line documentation with three words or fewer.
    short_docs: Share,
    /// Uses of retired identifiers.
    retired: u32,
    /// Parameters that are tuples.
    tuples: u32,
}

/// One hit: the measure, the line and its text.
#[derive(Debug, PartialEq, Eq)]
struct Hit {
    measure: &'static str,
    line: usize,
    text: String,
}

/// The figures of every place of the repository.
type Measured = BTreeMap<Place, Measures>;

/// Measures the repository and compares it with the budgets.
pub(super) fn check() -> Result<Vec<String>> {
    let budgets = Budgets::read()?;
    subjects::show(&budgets.since);
    Ok(budgets.findings(&measure(None)?))
}

/// Lowers the budgets to the measured figures, if these are lower.
pub(super) fn write() -> Result<()> {
    Budgets::read()?.lowered(&measure(None)?).write()
}

/// Prints every hit of one place.
#[expect(clippy::print_stdout, reason = "the answer of the command")]
pub(super) fn show(place: &str) -> Result<()> {
    let measured = measure(Some(place))?;
    for (place, measures) in measured {
        println!("{}", budgets::row(&place, &measures));
    }
    Ok(())
}

#[expect(clippy::print_stdout, reason = "the answer of the command that shows a place")]
fn measure(shown: Option<&str>) -> Result<Measured> {
    let mut measured = Measured::new();
    for file in workspace::files("*")? {
        let Some(place) = places::of(&file) else { continue };
        if shown.is_some_and(|shown| shown != place.as_str()) {
            continue;
        }
        let hits = add_file(measured.entry(place).or_default(), &file, &workspace::read(&file)?);
        for hit in hits.iter().filter(|_| shown.is_some()) {
            println!("{}:{}: {}: {}", file.display(), hit.line, hit.measure, hit.text);
        }
    }
    Ok(measured)
}

/// Adds the figures of one file and returns its hits.
fn add_file(measures: &mut Measures, file: &std::path::Path, text: &str) -> Vec<Hit> {
    let language = places::language(file);
    let comments = comments::of(text, language);
    let mut hits = tics::count(&mut measures.comments, "comment", &comments);
    if language == places::Language::Markdown {
        return hits;
    }
    hits.extend(tics::count(&mut measures.texts, "text", &texts::of(text, language)));
    hits.extend(comments::count_short_docs(&mut measures.short_docs, text));
    let retired = identifiers::retired(text, language);
    measures.retired += u32::try_from(retired.len()).unwrap_or(u32::MAX);
    let tuples = identifiers::tuple_parameters(text);
    measures.tuples += u32::try_from(tuples.len()).unwrap_or(u32::MAX);
    hits.extend(retired);
    hits.extend(tuples);
    hits
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_file_is_measured_in_every_way() {
        let mut measures = Measures::default();
        let text = concat!(
            "//! Whoever reads this.\n/// Plain text about a timeout.\n\n",
            "struct A {\n    /// The ink.\n    ink: u8,\n}\n",
            "fn f((a, b): (u8, u8)) {\n    bail!(\"it says nothing to the user\")\n}\n",
        );
        let hits = add_file(&mut measures, Path::new("crates/a/src/lib.rs"), text);
        let share = |hits, total| Share { hits, total };
        assert_eq!(measures.comments, share(1, 3));
        assert_eq!(measures.texts, share(1, 1));
        assert_eq!(measures.short_docs, share(1, 2));
        assert_eq!((measures.retired, measures.tuples), (1, 1));
        let measures: Vec<_> = hits.iter().map(|hit| (hit.measure, hit.line)).collect();
        let expected =
            [("comment", 1), ("text", 9), ("short doc", 5), ("retired name", 6), ("tuple", 8)];
        assert_eq!(measures, expected);
    }
}
