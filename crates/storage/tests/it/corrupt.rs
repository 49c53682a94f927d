//! Journals in which one byte of any file is changed: the data read is the data written, or the damage is reported.
//!
//! The default seeds start at the current date. `RAFCON_TEST_SEED` sets the first seed, `RAFCON_TEST_CORRUPTIONS` the number of
//! seeds.

use crate::reader::PLACES;
use rafcon_protocol::Event;
use rafcon_storage::journal::folder::VALUES_FOLDER;
use rafcon_storage::journal::record::Content;
use rafcon_storage::journal::{
    About, Batch, Definition, Filter, Item, Journal, JournalError, Kept, Options, Reader, Record,
    RunState, Stored, Summary, Tally, ValueNumber, compare, export_csv, export_jsonl, run_folders,
};
use rafcon_testkit::journal_notation;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// Small, so that moments are kept.
const OPTIONS: Options = Options { size_max: 1 << 20, recorder_bytes: 1 << 16 };
const PAGE: usize = 4096;
/// Number of corruptions in a normal test run.
const FEW: u64 = 24;

/// Results of all readers for an undamaged run.
#[derive(Debug)]
struct Truth {
    events: BTreeMap<u64, String>,
    moments: BTreeMap<u64, Value>,
    statistics: Value,
    summary: Value,
    about: About,
}

/// Splitmix64, which gives identical numbers for a seed on every computer.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        usize::try_from(self.next() % end.max(1) as u64).unwrap()
    }
}

/// Writes a run with values of all sizes. If it died, its last part is only in the recorder.
fn keep(run: &Path, died: bool) {
    let place = tempfile::tempdir().unwrap();
    let inner = place.path().join("run");
    let folder: &Path = if died { &inner } else { run };
    let about = About { id: "run".into(), name: "Root".into(), started_ms: 7, ..About::default() };
    let journal = Journal::create(folder, &about, &OPTIONS).unwrap();
    fs::create_dir(folder.join(VALUES_FOLDER)).unwrap();
    let large = b"a pickle that is large".repeat(40);
    let hash = blake3::hash(&large).to_hex().to_string();
    fs::write(folder.join(VALUES_FOLDER).join(&hash), &large).unwrap();
    let size = large.len() as u64;
    let mut batch = journal_notation::batch(&format!("{PLACES}\nenter R speed=1"), 0).unwrap();
    let mut value = 1000;
    for round in 0..70_u32 {
        if round == 0 {
            let content = Content::File { hash: hash.clone(), size };
            let stored = Stored { view: json!("large"), type_name: "bytes".into(), content };
            batch.define(&Definition::Value(ValueNumber(1), stored));
            let value = Some(Kept::Value(ValueNumber(1)));
            batch.record(batch.t_last() + 1, &Record::Global { name: "large".into(), value });
        }
        add(&round_text(round), round == 0, &mut value, &mut batch);
        journal.append(&batch).unwrap();
        batch.clear();
        if round % 9 == 0 && (round < 50 || !died) {
            journal.commit().unwrap();
        }
    }
    if died {
        // Closing a journal cleans up its database.
        copy(folder, run);
    } else {
        let end = r#"told {"type": "finished", "outcome": {"id": 0, "name": "done"}, "outputs": {}, "globals": {}, "scoped_variables": {}, "states_run": 210}"#;
        add(&format!("leave R done\n{end}"), false, &mut value, &mut batch);
        journal.append(&batch).unwrap();
        journal.close().unwrap();
    }
}

fn round_text(round: u32) -> String {
    let long = format!("{round} {}", "long ".repeat(usize::try_from(round % 60 * 8).unwrap()));
    format!(
        r#"
        enter R/A a=[{round}, 2]
        log R/A info "round {round}"
        global map={{"round": {round}, "text": "{long}"}}
        leave R/A ok b="{round}"
        scoped R n={round}
        enter R/H
        enter R/H/X
        leave R/H/X ok x={{"k": [{round}]}}
        persistent R/A {{"calls": {round}}}
        leave R/H ok
        "#
    )
}

/// Adds the items of a text to a batch. Its values get numbers of their own.
fn add(text: &str, with_places: bool, value: &mut u64, batch: &mut Batch) {
    let mut numbers = BTreeMap::new();
    for item in journal_notation::parse(&format!("{PLACES}\n{text}")).unwrap() {
        let (t_ns, mut record) = match item {
            Item::Record(t_ns, record) => (t_ns, record),
            Item::Definition(Definition::Value(number, stored)) => {
                *value += 1;
                numbers.insert(number, ValueNumber(*value));
                batch.define(&Definition::Value(ValueNumber(*value), stored));
                continue;
            }
            Item::Definition(place) => {
                if with_places {
                    batch.define(&place);
                }
                continue;
            }
        };
        let again = |kept: &mut Kept| {
            if let Kept::Value(number) = kept {
                *number = numbers[number];
            }
        };
        match &mut record {
            Record::Entered { inputs, .. } => inputs.iter_mut().for_each(again),
            Record::Left { outputs, .. } => outputs.iter_mut().for_each(again),
            Record::Scoped { value, .. }
            | Record::Persistent { value, .. }
            | Record::Global { value: Some(value), .. } => again(value),
            _ => {}
        }
        batch.record(t_ns, &record);
    }
}

fn files_in(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let below = entries.flat_map(|path| if path.is_dir() { files_in(&path) } else { vec![path] });
    let mut files: Vec<PathBuf> = below.collect();
    files.sort();
    files
}

fn copy(from: &Path, to: &Path) {
    for file in files_in(from) {
        let path = to.join(file.strip_prefix(from).unwrap());
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::copy(&file, &path).unwrap();
    }
}

/// Changes a file of a run and describes the change.
fn corrupt(folder: &Path, random: &mut Random) -> String {
    let mut files = files_in(folder);
    files.retain(|file| fs::metadata(file).unwrap().len() > 0);
    let file = &files[random.below(files.len())];
    let mut bytes = fs::read(file).unwrap();
    let at = random.below(bytes.len());
    let page = at / PAGE * PAGE;
    let end = (page + PAGE).min(bytes.len());
    let what = match random.below(8) {
        0..=3 => {
            bytes[at] ^= 1 << random.below(8);
            format!("one bit of byte {at}")
        }
        4 => {
            bytes[page..end].fill(0);
            format!("zeros from {page}")
        }
        5 => {
            bytes.truncate(at);
            format!("cut at {at}")
        }
        6 => {
            let other = random.below(bytes.len()) / PAGE * PAGE;
            let length = (end - page).min(bytes.len() - other);
            let (one, two) =
                (bytes[page..page + length].to_vec(), bytes[other..other + length].to_vec());
            bytes[page..page + length].copy_from_slice(&two);
            bytes[other..other + length].copy_from_slice(&one);
            format!("pages at {page} and {other} swapped")
        }
        _ => {
            let length = 1 + random.below(64);
            for byte in bytes.iter_mut().skip(at).take(length) {
                *byte = random.next().to_le_bytes()[0];
            }
            format!("{length} random bytes at {at}")
        }
    };
    fs::write(file, &bytes).unwrap();
    format!("{}: {what}", file.strip_prefix(folder).unwrap().display())
}

/// Events by number as text, and the first and last numbers of damaged ranges.
type Events = (BTreeMap<u64, String>, Vec<(u64, u64)>);

fn events(reader: &mut Reader) -> Result<Events, JournalError> {
    let (mut events, mut damaged, mut failure) = (BTreeMap::new(), Vec::new(), None);
    reader.each(1, |reader, entry| match reader.event(&entry, true) {
        Ok(Event::Damaged { first, last, .. }) => {
            damaged.push((first, last));
            ControlFlow::Continue(())
        }
        Ok(event) => {
            let line = format!("{} {}", entry.t_ns, serde_json::to_string(&event).unwrap());
            assert!(
                events.insert(entry.sequence, line).is_none(),
                "event {} twice",
                entry.sequence
            );
            ControlFlow::Continue(())
        }
        Err(error) => {
            failure = Some(error);
            ControlFlow::Break(())
        }
    })?;
    failure.map_or(Ok((events, damaged)), Err)
}

fn moment(reader: &mut Reader, sequence: u64) -> Result<Value, JournalError> {
    let moment = reader.moment(sequence)?;
    Ok(serde_json::to_value(reader.picture(&moment)?).unwrap())
}

fn statistics(reader: &mut Reader) -> Result<Value, JournalError> {
    let mut tally = Tally::default();
    tally.go_on(reader)?;
    Ok(serde_json::to_value(tally.statistics(reader.known_places())).unwrap())
}

fn summary(folder: &Path) -> Value {
    let mut json = serde_json::to_value(Summary::of(folder)).unwrap();
    json["bytes"].take();
    json
}

fn truth(folder: &Path) -> Truth {
    let mut reader = Reader::open(folder).unwrap();
    let (events, damaged) = events(&mut reader).unwrap();
    assert_eq!(damaged, []);
    let state = Summary::of(folder).state;
    assert!(!matches!(state, RunState::Unreadable { .. }), "{state:?}");
    let last = reader.last_sequence().unwrap();
    let moments = [1, 60, last / 2, last - 40, last].into_iter();
    Truth {
        events,
        moments: moments.map(|at| (at, moment(&mut reader, at).unwrap())).collect(),
        statistics: statistics(&mut reader).unwrap(),
        summary: summary(folder),
        about: reader.about().clone(),
    }
}

/// Start of the text that replaces an unreadable value.
const MARK: &str = "<damaged";

/// Returns true if the data equals the truth, except where it reports damage.
fn same(told: &Value, truth: &Value) -> bool {
    match (told, truth) {
        (Value::Object(told), Value::Object(truth)) => {
            let is_mark = |value: &Value| value.as_str().is_some_and(|text| text.starts_with(MARK));
            told.get("__repr__").is_some_and(is_mark)
                || told.len() == truth.len()
                    && told.iter().all(|(name, value)| {
                        truth.get(name).is_some_and(|truth| same(value, truth))
                    })
        }
        (Value::Array(told), Value::Array(truth)) => {
            told.len() == truth.len()
                && told.iter().zip(truth).all(|(told, truth)| same(told, truth))
        }
        (Value::Object(told), _) => {
            told.get("__repr__").and_then(Value::as_str).is_some_and(|text| text.starts_with(MARK))
        }
        _ => told == truth,
    }
}

fn same_line(told: &str, truth: &str) -> bool {
    let split = |line: &str| {
        let (time, event) = line.split_once(' ').unwrap();
        (time.to_owned(), serde_json::from_str::<Value>(event).unwrap())
    };
    let ((time, event), (true_time, true_event)) = (split(told), split(truth));
    time == true_time && same(&event, &true_event)
}

/// Reads a corrupted run in every way. The error describes wrong data.
fn read(folder: &Path, clean: &Path, truth: &Truth) -> Result<(), String> {
    if run_folders(folder.parent().unwrap()).is_err() {
        return Ok(());
    }
    let is_said = matches!(Summary::of(folder).state, RunState::Unreadable { .. });
    if !is_said && summary(folder) != truth.summary {
        return Err(format!("the summary is {:?}", summary(folder)));
    }
    let Ok(mut reader) = Reader::open(folder) else { return Ok(()) };
    if *reader.about() != truth.about {
        return Err(format!("it is about {:?}", reader.about()));
    }
    check_events(&mut reader, truth)?;
    for (at, right) in &truth.moments {
        if let Ok(told) = moment(&mut reader, *at)
            && !same(&told, right)
        {
            return Err(format!("the moment after {at} is {told}, not {right}"));
        }
    }
    if let Ok(told) = statistics(&mut reader)
        && told != truth.statistics
    {
        return Err(format!("the statistics are {told}"));
    }
    let mut other = Reader::open(clean).unwrap();
    if let Ok(compared) = compare(&mut reader, &mut other)
        && (!compared.parted.is_empty() || !compared.changed.is_empty())
    {
        return Err("it is said to be another run".to_owned());
    }
    let mut reader = Reader::open(folder).map_err(|error| error.to_string())?;
    let mut out = Vec::new();
    let written = export_jsonl(&mut reader, &Filter::default(), &mut out);
    if written.is_ok() && reader.check().is_ok() {
        let mut right = Vec::new();
        export_jsonl(&mut other, &Filter::default(), &mut right).unwrap();
        if out != right {
            return Err("the export is another".to_owned());
        }
    }
    drop(export_csv(&mut reader, &Filter::default(), Vec::new()));
    resume(folder, truth)
}

fn check_events(reader: &mut Reader, truth: &Truth) -> Result<(), String> {
    let Ok((told, damaged)) = events(reader) else { return Ok(()) };
    for (sequence, line) in &told {
        let right =
            truth.events.get(sequence).ok_or_else(|| format!("{sequence} is new: {line}"))?;
        if !same_line(line, right) {
            return Err(format!("event {sequence} is {line}, not {right}"));
        }
    }
    let is_said = |sequence: &u64| {
        damaged.iter().any(|(first, last)| (first..=last).contains(&sequence))
            || damaged.iter().any(|(first, _)| first == &(told.len() as u64 + 1))
    };
    let missing = truth.events.keys().find(|it| !told.contains_key(it) && !is_said(it));
    if let Some(sequence) = missing {
        return Err(format!("event {sequence} is missing, and nobody says so"));
    }
    let is_marked = told.values().any(|line| line.contains(MARK));
    if (is_marked || !damaged.is_empty()) && reader.check().is_ok() {
        return Err("damage was seen and is not named".to_owned());
    }
    Ok(())
}

/// Resumes a run. It must have all its data, refuse, or report what it lost.
fn resume(folder: &Path, truth: &Truth) -> Result<(), String> {
    let Ok((journal, resume_point)) = Journal::resume(folder, &OPTIONS) else { return Ok(()) };
    let last = truth.events.len() as u64;
    if resume_point.sequence != last && resume_point.lost.is_none() {
        return Err(format!("it is resumed after event {}", resume_point.sequence));
    }
    let mut reader = Reader::open(folder).map_err(|error| error.to_string())?;
    let moment = reader.moment(resume_point.sequence);
    if let Ok(moment) = moment
        && reader.check_values(&moment).is_ok()
    {
        let told = serde_json::to_value(reader.picture(&moment).unwrap()).unwrap();
        let right = &truth.moments[&last];
        let parts = ["globals", "persistent"];
        let is_kept = parts.iter().all(|part| told[part] == right[part]);
        if resume_point.sequence == last && !(is_kept && same(&told, right)) {
            return Err(format!("scripts would get {told}, not {right}"));
        }
    }
    drop(journal.close());
    Ok(())
}

fn number(name: &str) -> Option<u64> {
    std::env::var_os(name)?.to_str()?.parse().ok()
}

#[expect(clippy::disallowed_methods, reason = "each day begins with seeds of its own")]
fn today() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs() / 86_400 * 1_000_000
}

#[test]
fn what_is_read_of_a_corrupted_journal_is_true() {
    let folder = tempfile::tempdir().unwrap();
    let clean: Vec<PathBuf> = ["ended", "died"].map(|name| folder.path().join(name)).into();
    clean.iter().zip([false, true]).for_each(|(run, died)| keep(run, died));
    let truths: Vec<Truth> = clean
        .iter()
        .map(|run| {
            // Reading may leave files beside the database.
            let read = tempfile::tempdir().unwrap();
            copy(run, &read.path().join("run"));
            truth(&read.path().join("run"))
        })
        .collect();
    let from = number("RAFCON_TEST_SEED").unwrap_or_else(today);
    let count = number("RAFCON_TEST_CORRUPTIONS").unwrap_or(FEW);
    for seed in from..from + count {
        let which = usize::try_from(seed % 2).unwrap();
        let place = tempfile::tempdir().unwrap();
        let [run, whole] = ["runs/run", "whole"].map(|name| place.path().join(name));
        copy(&clean[which], &run);
        copy(&clean[which], &whole);
        let what = corrupt(&run, &mut Random(seed));
        if let Err(wrong) = read(&run, &whole, &truths[which]) {
            panic!("RAFCON_TEST_SEED={seed}: {what}: {wrong}");
        }
    }
}
