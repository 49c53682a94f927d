//! A journal that exceeds its size deletes old detail. The remaining events are complete, and all values that they name exist.

use crate::journal::folder::VALUES_FOLDER;
use crate::journal::record::Content;
use crate::journal::{
    About, Batch, Journal, JournalError, Kept, Left, Options, Place, PlaceNumber, Reader, Stored,
    ValueNumber,
};
use serde_json::json;
use std::fs;
use std::path::Path;

const ROOT: PlaceNumber = PlaceNumber(1);
const STEP: PlaceNumber = PlaceNumber(2);

fn place(path: &str) -> Place {
    Place {
        path: path.to_owned(),
        names: path.to_owned(),
        is_library: false,
        is_script: path.contains('/'),
        inputs: vec![(0, "in".into())],
        outputs: vec![(0, "out".into())],
        scoped: vec![(0, "kept".into())],
        outcomes: vec![(0, "done".into())],
    }
}

fn stored(number: u64, content: Content) -> Stored {
    Stored { view: json!("v".repeat(200) + &number.to_string()), type_name: "T".into(), content }
}

/// Runs `rounds` states. Each has an output of its own, and an input and a scoped variable that never change.
fn run(journal: &Journal, rounds: u64) -> Option<u64> {
    let mut batch = Batch::new(0);
    let mut thinned = None;
    for (number, path) in [(ROOT, "A"), (STEP, "A/B")] {
        batch.define_place(number, &place(path));
    }
    let file = Content::File { hash: "used".to_owned(), size: 5 };
    batch.define_value(ValueNumber(1), &stored(1, file));
    batch.define_value(ValueNumber(2), &stored(2, Content::View));
    batch.entered(0, ROOT, [Kept::None], None);
    batch.scoped(0, ROOT, 0, &Kept::Value(ValueNumber(1)));
    for round in 0..rounds {
        let number = ValueNumber(round + 3);
        let file = Content::File { hash: format!("old{number:?}"), size: 0 };
        batch.define_value(number, &stored(number.0, if round < 9 { file } else { Content::View }));
        batch.entered(round, STEP, [Kept::Value(ValueNumber(2))], None);
        let outputs = [Kept::Value(number)];
        batch.left(round, Left { place: STEP, outcome: 0, outputs, error: None, undoes: None });
        if round % 16 == 0 {
            journal.append(&batch).unwrap();
            batch.clear();
        }
        if round % 512 == 0 {
            thinned = journal.commit().unwrap().thinned.or(thinned);
        }
    }
    thinned
}

fn options(size_max: u64) -> Options {
    Options { size_max, ..Options::default() }
}

/// Reads every event, and every value that one of them names.
fn read(folder: &Path, before: u64) -> (u64, u64) {
    let mut reader = Reader::open(folder).unwrap();
    let page = reader.page(1, usize::MAX).unwrap();
    let first = page[0].sequence;
    let mut values = 0;
    for (entry, sequence) in page.iter().zip(first..) {
        assert_eq!(entry.sequence, sequence);
        entry.record.values(&mut |value| {
            if let Kept::Value(number) = value {
                values += 1;
                assert!(sequence >= before);
                assert!(reader.value(*number).unwrap().is_some(), "{number:?}");
            }
        });
    }
    assert_eq!(page.last().map(|entry| entry.sequence), Some(reader.last_sequence().unwrap()));
    (first, values)
}

#[test]
fn old_detail_is_given_up_and_what_is_named_stays() {
    let folder = tempfile::tempdir().unwrap();
    let values = folder.path().join(VALUES_FOLDER);
    let journal = Journal::create(folder.path(), &About::default(), &options(3 << 20)).unwrap();
    fs::create_dir_all(&values).unwrap();
    fs::write(values.join("used"), "12345").unwrap();
    (3..12).for_each(|n| fs::write(values.join(format!("old{:?}", ValueNumber(n))), "").unwrap());
    let thinned = run(&journal, 20_000).unwrap();
    journal.close().unwrap();
    let (first, values_left) = read(folder.path(), thinned);
    assert_eq!(first, 1);
    assert!(thinned > 10_000 && values_left > 1000, "{thinned} {values_left}");
    let mut reader = Reader::open(folder.path()).unwrap();
    for at in [thinned, thinned + 7, reader.last_sequence().unwrap()] {
        let moment = reader.moment(at).unwrap();
        assert_eq!(moment.active()[0].scoped[0].value, Kept::Value(ValueNumber(1)), "{at}");
    }
    let left: Vec<_> = fs::read_dir(values).unwrap().map(|it| it.unwrap().file_name()).collect();
    assert_eq!(left, ["used"]);
}

#[test]
fn a_journal_stays_near_its_size_however_long_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let journal = Journal::create(folder.path(), &About::default(), &options(1 << 18)).unwrap();
    let thinned = run(&journal, 20_000).unwrap();
    journal.close().unwrap();
    let size = fs::metadata(folder.path().join("journal.db")).unwrap().len();
    let (first, _) = read(folder.path(), thinned);
    let mut reader = Reader::open(folder.path()).unwrap();
    let gone = reader.moment(first / 2).unwrap_err();
    assert!(matches!(gone, JournalError::GivenUp { .. }), "{gone}");
    assert_eq!(reader.moment(u64::MAX).unwrap().sequence(), reader.last_sequence().unwrap());
    assert!(first > 1 && size < 6 << 20, "{first} {size}");
}

#[test]
fn a_state_without_data_takes_few_bytes_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let journal = Journal::create(folder.path(), &About::default(), &Options::default()).unwrap();
    let mut batch = Batch::new(0);
    let states = 20_000_u32;
    for state in 1..=states {
        let (t_ns, place) = (u64::from(state) * 5000, PlaceNumber(state % 3000));
        batch.entered(t_ns, place, std::iter::empty::<Kept>(), None);
        let outputs = std::iter::empty::<Kept>();
        batch.left(t_ns + 1900, Left { place, outcome: 0, outputs, error: None, undoes: None });
        journal.append(&batch).unwrap();
        batch.clear();
        if state % 100 == 0 {
            journal.commit().unwrap();
        }
    }
    journal.close().unwrap();
    let size = |name: &str| fs::metadata(folder.path().join(name)).map_or(0, |file| file.len());
    let bytes =
        (size("journal.db") + size("journal.db-wal") + size("recorder")) / u64::from(states);
    assert!(bytes <= 32, "{bytes}");
}
