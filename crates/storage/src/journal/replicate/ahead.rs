//! Events that are read in one group and returned in parts, because positioning in a journal costs more than continuing to read.

use rafcon_events::EventBlock;

/// Approximate number of bytes that are read ahead.
pub(super) const AHEAD_BYTES: usize = 32 << 10;

/// Consecutive events, and the end of each.
#[derive(Debug)]
pub(super) struct Ahead {
    block: EventBlock,
    /// End of each event's items, and its time in ns since the start of the run.
    ends: Vec<(usize, u64)>,
}

impl Ahead {
    pub(super) fn new(block: EventBlock, ends: Vec<(usize, u64)>) -> Self {
        Self { block, ends }
    }

    /// Returns events from `first` to at most `last`, and at most `bytes_max` bytes unless a single event is longer. `None` if
    /// `first` is not in the group, or if more events than the group has would fit.
    pub(super) fn part(&self, first: u64, last: u64, bytes_max: usize) -> Option<EventBlock> {
        let skip = usize::try_from(first.checked_sub(self.block.first_sequence)?).ok()?;
        let before = |index: usize| self.ends.get(index.checked_sub(1)?).copied();
        let (begin, time_before) = before(skip).unwrap_or((0, self.block.time_before));
        let wanted = usize::try_from(last.checked_sub(first)?).ok()?.saturating_add(1);
        let rest = self.ends.get(skip..)?;
        let fit = rest.iter().take_while(|(end, _)| end - begin <= bytes_max).count();
        if rest.is_empty() || fit == rest.len() && wanted > fit {
            return None;
        }
        let count = fit.min(wanted).max(1);
        let (end, _) = before(skip + count)?;
        let bytes = self.block.bytes.get(begin..end)?.to_vec();
        Some(EventBlock { first_sequence: first, count: count as u64, time_before, bytes })
    }
}
