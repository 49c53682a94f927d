//! The stored history is limited, and readers get every revision once.

use super::{
    BYTES_MAX, Fingerprint, Inverse, InverseChange, MACHINES_MAX, PAGE_BYTES, REVISIONS_MAX,
    RevisionLog, RevisionsPage,
};
use proptest::prelude::*;
use rafcon_model::edit::apply;
use rafcon_model::{BuiltinTypes, Machine};
use rafcon_protocol::api::{Revision, RevisionKind};
use rafcon_protocol::document::changes;
use rafcon_testkit::edits::{Dice, edit};
use rafcon_testkit::notation;

fn machine(name: usize) -> Machine {
    notation::parse(&format!("execution ROOT \"{name}\"")).expect("a machine")
}

fn push(history: &mut RevisionLog, name: &str, machine: &Machine, mark: Fingerprint) {
    let revision = Revision {
        revision: history.last() + 1,
        id: String::new(),
        author: "ann".to_owned(),
        name: name.to_owned(),
        at_ms: 0,
        kind: RevisionKind::Edit,
        same_as: history.same_as(machine, mark),
        changes: Vec::new(),
    };
    let change = InverseChange::Machine(machine.clone());
    let inverse = Inverse { places: Vec::new(), layouts: super::Layouts::new(), change };
    history.push(&revision, inverse, machine, mark);
}

#[test]
fn what_is_kept_is_bounded_and_the_start_stays() {
    let mut history = RevisionLog::of(machine(0), 5);
    let last = REVISIONS_MAX + 2;
    for number in 1..=last {
        push(&mut history, "", &machine(number), Fingerprint(number as u128));
    }
    let told = history.steps();
    assert_eq!((told.start, told.steps.len()), (5, REVISIONS_MAX));
    assert_eq!(told.steps.iter().filter(|step| step.is_kept).count(), MACHINES_MAX);
    assert_eq!(history.machine(5), Some((5, &machine(0))));
    assert_eq!(history.machine(6), None);
    let last = 5 + last as u64;
    assert!(history.machine(last - 900).is_some() && history.machine(last - 1100).is_none());
    assert_eq!(history.taken_away("bob", last, 5).get("ann"), Some(&REVISIONS_MAX));
    assert_eq!(history.since(7), RevisionsPage::Reset(last));
    assert!(matches!(history.since(8), RevisionsPage::Revisions(told) if !told.is_empty()));
    let bytes = history.revisions.iter().filter_map(|told| told.text.as_ref());
    assert_eq!(history.told_bytes, bytes.map(|text| text.len()).sum::<usize>());
    assert_eq!(history.authors["ann"].done.len(), REVISIONS_MAX);
}

/// A log of revisions with names of these sizes. The first one has number 11.
fn told(sizes: &[usize]) -> RevisionLog {
    let mut history = RevisionLog::of(machine(0), 10);
    for size in sizes {
        push(&mut history, &"x".repeat(*size), &machine(0), Fingerprint::default());
    }
    history
}

fn page(history: &RevisionLog, from: u64) -> String {
    match history.since(from) {
        RevisionsPage::Reset(now) => format!("reset to {now}"),
        RevisionsPage::Revisions(told) => {
            let number = |text: &str| {
                serde_json::from_str::<Revision>(text).expect("a revision").revision.to_string()
            };
            told.iter().map(|text| number(text)).collect::<Vec<_>>().join(" ")
        }
    }
}

#[test]
fn a_reader_goes_on_from_its_cursor() {
    let pages: Vec<_> = (10..16).map(|from| page(&told(&[1, 1, 1]), from)).collect();
    assert_eq!(pages, ["reset to 13", "11 12 13", "12 13", "13", "", "reset to 13"]);
    assert_eq!([page(&told(&[]), 11), page(&told(&[]), 12)], ["", "reset to 10"]);
}

#[test]
fn pages_and_memory_are_bounded() {
    assert_eq!(page(&told(&[PAGE_BYTES, 1, 1]), 11), "11");
    let full = told(&[BYTES_MAX / 2, BYTES_MAX / 2, 2]);
    assert_eq!([page(&full, 11), page(&full, 12)], ["reset to 13", "12"]);
    assert_eq!(page(&told(&[1, BYTES_MAX + 1]), 12), "reset to 12");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// A fingerprint is independent of the path: equal machines have equal ones, and different machines have different ones.
    #[test]
    fn marks_tell_machines_apart(numbers in proptest::collection::vec(any::<u16>(), 0..600)) {
        let start = notation::parse("hierarchy ROOT\n  barrier BBBBBB\n    decider unique_decider_state_id").unwrap();
        let (mut dice, mut now) = (Dice::new(numbers), start.clone());
        let mut mark = Fingerprint::default();
        while !dice.is_empty() {
            let mut next = now.clone();
            if apply(&mut next, edit(&now, &mut dice), &BuiltinTypes).is_ok() {
                mark = mark.after(&now, &next, &changes(&now, &next));
                now = next;
            }
            let direct = Fingerprint::default().after(&start, &now, &changes(&start, &now));
            prop_assert_eq!(mark, direct);
            prop_assert_eq!(mark == Fingerprint::default(), now == start);
        }
    }
}
