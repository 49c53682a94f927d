//! A power cut at any moment: the database has its last synced state and any part of later writes. Each page of the recorder, which
//! is never synced, may be of any age.

use super::{SMALL, create, entered, kept};
use crate::journal::folder::{ABOUT_FILE, DATABASE_FILE, RECORDER_FILE, SPILL_FOLDER};
use crate::journal::{Batch, Journal};
use proptest::prelude::*;
use proptest::sample::Index;
use std::fs;
use std::path::Path;

const WAL_FILE: &str = "journal.db-wal";
const PAGE: usize = 4096;

/// Action of the writer.
#[derive(Debug, Clone)]
enum Step {
    /// Appends this many records in one batch.
    Append(usize),
    Commit,
}

/// Files of a journal at one moment.
#[derive(Debug, Clone, Default)]
struct Files {
    about: Vec<u8>,
    database: Vec<u8>,
    wal: Vec<u8>,
    recorder: Vec<u8>,
    spilled: Vec<(String, Vec<u8>)>,
    /// Last event that was reported as safe.
    safe: u64,
}

/// Random effects of the power cut.
#[derive(Debug, Clone)]
struct Cut {
    /// Step after which the power cut occurs.
    after: Index,
    /// Surviving part of the unsynced write-ahead log.
    wal: Index,
    /// Age of each page of the recorder.
    pages: Vec<Index>,
    /// Surviving part of the recorder.
    recorder: Option<Index>,
    /// Surviving part of each spilled file.
    spilled: Index,
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let step = prop_oneof![
        6 => (1_usize..30).prop_map(Step::Append),
        1 => (300_usize..600).prop_map(Step::Append),
        2 => Just(Step::Commit),
    ];
    prop::collection::vec(step, 1..40)
}

fn cut() -> impl Strategy<Value = Cut> {
    let parts = (any::<Index>(), any::<Index>(), any::<Index>());
    let pages = prop::collection::vec(any::<Index>(), 9);
    (parts, pages, prop::option::weighted(0.3, any::<Index>())).prop_map(
        |((after, wal, spilled), pages, recorder)| Cut { after, wal, pages, recorder, spilled },
    )
}

fn read(folder: &Path, safe: u64) -> Files {
    let read = |name: &str| fs::read(folder.join(name)).unwrap_or_default();
    let spilled = fs::read_dir(folder.join(SPILL_FOLDER)).into_iter().flatten().map(|entry| {
        let entry = entry.unwrap();
        (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())
    });
    Files {
        about: read(ABOUT_FILE),
        database: read(DATABASE_FILE),
        wal: read(WAL_FILE),
        recorder: read(RECORDER_FILE),
        spilled: spilled.collect(),
        safe,
    }
}

/// Executes the steps. Returns the files before the first step and after each step.
fn history(folder: &Path, steps: &[Step]) -> Vec<Files> {
    let journal = create(folder);
    let (mut batch, mut next) = (Batch::new(0), 1);
    let mut files = vec![read(folder, 0)];
    for step in steps {
        match step {
            Step::Append(count) => {
                (next..).take(*count).for_each(|place| entered(&mut batch, 7, place));
                if journal.append(&batch).is_ok() {
                    next += u32::try_from(*count).unwrap();
                }
                batch.clear();
            }
            Step::Commit => {
                journal.commit().unwrap();
            }
        }
        files.push(read(folder, journal.disk_safe()));
    }
    files
}

/// Returns the files as they may be found after a power cut, and how much must be present.
fn found(history: &[Files], cut: &Cut) -> Files {
    let now = cut.after.index(history.len());
    // The interrupted step had written a part of its data.
    let interrupted = &history[(now + 1).min(history.len() - 1)];
    let synced = &history[now];
    let mut files = synced.clone();
    if interrupted.wal.len() > synced.wal.len() {
        let torn = cut.wal.index(interrupted.wal.len() - synced.wal.len() + 1);
        files.wal = interrupted.wal[..synced.wal.len() + torn].to_vec();
    }
    for (number, (bytes, age)) in files.recorder.chunks_mut(PAGE).zip(&cut.pages).enumerate() {
        let source = &history[age.index((now + 2).min(history.len()))].recorder;
        let start = number * PAGE;
        // The first page and the size of the file were synced when it was made.
        if number > 0 {
            bytes.copy_from_slice(&source[start..start + bytes.len()]);
        }
    }
    if let Some(length) = cut.recorder {
        files.recorder.truncate(length.index(files.recorder.len()));
    }
    files.spilled.extend(interrupted.spilled.iter().cloned());
    for (_, bytes) in &mut files.spilled {
        bytes.truncate(cut.spilled.index(bytes.len() * 2));
    }
    files
}

fn write(folder: &Path, files: &Files) {
    fs::create_dir_all(folder.join(SPILL_FOLDER)).unwrap();
    let named = [
        (ABOUT_FILE, &files.about),
        (DATABASE_FILE, &files.database),
        (WAL_FILE, &files.wal),
        (RECORDER_FILE, &files.recorder),
    ];
    for (name, bytes) in named {
        fs::write(folder.join(name), bytes).unwrap();
    }
    for (name, bytes) in &files.spilled {
        fs::write(folder.join(SPILL_FOLDER).join(name), bytes).unwrap();
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn what_was_told_to_be_safe_is_there_and_nothing_that_never_was(
        steps in steps(),
        cuts in prop::collection::vec(cut(), 4),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let history = history(&folder.path().join("run"), &steps);
        for (number, cut) in cuts.iter().enumerate() {
            let files = found(&history, cut);
            let run = folder.path().join(number.to_string());
            write(&run, &files);
            let (journal, resume_point) = Journal::resume(&run, &SMALL).unwrap();
            prop_assert!(resume_point.sequence >= files.safe, "{} < {}", resume_point.sequence, files.safe);
            let mut batch = Batch::new(resume_point.t_ns);
            entered(&mut batch, 8, 0);
            prop_assert_eq!(journal.append(&batch).unwrap(), resume_point.sequence + 1);
            journal.close().unwrap();
            let expected: Vec<String> = (1..=resume_point.sequence).map(|n| format!("{n}:7:{n}")).collect();
            let last = format!("{}:8:0", resume_point.sequence + 1);
            let expected: Vec<String> = expected.into_iter().chain([last]).collect();
            prop_assert_eq!(kept(&run), expected.join(" "));
        }
    }
}
