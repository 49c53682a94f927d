//! Streams and the events that a reader makes of them.

use super::definitions::PlaceHistory;
use super::{StreamBlock, StreamDefinitions, StreamItem, StreamReader, VALUE_LIFE};
use crate::journal::record::Content;
use crate::journal::{About, Batch, Journal, Options};
use crate::journal::{Definition, Item, Kept, Place, PlaceNumber, Record, Stored, ValueNumber};
use expect_test::{Expect, expect};
use proptest::prelude::*;
use rafcon_protocol::Event;
use serde_json::json;
use std::sync::Arc;

fn place(path: &str, inputs: &[&str]) -> Item {
    let place = Place {
        path: path.to_owned(),
        names: path.to_owned(),
        is_library: false,
        is_script: true,
        inputs: (0..).zip(inputs.iter().map(|name| (*name).into())).collect(),
        outputs: Vec::new(),
        scoped: Vec::new(),
        outcomes: Vec::new(),
    };
    Item::Definition(Definition::Place(PlaceNumber(0), place))
}

fn value(number: u64) -> Item {
    let content = Content::Nothing(String::new());
    let stored = Stored { view: json!([number]), type_name: "list".into(), content };
    Item::Definition(Definition::Value(ValueNumber(number), stored))
}

fn entered(t_ns: u64, number: u64) -> Item {
    let inputs = vec![Kept::Value(ValueNumber(number))];
    Item::Record(t_ns, Record::Entered { place: PlaceNumber(0), inputs, undoes: None })
}

/// Returns a block of these items. The first event has number `first`.
fn block(first: u64, items: &[Item]) -> Vec<u8> {
    let (mut before, mut bytes, mut out) = (0, Vec::new(), Vec::new());
    for item in items {
        item.write(&mut before, &mut bytes);
    }
    StreamBlock { first, t_before: 0, items: &bytes }.write(&mut out);
    out
}

fn check(blocks: &[Vec<u8>], from: u64, values: bool, expect: &Expect) {
    let (mut reader, mut lines) = (StreamReader::new(from, values, None), Vec::new());
    for block in blocks {
        reader
            .read(block, |sequence, t_ns, event| {
                let event = serde_json::to_string(&event).unwrap();
                lines.push(format!("{sequence} at {t_ns}: {event}\n"));
            })
            .unwrap();
    }
    expect.assert_eq(&lines.concat());
}

#[test]
fn names_and_values_are_those_of_the_event_that_names_them() {
    let first = [place("R/A", &["a"]), value(1), entered(3, 1), value(2), entered(5, 2)];
    let second = [place("R/A", &["b"]), entered(9, 1)];
    let blocks = [block(1, &first), block(3, &second)];
    check(
        &blocks,
        1,
        true,
        &expect![[r#"
        1 at 3: {"type":"entered","path":"R/A","inputs":{"a":[1]}}
        2 at 5: {"type":"entered","path":"R/A","inputs":{"a":[2]}}
        3 at 9: {"type":"entered","path":"R/A","inputs":{"b":[1]}}
    "#]],
    );
    check(
        &blocks,
        2,
        false,
        &expect![[r#"
        2 at 5: {"type":"entered","path":"R/A"}
        3 at 9: {"type":"entered","path":"R/A"}
    "#]],
    );
}

#[test]
fn what_is_sent_again_is_read_once() {
    let first = [place("R/A", &["a"]), value(1), entered(3, 1), entered(5, 1)];
    let again = [block(1, &first), block(1, &first), block(2, &[entered(5, 1), entered(6, 1)])];
    check(
        &again,
        0,
        true,
        &expect![[r#"
        1 at 3: {"type":"entered","path":"R/A","inputs":{"a":[1]}}
        2 at 5: {"type":"entered","path":"R/A","inputs":{"a":[1]}}
        3 at 6: {"type":"entered","path":"R/A","inputs":{"a":[1]}}
    "#]],
    );
}

#[test]
fn a_value_is_known_as_long_as_an_event_can_name_it() {
    let mut reader = StreamReader::new(0, true, None);
    let items: Vec<_> = (0..VALUE_LIFE).map(|t_ns| entered(t_ns, 1)).collect();
    let mut last = None;
    let blocks = [block(1, &[place("R/A", &["a"]), value(1)]), block(1, &items)];
    for block in blocks {
        reader.read(&block, |sequence, _, event| last = Some((sequence, event))).unwrap();
    }
    let Some((VALUE_LIFE, Event::Entered { inputs: Some(inputs), .. })) = last else {
        panic!("{last:?}");
    };
    assert_eq!(inputs["a"], json!([1]));
}

proptest! {
    #[test]
    fn any_bytes_are_a_stream_or_broken(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let mut reader = StreamReader::new(0, true, None);
        drop(reader.read(&bytes, |_, _, _| {}));
        let block = StreamBlock { first: u64::MAX, t_before: u64::MAX, items: &bytes };
        drop(reader.read_block(&block, &mut |_, _, _| {}));
    }
}

/// Returns the input of an event that names this value.
fn told(definitions: &StreamDefinitions, number: u64) -> serde_json::Value {
    let inputs = vec![Kept::Value(ValueNumber(number))];
    let entered = Record::Entered { place: PlaceNumber(0), inputs, undoes: None };
    match definitions.event(1, entered, true).unwrap() {
        Event::Entered { inputs: Some(inputs), .. } => inputs["a"].clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn values_beyond_the_memory_are_read_from_the_journal() {
    let folder = tempfile::tempdir().unwrap();
    let stored = |number: u64| Stored {
        view: json!([number]),
        type_name: "list".into(),
        content: Content::Pickle(vec![0; 1 << 20]),
    };
    let mut batch = Batch::new(0);
    batch.define(&Definition::Value(ValueNumber(1), stored(1)));
    batch.record(1, &Record::Global { name: "a".into(), value: Some(Kept::Value(ValueNumber(1))) });
    let journal = Journal::create(folder.path(), &About::default(), &Options::default()).unwrap();
    journal.append(&batch).unwrap();
    journal.close().unwrap();
    for (folder, oldest) in [
        (None, json!({ "__repr__": "<no longer kept>", "__class__": "" })),
        (Some(folder.path().to_owned()), json!([1])),
    ] {
        let definitions = StreamDefinitions::new(folder);
        let Item::Definition(Definition::Place(number, place)) = place("R/A", &["a"]) else {
            panic!("no place");
        };
        definitions.learn(StreamItem::Place { from: 1, number, place });
        for number in 1..=16 {
            let stored = stored(number).to_bytes();
            let number = ValueNumber(number);
            definitions.learn(StreamItem::Value { from: 1, number, stored: &stored });
        }
        assert_eq!(told(&definitions, 1), oldest);
        assert_eq!(told(&definitions, 2), json!([2]));
        assert_eq!(told(&definitions, 16), json!([16]));
    }
}

#[test]
fn a_place_beyond_the_bound_is_ignored_and_others_are_known() {
    let Item::Definition(Definition::Place(_, place)) = place("R/A", &["a"]) else {
        panic!("no place");
    };
    let place = Arc::new(place);
    let mut places = PlaceHistory::default();
    for number in [u32::MAX, 1 << 22, 7] {
        places.define(1, PlaceNumber(number), Arc::clone(&place));
    }
    assert_eq!(places.latest().len(), 8);
    places.define(1, PlaceNumber((1 << 22) - 1), Arc::clone(&place));
    assert_eq!(places.latest().len(), 1 << 22);
    assert_eq!(places.at(PlaceNumber((1 << 22) - 1), 1), Some(&place));
}
