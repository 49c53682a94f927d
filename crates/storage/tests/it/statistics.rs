//! Journals from text, counted.

use expect_test::{Expect, expect};
use rafcon_protocol::api::OutcomeCount;
use rafcon_storage::journal::{About, Journal, Options, Reader, Tally};
use rafcon_testkit::journal_notation;
use std::fmt::Write as _;

const MACHINE: &str = r#"
    place R "Root" outcome done
    place R/A "Root/Scan" script outcome ok,lost
    place R/B "Root/Both" outcome ok
"#;

fn check(text: &str, expect: &Expect) {
    let folder = tempfile::tempdir().unwrap();
    let journal = Journal::create(folder.path(), &About::default(), &Options::default()).unwrap();
    journal.append(&journal_notation::batch(&format!("{MACHINE}{text}"), 0).unwrap()).unwrap();
    journal.close().unwrap();
    let mut reader = Reader::open(folder.path()).unwrap();
    let mut tally = Tally::default();
    tally.go_on(&mut reader).unwrap();
    expect.assert_eq(&shown(&tally, &reader));
    tally.go_on(&mut reader).unwrap();
    expect.assert_eq(&shown(&tally, &reader));
}

fn shown(tally: &Tally, reader: &Reader) -> String {
    let told = tally.statistics(reader.known_places());
    let mut text = format!("up to event {}\n", told.sequence);
    for state in &told.states {
        let [total, min, median, p95, max] =
            [state.total_ns, state.min_ns, state.median_ns, state.p95_ns, state.max_ns]
                .map(|ns| ns / 1_000_000);
        let outcome = |it: &OutcomeCount| format!("{} {}x", it.outcome.name, it.count);
        let outcomes: Vec<String> = state.outcomes.iter().map(outcome).collect();
        let facts = format!("{total} ms in all, {min} {median} {p95} {max}");
        writeln!(text, "{}: {}x, {facts}, {}", state.names, state.count, outcomes.join(", "))
            .unwrap();
    }
    text
}

#[test]
fn states_are_counted_with_their_times_and_outcomes() {
    check(
        "enter R\nenter R/A\n@10 leave R/A lost\n@20 enter R/A\n@120 leave R/A ok\n@130 enter R/A\n@131 leave R/A ok\n@200 leave R done",
        &expect![[r"
            up to event 8
            Root: 1x, 199 ms in all, 199 199 199 199, done 1x
            Root/Scan: 3x, 109 ms in all, 1 8 100 100, ok 2x, lost 1x
        "]],
    );
}

#[test]
fn steps_back_and_states_that_were_dropped_are_not_counted() {
    check(
        "enter R\nenter R/A\nleave R/A ok\nenter R/A undoes 2\nleave R/A ok undoes 2\nenter R/B\ntold {\"type\": \"dropped\", \"path\": \"R/B\"}",
        &expect![[r"
            up to event 7
            Root/Scan: 1x, 1 ms in all, 1 1 1 1, ok 1x
        "]],
    );
}
