//! Items survive encoding and decoding. Any bytes are read without a panic.

use super::BinaryReader;
use crate::journal::record::{
    Content, Definition, Item, Items, Kept, Place, PlaceNumber, Record, Stored, ValueNumber,
};
use proptest::prelude::*;
use rafcon_protocol::{Event, LogLevel, Stream};
use serde_json::json;

fn kept() -> impl Strategy<Value = Kept> {
    prop_oneof![
        Just(Kept::Absent),
        Just(Kept::None),
        any::<bool>().prop_map(Kept::Bool),
        any::<i64>().prop_map(Kept::Int),
        (-1e300..1e300).prop_map(Kept::Float),
        ".{0,16}".prop_map(|text| Kept::Text(text.into())),
        any::<u64>().prop_map(|number| Kept::Value(ValueNumber(number))),
    ]
}

fn record() -> impl Strategy<Value = Record> {
    let place = || any::<u32>().prop_map(PlaceNumber);
    let list = || prop::collection::vec(kept(), 0..4);
    prop_oneof![
        (place(), list(), any::<u64>()).prop_map(|(place, inputs, undoes)| Record::Entered {
            place,
            inputs,
            undoes: undoes.try_into().ok()
        }),
        (place(), any::<i64>(), list(), prop::option::of(kept())).prop_map(
            |(place, outcome, outputs, error)| Record::Left {
                place,
                outcome,
                outputs,
                error,
                undoes: None
            }
        ),
        (place(), any::<u64>(), kept()).prop_map(|(place, port, value)| Record::Scoped {
            place,
            port,
            value
        }),
        (".*", prop::option::of(kept()))
            .prop_map(|(name, value)| Record::Global { name: name.into(), value }),
        (place(), kept()).prop_map(|(place, value)| Record::Persistent { place, value }),
        ".*".prop_map(|message| Record::Log {
            place: None,
            level: LogLevel::Warning,
            stream: Stream::Stderr,
            message
        }),
        (any::<u64>(), prop::collection::vec(any::<u8>(), 0..9))
            .prop_map(|(sequence, moment)| Record::WentBack { sequence, moment }),
        Just(Record::Told(Box::new(Event::Stopping))),
    ]
}

fn items() -> impl Strategy<Value = Item> {
    let place = Place {
        path: "A/B".to_owned(),
        names: "root/scan".to_owned(),
        is_library: false,
        is_script: true,
        inputs: vec![(0, "in".into())],
        outputs: vec![(7, "out".into())],
        scoped: vec![],
        outcomes: vec![(-1, "aborted".into()), (0, "done".into())],
    };
    let contents = [
        Content::View,
        Content::Pickle(vec![0, 255]),
        Content::File { hash: "ab".to_owned(), size: 300 },
        Content::Nothing("a lock".to_owned()),
    ];
    let stored = prop::sample::select(contents.to_vec()).prop_map(|content| {
        let stored = Stored { view: json!({"__repr__": "x"}), type_name: "Lock".into(), content };
        Item::Definition(Definition::Value(ValueNumber(300), stored))
    });
    prop_oneof![
        4 => (0..u64::MAX / 2, record()).prop_map(|(t_ns, record)| Item::Record(t_ns, record)),
        1 => Just(Item::Definition(Definition::Place(PlaceNumber(9), place))),
        1 => stored,
    ]
}

proptest! {
    #[test]
    fn items_are_read_as_they_were_written(items in prop::collection::vec(items(), 0..8)) {
        let (mut bytes, mut before, mut latest) = (Vec::new(), 5, 5);
        let mut expected = Vec::new();
        for item in items {
            item.write(&mut before, &mut bytes);
            expected.push(match item {
                Item::Record(t_ns, record) => {
                    latest = latest.max(t_ns);
                    Item::Record(latest, record)
                }
                definition @ Item::Definition(_) => definition,
            });
        }
        let read: Vec<Item> = Items::new(&bytes, 5).map(Result::unwrap).collect();
        prop_assert_eq!(read, expected);
    }

    #[test]
    fn without_values_the_same_records_are_read(records in prop::collection::vec(record(), 0..8)) {
        let (mut bytes, mut before) = (Vec::new(), 0);
        for record in &records {
            Item::Record(7, record.clone()).write(&mut before, &mut bytes);
        }
        let (mut reader, mut read) = (BinaryReader::without_values(&bytes), Vec::new());
        while !reader.is_at_end() {
            read.push(reader.next_record(7).unwrap().1);
        }
        let bare: Vec<Record> = records.into_iter().map(bare).collect();
        prop_assert_eq!(read, bare);
    }

    #[test]
    fn any_bytes_are_read_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..64)) {
        prop_assert!(Items::new(&bytes, 0).count() <= bytes.len());
        let mut bare = BinaryReader::without_values(&bytes);
        while !bare.is_at_end() && bare.next_record(0).is_ok() {}
    }
}

/// Returns a record without the values of ports and variables.
fn bare(record: Record) -> Record {
    match record {
        Record::Entered { place, undoes, .. } => {
            Record::Entered { place, inputs: Vec::new(), undoes }
        }
        Record::Left { place, outcome, error, undoes, .. } => {
            Record::Left { place, outcome, outputs: Vec::new(), error, undoes }
        }
        Record::Scoped { place, port, .. } => Record::Scoped { place, port, value: Kept::Absent },
        Record::Global { name, value } => {
            Record::Global { name, value: value.map(|_| Kept::Absent) }
        }
        Record::Persistent { place, .. } => Record::Persistent { place, value: Kept::Absent },
        other => other,
    }
}
