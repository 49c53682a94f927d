//! Journals of any content, sent in parts of any size, some of them twice, to replicas that are reopened repeatedly.

use expect_test::expect;
use proptest::prelude::*;
use rafcon_storage::journal::record::Content;
use rafcon_storage::journal::{
    About, Chain, ContentHash, Definition, Entry, EventSource, IncomingContent, Journal, Kept,
    Options, Reader, Record, Replica, ReplicaError, Stored, ValueNumber, is_content_here,
};
use rafcon_testkit::journal_notation;
use std::path::Path;

const MACHINE: &str = r#"
    place R "Root" scoped n outcome done
    place R/A "Root/Scan" script in a in c out b outcome ok
"#;

const SMALL: Options = Options { size_max: u64::MAX, recorder_bytes: 1 << 15 };

const ROUNDS: [&str; 5] = [
    "enter R/A a=1 c=2\nleave R/A ok b=2\n",
    "enter R/A a=[1, 2] c={\"x\": 1}\nscoped R n=[3]\nleave R/A ok b=[4]\n",
    "log R/A info \"hi\"\nglobal map=\"kitchen\"\n",
    "persistent R/A {\"calls\": 1}\n",
    "place R/A \"Root/Scan again\" script in a in c out b outcome ok\nenter R/A a=[5] c=0\nleave R/A ok b=6\n",
];

fn write(folder: &Path, rounds: &[usize]) {
    let journal = Journal::create(folder, &About::default(), &SMALL).unwrap();
    let text: String = rounds.iter().map(|round| ROUNDS[*round]).collect();
    let batch = journal_notation::batch(&format!("{MACHINE}enter R\n{text}leave R done\n"), 0);
    journal.append(&batch.unwrap()).unwrap();
    journal.close().unwrap();
}

/// Returns all events, their names and all values.
fn whole(folder: &Path) -> (Vec<Entry>, Vec<String>, Vec<Option<Stored>>) {
    let mut reader = Reader::open(folder).unwrap();
    let entries = reader.page(1, usize::MAX).unwrap();
    let events = entries.iter().map(|entry| format!("{:?}", reader.event(entry, true).unwrap()));
    let (events, values) = (events.collect(), 0..100);
    let values = values.map(|number| reader.value(ValueNumber(number)).ok().flatten()).collect();
    (entries, events, values)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_replica_is_the_journal_that_it_was_sent(
        rounds in prop::collection::vec(0..ROUNDS.len(), 0..30),
        parts in prop::collection::vec((1..90_u64, 0..9_u64, 1..400_usize, any::<bool>()), 1..30),
    ) {
        let (robot, station) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        write(robot.path(), &rounds);
        let mut source = EventSource::open(robot.path()).unwrap();
        let head = source.last().unwrap();
        let entries = source.reader().page(1, usize::MAX).unwrap();
        let open = || Replica::open(station.path(), &About::default(), &SMALL).unwrap();
        let mut replica = open();
        for (first, more, bytes_max, dies) in parts {
            // Sometimes from an arbitrary event, otherwise from the next one.
            let first = if more == 0 { first } else { replica.next().saturating_sub(more / 3).max(1) };
            let read = source.read(first, head, bytes_max).unwrap();
            // The result must not depend on earlier reads.
            let mut fresh = EventSource::open(robot.path()).unwrap();
            prop_assert_eq!(&read, &fresh.read(first, head, bytes_max).unwrap());
            if let Some(items) = read {
                let continues = items.sequences().contains(&replica.next());
                prop_assert_eq!(replica.append(&items).unwrap(), continues);
            }
            if dies {
                drop(replica);
                replica = open();
            }
        }
        while let Some(items) = source.read(replica.next(), head, 300).unwrap() {
            let before = entries.iter().find(|entry| entry.sequence + 1 == items.first_sequence);
            prop_assert_eq!(items.time_before, before.map_or(0, |entry| entry.t_ns));
            prop_assert!(replica.append(&items).unwrap());
        }
        prop_assert_eq!(replica.next(), head + 1);
        replica.close().unwrap();
        prop_assert_eq!(whole(station.path()), whole(robot.path()));
        let hash = |folder: &Path, bytes_max| {
            let (mut reader, mut chain) = (Reader::open(folder).unwrap(), Chain::default());
            while chain.last() < head {
                chain.advance(&mut reader, head, bytes_max).unwrap();
            }
            chain
        };
        prop_assert_eq!(hash(station.path(), 0), hash(robot.path(), 1_000));
    }

    #[test]
    fn a_journal_with_another_history_is_not_continued(
        rounds in prop::collection::vec(0..ROUNDS.len(), 2..9), other in 0..ROUNDS.len(), changed in any::<prop::sample::Index>(),
    ) {
        let folders = [(); 3].map(|()| tempfile::tempdir().unwrap());
        let [robot, put_back, station] = folders.each_ref().map(tempfile::TempDir::path);
        write(robot, &rounds);
        let mut others = rounds.clone();
        others[changed.index(rounds.len())] = other;
        write(put_back, &others);
        let [mut before, mut after] = [robot, put_back].map(|folder| EventSource::open(folder).unwrap());
        let head = before.last().unwrap().min(after.last().unwrap());
        let hash = |source: &mut EventSource| {
            let mut chain = Chain::default();
            chain.advance(source.reader(), head, usize::MAX).unwrap();
            chain.hash()
        };
        let is_equal = before.reader().page(1, usize::MAX).unwrap() == after.reader().page(1, usize::MAX).unwrap();
        prop_assert!(!is_equal || hash(&mut before) == hash(&mut after));
        let entries = [&mut before, &mut after].map(|source| source.reader().page(1, usize::try_from(head).unwrap()).unwrap());
        prop_assert_eq!(entries[0] == entries[1], hash(&mut before) == hash(&mut after));
        let mut replica = Replica::open(station, &About::default(), &SMALL).unwrap();
        replica.append(&before.read(1, head - 1, usize::MAX).unwrap().unwrap()).unwrap();
        let mut items = after.read(head, head, usize::MAX).unwrap().unwrap();
        items.time_before += 1;
        let refused = replica.append(&items).unwrap_err();
        let is_diverged = matches!(refused, ReplicaError::Diverged { .. });
        prop_assert!(is_diverged, "{}", refused);
        prop_assert_eq!(replica.next(), head);
    }

    #[test]
    fn broken_items_are_refused_and_change_nothing(
        at in any::<prop::sample::Index>(), to in any::<u8>(),
    ) {
        let (robot, station) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        write(robot.path(), &[1, 4]);
        let mut items = EventSource::open(robot.path()).unwrap().read(1, 99, 9_999).unwrap().unwrap();
        let at = at.index(items.bytes.len());
        items.bytes[at] = to;
        let mut replica = Replica::open(station.path(), &About::default(), &SMALL).unwrap();
        let next = replica.append(&items).map_or(1, |_| items.count + 1);
        prop_assert_eq!(replica.next(), next);
    }
}

#[test]
fn events_that_are_not_as_many_as_they_should_be_are_refused() {
    let (robot, station) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    write(robot.path(), &[0]);
    let mut source = EventSource::open(robot.path()).unwrap();
    let mut items = source.read(1, 99, 9_999).unwrap().unwrap();
    items.count += 1;
    let mut replica = Replica::open(station.path(), &About::default(), &SMALL).unwrap();
    let refused = replica.append(&items).unwrap_err();
    assert!(matches!(refused, ReplicaError::Count { .. }));
    expect!["5 events were announced, but 4 arrived: use one version of rafcon on both sides"]
        .assert_eq(&refused.to_string());
    assert_eq!(replica.next(), 1);
}

/// Returns the size of a folder with a few files.
fn size(folder: &Path) -> u64 {
    std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().metadata().unwrap().len()).sum()
}

#[test]
fn a_closed_replica_of_a_few_events_is_small_also_after_it_was_read() {
    let (robot, station) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let journal = Journal::create(robot.path(), &About::default(), &SMALL).unwrap();
    journal.append(&journal_notation::batch(&format!("{MACHINE}enter R\n"), 0).unwrap()).unwrap();
    journal.close().unwrap();
    let mut source = EventSource::open(robot.path()).unwrap();
    let head = source.last().unwrap();
    let items = source.read(1, head, usize::MAX).unwrap().unwrap();
    let mut replica = Replica::open(station.path(), &About::default(), &SMALL).unwrap();
    replica.append(&items).unwrap();
    replica.close().unwrap();
    assert_eq!(Reader::open(station.path()).unwrap().last_sequence().unwrap(), head);
    assert!(size(station.path()) < 40 << 10, "{} bytes", size(station.path()));
    // The replica can be continued nevertheless.
    let replica = Replica::open(station.path(), &About::default(), &SMALL).unwrap();
    assert_eq!(replica.next(), head + 1);
}

/// Returns the content of the value with this number, in the journal of a run.
fn content(folder: &Path, number: u64) -> Content {
    Reader::open(folder).unwrap().value(ValueNumber(number)).unwrap().unwrap().content
}

#[test]
fn bytes_that_were_not_sent_are_named_by_their_hash_and_count_once_they_are_here() {
    let (robot, station) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let journal = Journal::create(robot.path(), &About::default(), &SMALL).unwrap();
    let mut batch = journal_notation::batch(&format!("{MACHINE}enter R\n"), 0).unwrap();
    let pickles = [vec![7; 50], vec![8; 5_000]];
    for (number, pickle) in (90..).zip(&pickles) {
        let (view, type_name) = (serde_json::json!("part"), "ndarray".into());
        let stored = Stored { view, type_name, content: Content::Pickle(pickle.clone()) };
        batch.define(&Definition::Value(ValueNumber(number), stored));
        let (name, value) = ("map".into(), Some(Kept::Value(ValueNumber(number))));
        batch.record(number, &Record::Global { name, value });
    }
    journal.append(&batch).unwrap();
    journal.close().unwrap();
    let mut source = EventSource::open(robot.path()).unwrap().without_pickles_over(100);
    let head = source.last().unwrap();
    let items = source.read(1, head, usize::MAX).unwrap().unwrap();
    assert!(items.bytes.len() < 1_000);
    let about = About { robot: Some("scout".to_owned()), ..About::default() };
    let mut replica = Replica::open(station.path(), &about, &SMALL).unwrap();
    replica.append(&items).unwrap();
    // A station dies and continues.
    drop(replica);
    Replica::open(station.path(), &about, &SMALL).unwrap().close().unwrap();
    assert_eq!(content(station.path(), 90), Content::Pickle(pickles[0].clone()));
    let hash = ContentHash::of(&pickles[1]);
    let elsewhere = Content::File { hash: hash.name(), size: 5_000 };
    assert_eq!(content(station.path(), 91), elsewhere);
    assert!(!is_content_here(station.path(), &hash.name(), 5_000));
    let (incoming, _) = IncomingContent::open(station.path(), hash, 5_000).unwrap();
    incoming.write(0, &pickles[1]).unwrap();
    assert!(incoming.finish().unwrap());
    assert!(is_content_here(station.path(), &hash.name(), 5_000));
}
