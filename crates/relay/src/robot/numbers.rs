//! Numbers of the runs that were sent to one station. A number is a hash of 30 bits, so of 100,000 runs a few would share one: the second
//! run takes its next number. Both are remembered, also after the first run was deleted.

use crate::ids;
use rafcon_link::StreamId;
use std::collections::BTreeMap;

/// Capacity. Beyond it, a run takes its first number unseen.
const NUMBERS_MAX: usize = 1 << 20;
/// Bytes of an entry: a number and its check.
const ENTRY: usize = 8;

/// The numbers, kept in a file.
#[derive(Debug)]
pub(super) struct RunNumbers {
    taken: BTreeMap<StreamId, u32>,
    /// Entries that are not in the file.
    unsaved: Vec<u8>,
}

impl RunNumbers {
    /// Those in the content of the file.
    pub(super) fn read(bytes: &[u8]) -> Self {
        let entry = |entry: &[u8; ENTRY]| {
            let both = u64::from_be_bytes(*entry);
            let [stream, start] = [both >> 32, both & u64::from(u32::MAX)];
            let number = |half: u64| u32::try_from(half).unwrap_or_default();
            (StreamId(number(stream)), number(start))
        };
        let taken = bytes.as_chunks().0.iter().take(NUMBERS_MAX).map(entry).collect();
        Self { taken, unsaved: Vec::new() }
    }

    /// The stream for the events of the run with this id.
    pub(super) fn take(&mut self, run: &str) -> StreamId {
        let check = ids::check_of(run);
        let usable = |stream: &StreamId| self.taken.get(stream).is_none_or(|of| *of == check);
        let stream = ids::streams_of(run).find(usable).unwrap_or_else(|| ids::events_of(run));
        if self.taken.len() < NUMBERS_MAX && self.taken.insert(stream, check).is_none() {
            self.unsaved.extend(stream.0.to_be_bytes());
            self.unsaved.extend(check.to_be_bytes());
        }
        stream
    }

    /// Entries for the end of the file.
    pub(super) fn take_unsaved(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.unsaved)
    }

    /// The stream of a run that has one.
    pub(super) fn find(&self, run: &str) -> Option<StreamId> {
        let check = ids::check_of(run);
        ids::streams_of(run).find(|stream| self.taken.get(stream) == Some(&check))
    }
}

#[cfg(test)]
mod tests {
    use super::{ENTRY, NUMBERS_MAX, RunNumbers};
    use crate::ids;

    #[test]
    fn two_runs_never_share_a_number_also_after_a_restart() {
        let mut numbers = RunNumbers::read(&[]);
        let first = numbers.take("a");
        assert_eq!([first, numbers.take("a")], [ids::events_of("a"); 2]);
        // A second run with an equal hash.
        numbers.taken.insert(ids::events_of("b"), 0);
        let second = numbers.take("b");
        assert_eq!(Some(second), ids::streams_of("b").nth(1));
        let file = numbers.take_unsaved();
        assert_eq!((file.len(), numbers.take_unsaved()), (2 * ENTRY, vec![]));
        let mut numbers = RunNumbers::read(&file);
        numbers.taken.insert(ids::events_of("b"), 0);
        assert_eq!([numbers.take("b"), numbers.take("a")], [second, first]);
        assert_eq!((numbers.find("b"), numbers.find("c")), (Some(second), None));
    }

    #[test]
    fn beyond_the_bound_a_run_takes_its_first_number_and_is_not_remembered() {
        let most = u32::try_from(NUMBERS_MAX).unwrap();
        let entry = |number: u32| (u64::from(number) << 32).to_be_bytes();
        let mut numbers = RunNumbers::read(&(0..=most).flat_map(entry).collect::<Vec<_>>());
        assert_eq!(numbers.taken.len(), NUMBERS_MAX);
        assert_eq!(numbers.take("a"), ids::events_of("a"));
        assert_eq!((numbers.taken.len(), numbers.take_unsaved()), (NUMBERS_MAX, vec![]));
        // With room it is remembered again.
        numbers.taken.pop_first();
        numbers.take("a");
        assert_eq!(numbers.find("a"), Some(ids::events_of("a")));
        assert_eq!(numbers.take_unsaved().len(), ENTRY);
    }
}
