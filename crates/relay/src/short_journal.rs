//! Journals of short runs, for tests.

use rafcon_protocol::{Event, Outcome};
use rafcon_storage::journal::{About, Batch, Journal, Options, Record};
use std::path::Path;

/// Begins the journal of a run, with this number of events.
pub(crate) fn begun(folder: &Path, about: &About, events: u64) -> Journal {
    let options = Options { recorder_bytes: 1 << 15, ..Options::default() };
    let journal = Journal::create(folder, about, &options).unwrap();
    append(&journal, events);
    journal
}

/// The same for a run that has ended after one more event.
pub(crate) fn ended(folder: &Path, about: &About, events: u64) {
    let journal = begun(folder, about, events);
    let outcome = Outcome { id: 0, name: "success".to_owned() };
    let (outputs, globals, scoped_variables) = Default::default();
    let end = Event::Finished { outcome, outputs, globals, scoped_variables, states_run: 1 };
    let mut batch = Batch::new(events);
    batch.record(events, &Record::Told(Box::new(end)));
    journal.append(&batch).unwrap();
    journal.close().unwrap();
}

/// Adds this number of events.
pub(crate) fn append(journal: &Journal, count: u64) {
    let mut batch = Batch::new(0);
    (0..count).for_each(|t_ns| batch.record(t_ns, &Record::Told(Box::new(Event::Stopping))));
    journal.append(&batch).unwrap();
    journal.commit().unwrap();
}
