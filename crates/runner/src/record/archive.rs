//! The journal of the run, as its own viewers read it: what memory has given up. Knows how to open it; must never keep anybody
//! from writing it.

use rafcon_storage::journal::{Reader, Record};
use std::path::Path;

/// Events read at once.
const PAGE: usize = 4096;

/// A journal that is opened when it is needed.
#[derive(Debug, Default)]
pub(crate) struct Archive {
    reader: Option<Reader>,
}

impl Archive {
    /// Some events with numbers from `from` to before `end`. None if they cannot be had.
    pub(crate) fn page(
        &mut self,
        folder: Option<&Path>,
        from: u64,
        end: u64,
    ) -> Option<Vec<(u64, u64, Record)>> {
        let page = self.open(folder)?.page(from, PAGE).ok()?;
        let wanted = page.into_iter().take_while(|entry| entry.sequence < end);
        let records: Vec<_> =
            wanted.map(|entry| (entry.sequence, entry.t_ns, entry.record)).collect();
        (!records.is_empty()).then_some(records)
    }

    fn open(&mut self, folder: Option<&Path>) -> Option<&mut Reader> {
        if self.reader.is_none() {
            self.reader = Reader::open(folder?).ok();
        }
        self.reader.as_mut()
    }
}
