//! Journals of finished runs, and their expected histories.

use rafcon_protocol::Event;
use rafcon_protocol::api::HistoryEntry;
use rafcon_storage::journal::{About, Journal, Options, Reader};
use rafcon_testkit::journal_notation;
use serde_json::Value;
use std::path::Path;

const MACHINE: &str = r#"
    place R "Root" scoped n outcome done
    place R/A "Root/Scan" script in a out b outcome ok
"#;
const ROUND: &str =
    "enter R/A a=[1, 2]\nscoped R n=7\nlog R/A info \"hi\"\nleave R/A ok b=2 error=\"x\"\n";
const END: &str = r#"
    leave R done
    told {"type":"finished","outcome":{"id":0,"name":"done"},"outputs":{},"globals":{},"scoped_variables":{},"states_run":1}
"#;

/// Number of events per round.
pub(crate) const PER_ROUND: usize = 4;

/// Makes a finished run with this many rounds in a folder of runs.
pub(crate) fn make(runs: &Path, id: &str, rounds: usize) {
    let about = About { name: "Root".to_owned(), ..About::default() };
    let options = Options { recorder_bytes: 1 << 22, ..Options::default() };
    let journal = Journal::create(&runs.join(id), &about, &options).unwrap();
    let mut before = 0;
    let mut append = |text: &str| {
        let batch = journal_notation::batch(&format!("{MACHINE}{text}"), before).unwrap();
        before = batch.t_last();
        journal.append(&batch).unwrap();
        journal.commit().unwrap();
    };
    append("enter R\n");
    (0..rounds / 100).for_each(|_| append(&ROUND.repeat(100)));
    append(&ROUND.repeat(rounds % 100));
    append(END);
    journal.close().unwrap();
}

/// The expected events for a client that has received everything before event `from`.
pub(crate) fn history(runs: &Path, id: &str, from: u64, values: bool) -> Vec<Value> {
    let mut reader = Reader::open(&runs.join(id)).unwrap();
    let page = reader.page(from, usize::MAX).unwrap();
    let entries = page.iter().map(|entry| {
        let event = reader.event(entry, values).unwrap();
        HistoryEntry { sequence: entry.sequence, t_ns: entry.t_ns, event }
    });
    let told = entries.filter(|entry| values || !matches!(entry.event, Event::Scoped { .. }));
    told.map(|entry| serde_json::to_value(entry).unwrap()).collect()
}
