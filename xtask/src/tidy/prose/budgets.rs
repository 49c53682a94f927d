//! The budgets of all places, as a readable table.

use std::collections::BTreeMap;

use anyhow::{Context as _, Result};

use super::places::Place;
use super::{Measured, Measures, Share};
use crate::workspace;

/// The table, relative to the repository.
const FILE: &str = "xtask/prose_budgets.txt";
/// Word before the commit whose successors have checked subjects.
const SINCE: &str = "since ";
/// Share of new lines that may have a tic.
const NEW_PERCENT: u32 = 5;

const HEAD: &str = "\
# Budgets of prose: hits/total of each measure, explained in CONTRIBUTING.md.
# `cargo xtask tidy --fix` lowers them; nothing raises them. New lines and new places may have 5 %.
# place, comments or sentences, texts, short docs, retired names, tuple parameters
";

/// The recorded figures of each place.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Budgets {
    /// Commit whose successors have checked subjects.
    pub(super) since: String,
    places: BTreeMap<Place, Measures>,
}

impl Budgets {
    pub(super) fn read() -> Result<Self> {
        Self::parse(&workspace::read(FILE)?)
    }

    fn parse(text: &str) -> Result<Self> {
        let mut budgets = Self::default();
        for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
            if let Some(since) = line.strip_prefix(SINCE) {
                since.trim().clone_into(&mut budgets.since);
                continue;
            }
            let (place, measures) = parse_row(line)
                .with_context(|| format!("{FILE}: this line is not a row of the table: {line}"))?;
            budgets.places.insert(place, measures);
        }
        Ok(budgets)
    }

    pub(super) fn write(&self) -> Result<()> {
        std::fs::write(workspace::path(FILE), self.to_text())
            .with_context(|| format!("cannot write {FILE}"))
    }

    fn to_text(&self) -> String {
        let rows: Vec<_> = self.places.iter().map(|(place, budget)| row(place, budget)).collect();
        format!("{HEAD}{SINCE}{}\n{}\n", self.since, rows.join("\n"))
    }

    /// Every place and measure that is over its budget.
    pub(super) fn findings(&self, measured: &Measured) -> Vec<String> {
        let mut findings = Vec::new();
        for (place, measures) in measured {
            let budget = self.places.get(place).copied().unwrap_or_default();
            for (measure, now, allowed) in compare(measures, &budget) {
                if now > allowed {
                    let place = place.as_str();
                    findings.push(format!(
                        "{place}: {now} {measure}, at most {allowed}: rewrite some; `cargo xtask tidy --prose {place}` lists them"
                    ));
                }
            }
        }
        findings
    }

    /// The lower of budget and figure, for each place that still exists.
    pub(super) fn lowered(self, measured: &Measured) -> Self {
        let places = measured.iter().map(|(place, now)| {
            let budget = self.places.get(place).copied().unwrap_or_default();
            (place.clone(), lower(&budget, now))
        });
        Self { places: places.collect(), since: self.since }
    }
}

/// Each measure: its name, the hits now, the hits allowed.
fn compare(now: &Measures, budget: &Measures) -> [(&'static str, u32, u32); 5] {
    let share = |measure, now: Share, budget: Share| (measure, now.hits, allowed(now, budget));
    [
        share("comment lines or sentences with a tic", now.comments, budget.comments),
        share("texts with a tic", now.texts, budget.texts),
        share("docs of three words or fewer", now.short_docs, budget.short_docs),
        ("retired names", now.retired, budget.retired),
        ("tuple parameters", now.tuples, budget.tuples),
    ]
}

/// The recorded hits, plus a share of newer lines.
fn allowed(now: Share, budget: Share) -> u32 {
    let new = now.total.saturating_sub(budget.total);
    budget.hits + (new * NEW_PERCENT).div_ceil(100)
}

fn lower(budget: &Measures, now: &Measures) -> Measures {
    let share = |budget: Share, now: Share| if now.hits <= budget.hits { now } else { budget };
    Measures {
        comments: share(budget.comments, now.comments),
        texts: share(budget.texts, now.texts),
        short_docs: share(budget.short_docs, now.short_docs),
        retired: budget.retired.min(now.retired),
        tuples: budget.tuples.min(now.tuples),
    }
}

/// A place's line of the table.
pub(super) fn row(place: &Place, measures: &Measures) -> String {
    let share = |share: Share| format!("{}/{}", share.hits, share.total);
    let Measures { comments, texts, short_docs, retired, tuples } = measures;
    format!(
        "{:32} {:>9} {:>9} {:>9} {retired:>5} {tuples:>3}",
        place.as_str(),
        share(*comments),
        share(*texts),
        share(*short_docs)
    )
}

fn parse_row(line: &str) -> Option<(Place, Measures)> {
    let mut words = line.split_whitespace();
    let place = Place::new(words.next()?);
    let mut share = || {
        let (hits, total) = words.next()?.split_once('/')?;
        Some(Share { hits: hits.parse().ok()?, total: total.parse().ok()? })
    };
    let (comments, texts, short_docs) = (share()?, share()?, share()?);
    let mut count = || words.next()?.parse().ok();
    Some((place, Measures { comments, texts, short_docs, retired: count()?, tuples: count()? }))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "since abc\ncrates/a 10/100 0/0 0/0 2 1\n";

    fn measured(place: &str, hits: u32, total: u32, retired: u32) -> Measured {
        let comments = Share { hits, total };
        [(Place::new(place), Measures { comments, retired, ..Measures::default() })].into()
    }

    fn budgets(text: &str) -> Budgets {
        Budgets::parse(text).expect("a table")
    }

    #[test]
    fn a_budget_is_kept_and_new_lines_may_have_a_twentieth() {
        let findings = |place, hits, total, retired| {
            budgets(TABLE).findings(&measured(place, hits, total, retired)).len()
        };
        assert_eq!(findings("crates/a", 10, 100, 2), 0);
        assert_eq!(findings("crates/a", 10, 60, 2), 0);
        assert_eq!(findings("crates/a", 11, 100, 3), 2);
        assert_eq!(findings("crates/a", 11, 120, 0), 0);
        assert_eq!(findings("crates/a", 12, 120, 0), 1);
        assert_eq!(findings("crates/new", 1, 20, 0), 0);
        assert_eq!(findings("crates/new", 2, 20, 0), 1);
        assert_eq!(findings("crates/new", 0, 20, 1), 1);
    }

    #[test]
    fn budgets_only_fall() {
        let after = |hits, total, retired| {
            let lowered = budgets(TABLE).lowered(&measured("crates/a", hits, total, retired));
            let measures = lowered.places[&Place::new("crates/a")];
            (measures.comments.hits, measures.comments.total, measures.retired)
        };
        assert_eq!(after(7, 90, 3), (7, 90, 2));
        assert_eq!(after(11, 130, 0), (10, 100, 0));
        let gone = budgets(TABLE).lowered(&Measured::new());
        assert!(gone.places.is_empty());
    }

    #[test]
    fn a_table_is_read_as_it_was_written() {
        let table = budgets(TABLE);
        assert_eq!(Budgets::parse(&table.to_text()).expect("the table written"), table);
        assert!(Budgets::parse("crates/a 1 2").is_err());
    }
}
