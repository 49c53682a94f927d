//! Journals as they are written. Appended events are preserved, whatever happens in between.

mod keyframes;
mod power_cut;
mod round_trip;
mod size;
mod versions;

use crate::journal::record::{Item, Items};
use crate::journal::store::Database;
use crate::journal::{About, Batch, Journal, Kept, Options, PlaceNumber, Record};
use std::path::Path;

/// Small sizes, so that rare cases occur in a test.
const SMALL: Options = Options { size_max: u64::MAX, recorder_bytes: 1 << 15 };

fn create(folder: &Path) -> Journal {
    Journal::create(folder, &About { name: "test".to_owned(), ..About::default() }, &SMALL).unwrap()
}

/// Adds the entry of the place with this number to a batch, at this time.
fn entered(batch: &mut Batch, t_ns: u64, place: u32) {
    batch.entered(t_ns, PlaceNumber(place), [Kept::None], None);
}

/// Appends an entry of each of these places, one batch each; times are the numbers.
fn append(journal: &Journal, batch: &mut Batch, places: impl IntoIterator<Item = u32>) {
    for place in places {
        entered(batch, u64::from(place), place);
        journal.append(batch).unwrap();
        batch.clear();
    }
}

/// Returns all records in the database: number, time, place.
fn kept(folder: &Path) -> String {
    let line = |(sequence, t_ns, record): &(u64, u64, Record)| match record {
        Record::Entered { place, .. } => format!("{sequence}:{t_ns}:{}", place.0),
        other => panic!("{other:?}"),
    };
    rows(folder).iter().map(line).collect::<Vec<_>>().join(" ")
}

/// Returns all records in the database with their times and their numbers, which have no gap.
fn rows(folder: &Path) -> Vec<(u64, u64, Record)> {
    let mut database = Database::open(folder).unwrap();
    let query = "SELECT first, count, t_before, t_last, data FROM blocks ORDER BY first";
    let number = |row: &rusqlite::Row<'_>, at| row.get(at).map(i64::cast_unsigned);
    let block = |row: &rusqlite::Row<'_>| {
        let numbers = [number(row, 0)?, number(row, 1)?, number(row, 2)?, number(row, 3)?];
        Ok((numbers, row.get(4)?))
    };
    let read = |connection: &mut rusqlite::Connection| {
        connection.prepare(query)?.query_map([], block)?.collect()
    };
    let blocks: Vec<([u64; 4], Vec<u8>)> = database.run(read).unwrap();
    let mut records: Vec<(u64, u64, Record)> = Vec::new();
    for ([first, count, t_before, t_last], data) in blocks {
        let next = records.len() as u64 + 1;
        assert_eq!(first, next, "no gap");
        for (item, sequence) in Items::new(&data, t_before).zip(next..) {
            let Item::Record(t_ns, record) = item.unwrap() else { panic!("a definition") };
            records.push((sequence, t_ns, record));
        }
        assert_eq!(first + count, records.len() as u64 + 1);
        assert_eq!(Some(t_last), records.last().map(|(_, t_ns, _)| *t_ns));
    }
    records
}
