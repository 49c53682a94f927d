//! The newest revisions of an open machine, as texts that are told to everybody who follows it. Bounded: whoever was away for
//! too long gets the whole machine instead. Pure.

use std::collections::VecDeque;
use std::sync::Arc;

/// So many bytes of revisions are kept.
const BYTES_MAX: usize = 16 << 20;
/// About so many bytes are given at once.
const PAGE_BYTES: usize = 256 << 10;

/// A revision as it is told.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct EncodedRevision {
    /// Its number.
    pub(crate) number: u64,
    /// A [`rafcon_protocol::api::Revision`] as JSON.
    pub(crate) text: String,
}

/// What there is from a cursor on.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum RevisionsPage {
    /// These, without a gap; none if the reader has seen everything. There may be more behind them.
    Revisions(Vec<Arc<EncodedRevision>>),
    /// The first of them are gone, or never were: get the whole machine, which is at this revision now.
    Reset(u64),
}

/// Revisions, the last one last.
#[derive(Debug)]
pub(super) struct Log {
    told: VecDeque<Arc<EncodedRevision>>,
    bytes: usize,
    /// The last one that there was, kept or not.
    last: u64,
}

impl Log {
    /// A log in which the next revision follows `last`.
    pub(super) fn after(last: u64) -> Self {
        Self { told: VecDeque::new(), bytes: 0, last }
    }

    /// Adds the next revision.
    pub(super) fn push(&mut self, told: Arc<EncodedRevision>) {
        self.bytes += told.text.len();
        self.last = told.number;
        self.told.push_back(told);
        while self.bytes > BYTES_MAX {
            let Some(oldest) = self.told.pop_front() else { break };
            self.bytes -= oldest.text.len();
        }
    }

    /// What a reader has not seen whose next revision is `from`.
    pub(super) fn since(&self, from: u64) -> RevisionsPage {
        let first = self.told.front().map_or(self.last + 1, |told| told.number);
        if from < first || from > self.last + 1 {
            return RevisionsPage::Reset(self.last);
        }
        let mut session = PAGE_BYTES;
        let seen = usize::try_from(from - first).unwrap_or(usize::MAX);
        let fits = |told: &&Arc<EncodedRevision>| {
            let is_room = session > 0;
            session = session.saturating_sub(told.text.len());
            is_room
        };
        RevisionsPage::Revisions(self.told.iter().skip(seen).take_while(fits).cloned().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::{BYTES_MAX, EncodedRevision, Log, PAGE_BYTES, RevisionsPage};
    use std::sync::Arc;

    fn log(sizes: &[usize]) -> Log {
        let mut log = Log::after(10);
        for (number, size) in (11..).zip(sizes) {
            log.push(Arc::new(EncodedRevision { number, text: "x".repeat(*size) }));
        }
        log
    }

    fn page(log: &Log, from: u64) -> String {
        match log.since(from) {
            RevisionsPage::Reset(now) => format!("reset to {now}"),
            RevisionsPage::Revisions(told) => {
                told.iter().map(|told| told.number.to_string()).collect::<Vec<_>>().join(" ")
            }
        }
    }

    #[test]
    fn a_reader_goes_on_from_its_cursor() {
        let pages: Vec<_> = (10..16).map(|from| page(&log(&[1, 1, 1]), from)).collect();
        assert_eq!(pages, ["reset to 13", "11 12 13", "12 13", "13", "", "reset to 13"]);
        assert_eq!([page(&log(&[]), 11), page(&log(&[]), 12)], ["", "reset to 10"]);
    }

    #[test]
    fn pages_and_memory_are_bounded() {
        assert_eq!(page(&log(&[PAGE_BYTES, 1, 1]), 11), "11");
        let full = log(&[BYTES_MAX / 2, BYTES_MAX / 2, 2]);
        assert_eq!([page(&full, 11), page(&full, 12)], ["reset to 13", "12"]);
        assert_eq!(page(&log(&[1, BYTES_MAX + 1]), 12), "reset to 12");
    }
}
