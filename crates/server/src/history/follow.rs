//! A run's journal from a cursor on, as text that is ready to send: for clients that follow a run and lag behind the events in memory.
//!
//! Knows journals. Does not know the clients, nor the arrival of new events.

use super::{History, Readers};
use crate::Failure;
use rafcon_protocol::api::HistoryEntry;
use rafcon_storage::journal::{Entry, Reader, is_about_values};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Limit on the events examined for a page: a run with only value events may yield no text.
const LOOK: u64 = 20_000;

/// Reads the journal of one run in pages. Cheap to keep: the journal is open only during reads, or shared.
#[derive(Debug, Clone)]
pub(crate) struct HistoryReader {
    readers: Arc<Readers>,
    folder: PathBuf,
    values: bool,
}

/// A page of consecutive events.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct HistoryPage {
    /// Each entry is a [`HistoryEntry`] as JSON.
    pub(crate) entries: Vec<String>,
    /// Cursor of the next page. Without values, numbers may be skipped; the oldest events may have been dropped.
    pub(crate) next: u64,
}

impl HistoryReader {
    /// A reader for the run in `folder`. Without `values`, it skips events that only concern values.
    pub(crate) fn new(history: &History, folder: &Path, values: bool) -> Self {
        Self { readers: Arc::clone(&history.readers), folder: folder.to_owned(), values }
    }

    /// The events from number `from` on: at most `count`, and no more once they reach `bytes`. `next` equals `from` if there are
    /// no new events.
    pub(crate) async fn page(
        &self,
        from: u64,
        count: usize,
        bytes: usize,
    ) -> Result<HistoryPage, Failure> {
        let values = self.values;
        let read =
            move |reader: &mut Reader| page(reader, from, PageLimits { count, bytes }, values);
        self.readers.read(self.folder.clone(), read).await
    }
}

/// The limits of a page.
#[derive(Debug, Clone, Copy)]
struct PageLimits {
    count: usize,
    bytes: usize,
}

fn page(
    reader: &mut Reader,
    from: u64,
    limits: PageLimits,
    values: bool,
) -> Result<HistoryPage, Failure> {
    let mut page = HistoryPage { entries: Vec::new(), next: from };
    let (mut bytes, mut failure) = (0, None);
    let end = from.saturating_add(LOOK);
    let go_on = |next| if next < end { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    reader.each(from, |reader, entry| {
        page.next = entry.sequence + 1;
        match text(reader, &entry, values) {
            Ok(None) => return go_on(page.next),
            Ok(Some(text)) => {
                bytes += text.len();
                page.entries.push(text);
            }
            Err(error) => failure = Some(error),
        }
        let is_full = page.entries.len() >= limits.count || bytes >= limits.bytes;
        if is_full || failure.is_some() { ControlFlow::Break(()) } else { go_on(page.next) }
    })?;
    failure.map_or(Ok(page), Err)
}

fn text(reader: &Reader, entry: &Entry, values: bool) -> Result<Option<String>, Failure> {
    if !values && is_about_values(&entry.record) {
        return Ok(None);
    }
    let event = reader.event(entry, values)?;
    let entry = HistoryEntry { sequence: entry.sequence, t_ns: entry.t_ns, event };
    let failed = |error: serde_json::Error| {
        let message = format!("event {} cannot be written as JSON: {error}", entry.sequence);
        Failure::unprocessable("journal_damaged", message)
    };
    serde_json::to_string(&entry).map(Some).map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::{PageLimits, page};
    use proptest::prelude::*;
    use rafcon_storage::journal::{About, Journal, Options, Reader};
    use rafcon_testkit::journal_notation;
    use std::path::Path;

    const MACHINE: &str = r#"
        place R "Root" scoped n outcome done
        place R/A "Root/Scan" script in a out b outcome ok
    "#;

    /// A run of many rounds, the last of which is not in the database.
    fn run(folder: &Path, rounds: usize) -> Reader {
        let options = Options { recorder_bytes: 1 << 18, ..Options::default() };
        let journal = Journal::create(folder, &About::default(), &options).unwrap();
        let round = "enter R/A a=[1, 2]\nscoped R n=7\nlog R/A info \"hi\"\nleave R/A ok b=2\n";
        let mut t_ns = 0;
        for round in ["enter R\n", &round.repeat(rounds), round] {
            journal.commit().unwrap();
            let batch = journal_notation::batch(&format!("{MACHINE}{round}"), t_ns).unwrap();
            t_ns = batch.t_last();
            journal.append(&batch).unwrap();
        }
        drop(journal);
        Reader::open(folder).unwrap()
    }

    fn whole(reader: &mut Reader, values: bool) -> Vec<String> {
        let entries = reader.page(1, usize::MAX).unwrap();
        let text = |entry| super::text(reader, entry, values).unwrap();
        entries.iter().filter_map(text).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn pages_of_any_size_are_the_whole_history(
            rounds in 1..30_usize,
            sizes in prop::collection::vec((1..20_usize, 1..600_usize), 1..10),
            values: bool,
        ) {
            let folder = tempfile::tempdir().unwrap();
            let mut reader = run(folder.path(), rounds);
            let (mut found, mut from) = (Vec::new(), 0);
            for (count, bytes) in sizes.iter().cycle() {
                let limits = PageLimits { count: *count, bytes: *bytes };
                let page = page(&mut reader, from, limits, values).unwrap();
                prop_assert!(page.entries.len() <= *count);
                if page.next == from {
                    break;
                }
                from = page.next;
                found.extend(page.entries);
            }
            prop_assert_eq!(found, whole(&mut reader, values));
            prop_assert_eq!(from, reader.last_sequence().unwrap() + 1);
        }
    }
}
