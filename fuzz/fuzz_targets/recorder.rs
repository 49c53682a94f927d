//! Whatever lies in a recorder, the run can be read and resumed, and continues. The first bytes are the file's, or edits of one
//! that a run left: a byte, and where it goes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rafcon_storage::journal::{About, Batch, Journal, Kept, Options, PlaceNumber, Reader};
use std::fs;
use std::path::Path;

const OPTIONS: Options = Options { size_max: u64::MAX, recorder_bytes: 1 << 15 };

/// A run that died with some events in its recorder.
fn died(folder: &Path) {
    let journal =
        Journal::create(folder, &About::default(), &OPTIONS).expect("a folder of its own");
    let mut batch = Batch::new(0);
    for place in 0..40 {
        batch.entered(1, PlaceNumber(place), [Kept::Int(7)], None);
        journal.append(&batch).expect("there is room");
        batch.clear();
        if place == 20 {
            journal.commit().expect("a disk that works");
        }
    }
}

fuzz_target!(|bytes: &[u8]| {
    let folder = tempfile::tempdir().expect("a disk that works");
    died(folder.path());
    let recorder = folder.path().join("recorder");
    let mut file = fs::read(&recorder).expect("the run left it");
    match bytes.split_first() {
        Some((0, rest)) => file = rest.to_vec(),
        Some((_, rest)) => {
            for edit in rest.chunks_exact(3) {
                let at = usize::from(u16::from_le_bytes([edit[0], edit[1]])) % file.len();
                file[at] = edit[2];
            }
        }
        None => {}
    }
    fs::write(&recorder, file).expect("a disk that works");
    let last = Reader::open(folder.path())
        .and_then(|reader| reader.last_sequence())
        .expect("it can be read");
    assert!((21..=40).contains(&last));
    let (journal, resume_point) =
        Journal::resume(folder.path(), &OPTIONS).expect("it can be resumed");
    assert_eq!(resume_point.sequence, last);
    drop(journal);
});
