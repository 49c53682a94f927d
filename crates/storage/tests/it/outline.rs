//! Outlines of journals from text: the drawing, the activity before an event, the results of a search.

use expect_test::{Expect, expect};
use proptest::prelude::*;
use rafcon_protocol::api::{Overview, OverviewBar};
use rafcon_storage::journal::{
    About, Definition, Item, Journal, Kept, Left, Options, Outline, PlaceNumber, Reader, Span,
};
use rafcon_testkit::journal_notation;
use std::fmt::Write as _;
use std::path::Path;

const MACHINE: &str = r#"
    place R "Root" outcome done
    place R/A "Root/Scan" script outcome ok,lost
    place R/P "Root/Both" outcome done
    place R/P/X "Root/Both/Look" script outcome ok
    place R/P/Y "Root/Both/Drive" script outcome ok
"#;

fn reader(folder: &Path, text: &str) -> Reader {
    let journal = Journal::create(folder, &About::default(), &Options::default()).unwrap();
    journal.append(&journal_notation::batch(&format!("{MACHINE}{text}"), 0).unwrap()).unwrap();
    journal.close().unwrap();
    Reader::open(folder).unwrap()
}

fn outlined(reader: &mut Reader) -> Outline {
    let mut outline = Outline::default();
    outline.go_on(reader).unwrap();
    outline
}

fn drawn(overview: &Overview) -> String {
    let ms = |ns: u64| ns / 1_000_000;
    let mut text =
        format!("up to event {}, at once: {:?}\n", overview.sequence, overview.concurrent);
    for row in &overview.rows {
        let bar = |bar: &OverviewBar| {
            let OverviewBar { from_ns, to_ns, many, failed, place, sequence, end } = *bar;
            let path = &overview.paths[usize::try_from(place).unwrap()];
            let to = to_ns.map_or(String::new(), |to| ms(to).to_string());
            format!("{path}#{sequence} {}-{to} {end:?} {many}/{failed}", ms(from_ns))
        };
        let bars: Vec<String> = row.bars.iter().map(bar).collect();
        writeln!(text, "{}", bars.join(", ")).unwrap();
    }
    text
}

/// Checks the drawing of a text between two times in ms, with this width in pixels.
fn check(text: &str, [from, to]: [u64; 2], pixels: u32, expect: &Expect) {
    let folder = tempfile::tempdir().unwrap();
    let mut reader = reader(folder.path(), text);
    let outline = outlined(&mut reader);
    let span = Span { from_ns: from * 1_000_000, to_ns: to * 1_000_000, pixels };
    expect.assert_eq(&drawn(&outline.overview(&mut reader, span).unwrap()));
}

const RUN: &str = "
    enter R
    @10 enter R/A
    @11 leave R/A lost
    @12 enter R/A
    @13 leave R/A aborted
    @20 enter R/P
    @20 enter R/P/X
    @21 enter R/P/Y
    @60 leave R/P/Y ok
    @80 leave R/P/X ok
    @80 leave R/P done
    @90 enter R/A";

#[test]
fn calls_are_drawn_by_rows_and_those_that_go_on_have_no_end() {
    check(
        RUN,
        [0, 100],
        1000,
        &expect![[r#"
        up to event 12, at once: ["R/P"]
        R#1 1- Open 1/0
        R/P/X#7 20-80 Ended 1/0
        R/P/Y#8 21-60 Ended 1/0
        R/A#2 10-11 Ended 1/0, R/A#4 12-13 Aborted 1/1, R/P#6 20-80 Ended 1/0, R/A#12 90- Open 1/0
    "#]],
    );
}

#[test]
fn what_is_narrow_comes_together_and_failures_are_not_lost_in_it() {
    check(
        RUN,
        [0, 100],
        20,
        &expect![[r#"
        up to event 12, at once: ["R/P"]
        R#1 1- Open 1/0
        R/P/X#7 20-80 Ended 1/0
        R/P/Y#8 21-60 Ended 1/0
        R/A#2 10-13 Ended 2/1, R/P#6 20-80 Ended 1/0, R/A#12 90- Open 1/0
    "#]],
    );
}

#[test]
fn a_part_has_what_reaches_into_it() {
    check(
        RUN,
        [30, 50],
        1000,
        &expect![[r#"
        up to event 12, at once: ["R/P"]
        R#1 1- Open 1/0
        R/P/X#7 20-80 Ended 1/0
        R/P/Y#8 21-60 Ended 1/0
        R/P#6 20-80 Ended 1/0
    "#]],
    );
    check(
        RUN,
        [200, 300],
        1000,
        &expect![[r#"
        up to event 12, at once: ["R/P"]
        R#1 1- Open 1/0
        R/A#12 90- Open 1/0
    "#]],
    );
}

#[test]
fn steps_back_and_what_was_dropped_look_as_they_were() {
    let text = "enter R\nenter R/A\n@5 leave R/A ok\n@6 enter R/A undoes 2\n@7 leave R/A ok undoes 2\n@8 enter R/P\n@8 enter R/P/X\n@9 told {\"type\": \"dropped\", \"path\": \"R/P\"}";
    check(
        text,
        [0, 10],
        1000,
        &expect![[r"
        up to event 8, at once: []
        R#1 1- Open 1/0
        R/A#2 2-5 Ended 1/0, R/A#4 6-7 Back 1/0, R/P#6 8-9 Dropped 1/0
        R/P/X#7 8-9 Dropped 1/0
    "]],
    );
}

#[test]
fn what_had_been_before_an_event_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let mut reader = reader(folder.path(), RUN);
    let outline = outlined(&mut reader);
    let mut text = String::new();
    for sequence in [0, 5, 12] {
        let earlier = outline.earlier(&mut reader, sequence).unwrap();
        writeln!(text, "event {sequence}").unwrap();
        for state in &earlier.states {
            let left = state.left.as_ref();
            let left = left.map(|left| format!("{} {}", left.sequence, left.outcome.name));
            let entered = state.entered.map(|entered| entered.sequence);
            let [total, min, max] =
                [state.total_ns, state.min_ns, state.max_ns].map(|ns| ns / 1_000_000);
            let path = &state.path;
            let counts = format!("{}+ {}- {total} {min} {max}", state.entries, state.ends);
            writeln!(text, "  {path}: {counts}, {entered:?} {left:?}").unwrap();
        }
        let notable: Vec<u64> = earlier.notable.iter().map(|entry| entry.sequence).collect();
        writeln!(text, "  worth a mark: {notable:?}").unwrap();
    }
    expect![[r#"
        event 0
          worth a mark: []
        event 5
          R: 1+ 0- 0 0 0, Some(1) None
          R/A: 2+ 2- 2 1 1, Some(4) Some("5 aborted")
          worth a mark: [5]
        event 12
          R: 1+ 0- 0 0 0, Some(1) None
          R/A: 3+ 2- 2 1 1, Some(12) Some("5 aborted")
          R/P: 1+ 1- 60 60 60, Some(6) Some("11 done")
          R/P/X: 1+ 1- 60 60 60, Some(7) Some("10 ok")
          R/P/Y: 1+ 1- 39 39 39, Some(8) Some("9 ok")
          worth a mark: [5]
    "#]]
    .assert_eq(&text);
}

#[test]
fn names_outcomes_and_lines_are_found_page_by_page() {
    let folder = tempfile::tempdir().unwrap();
    let text = "enter R\nenter R/A\nlog R/A info \"a Scan of it\"\nleave R/A lost\nenter R/A\nleave R/A ok";
    let mut reader = reader(folder.path(), text);
    let mut found = |text: &str, from, count, look| {
        let (hits, looked) = reader.hits(text, from, count, look).unwrap();
        (hits.iter().map(|hit| hit.sequence).collect::<Vec<_>>(), looked.next)
    };
    assert_eq!(found("sCAN", 0, 9, 99), (vec![2, 3, 5], 7));
    assert_eq!(found("scan", 3, 1, 99), (vec![3], 4));
    assert_eq!(found("lost", 1, 9, 3), (vec![], 4));
    assert_eq!(found("lost", 4, 9, 3), (vec![4], 7));
    assert_eq!(found("nothing", 1, 9, 99), (vec![], 7));
}

const NOTHING: [Kept; 0] = [];

/// Writes a run of a loop of two states, with this number of rounds and calls of 1 ms each.
fn long_run(folder: &Path, rounds: u64) -> Reader {
    let journal = Journal::create(folder, &About::default(), &Options::default()).unwrap();
    let items = journal_notation::parse(MACHINE).unwrap();
    let places: Vec<PlaceNumber> = items
        .iter()
        .filter_map(|item| match item {
            Item::Definition(Definition::Place(number, _)) => Some(*number),
            _ => None,
        })
        .collect();
    let mut batch = journal_notation::batch(&format!("{MACHINE}enter R"), 0).unwrap();
    for round in 0..rounds {
        let t_ns = round * 2_000_000;
        let place = places[if round % 10 == 9 { 2 } else { 1 }];
        batch.entered(t_ns, place, NOTHING, None);
        let left = Left { place, outcome: 0, outputs: NOTHING, error: None, undoes: None };
        batch.left(t_ns + 1_000_000, left);
    }
    journal.append(&batch).unwrap();
    journal.close().unwrap();
    Reader::open(folder).unwrap()
}

fn many_of(overview: &Overview) -> u64 {
    let row = |path: &str| {
        let place = |place: u32| overview.paths[usize::try_from(place).unwrap()].starts_with(path);
        let bars = overview.rows.iter().filter(|row| place(row.place)).flat_map(|row| &row.bars);
        bars.map(|bar| bar.many).sum::<u64>()
    };
    row("R/")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    /// Each call is counted once, in drawings by blocks or event by event. The activity before an event equals a full count.
    #[test]
    fn a_long_run_is_drawn_whole_however_wide(rounds in 1_000..8_000_u64, pixels in 1..400_u32, part in 0..100_u64) {
        let folder = tempfile::tempdir().unwrap();
        let mut reader = long_run(folder.path(), rounds);
        let outline = outlined(&mut reader);
        let whole = Span { from_ns: 0, to_ns: outline.t_ns(), pixels };
        let overview = outline.overview(&mut reader, whole).unwrap();
        prop_assert_eq!(many_of(&overview), rounds);
        let bars: usize = overview.rows.iter().map(|row| row.bars.len()).sum();
        prop_assert!(bars <= 4 * usize::try_from(pixels).unwrap() + 8, "{bars} bars on {pixels} pixels");
        let sequence = 1 + rounds * 2 * part / 100;
        let earlier = outline.earlier(&mut reader, sequence).unwrap();
        let entries: u64 = earlier.states.iter().map(|state| state.entries).sum();
        let ends: u64 = earlier.states.iter().map(|state| state.ends).sum();
        prop_assert_eq!(entries + ends, sequence);
    }
}

#[test]
fn the_newest_events_worth_a_mark_are_kept_and_older_ones_are_found_by_a_search() {
    let folder = tempfile::tempdir().unwrap();
    let mut reader = reader(folder.path(), &"log R/A warning \"dark\"\n".repeat(5_001));
    let outline = outlined(&mut reader);
    let mut marks = |sequence| {
        let earlier = outline.earlier(&mut reader, sequence).unwrap();
        (earlier.notable.len(), earlier.notable.first().map(|entry| entry.sequence))
    };
    assert_eq!(marks(5_001), (5_000, Some(2)));
    assert_eq!(marks(1), (0, None));
    let (hits, _) = reader.hits("dark", 1, 1, 9).unwrap();
    assert_eq!(hits[0].sequence, 1);
}

#[test]
fn a_place_with_the_largest_number_is_counted_like_any_other() {
    let folder = tempfile::tempdir().unwrap();
    let number = PlaceNumber(u32::MAX);
    let mut batch = journal_notation::batch("", 0).unwrap();
    let places = journal_notation::parse("place R \"Root\" outcome done").unwrap();
    let Some(Item::Definition(Definition::Place(_, place))) = places.into_iter().next() else {
        panic!("no place");
    };
    batch.define(&Definition::Place(number, place));
    batch.entered(1, number, NOTHING, None);
    let journal = Journal::create(folder.path(), &About::default(), &Options::default()).unwrap();
    journal.append(&batch).unwrap();
    journal.close().unwrap();
    let mut reader = Reader::open(folder.path()).unwrap();
    let earlier = outlined(&mut reader).earlier(&mut reader, 1).unwrap();
    assert_eq!(earlier.states[0].entries, 1);
}
