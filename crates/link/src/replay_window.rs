//! Which packet numbers of one generation were received: each counts once, and what is far behind the newest counts no more.

/// Size of the window, in numbers before the newest.
pub(crate) const WINDOW: u64 = 4096;
const WORD: u64 = 64;
const WORDS: usize = (WINDOW / WORD) as usize;

/// The numbers that were received, as far as they are remembered.
#[derive(Debug, Clone)]
pub(crate) struct ReplayWindow {
    /// Newest number. `None` before the first datagram.
    newest: Option<u64>,
    /// One bit for each number of the window, at its place modulo [`WINDOW`].
    seen: [u64; WORDS],
}

impl ReplayWindow {
    /// A window without any received number.
    pub(crate) fn new() -> Self {
        Self { newest: None, seen: [0; WORDS] }
    }

    /// After a restart of the receiver: everything up to this number counts as received.
    pub(crate) fn after(newest: u64) -> Self {
        Self { newest: Some(newest), seen: [u64::MAX; WORDS] }
    }

    pub(crate) fn newest(&self) -> Option<u64> {
        self.newest
    }

    /// True if the window accepts this number: not received, and not before the window.
    pub(crate) fn is_new(&self, number: u64) -> bool {
        match self.newest {
            Some(newest) if number <= newest => newest - number < WINDOW && !self.has(number),
            _ => true,
        }
    }

    /// Counts a number as received. Only for one that [`ReplayWindow::is_new`].
    pub(crate) fn receive(&mut self, number: u64) {
        let first_unknown = self.newest.map_or(0, |newest| newest + 1);
        if number >= first_unknown {
            if number - first_unknown >= WINDOW {
                self.seen = [0; WORDS];
            } else {
                (first_unknown..number).for_each(|between| self.set(between, false));
            }
            self.newest = Some(number);
        }
        self.set(number, true);
    }

    fn has(&self, number: u64) -> bool {
        let (word, bit) = place(number);
        self.seen[word] & bit != 0
    }

    fn set(&mut self, number: u64, is_seen: bool) {
        let (word, bit) = place(number);
        if is_seen {
            self.seen[word] |= bit;
        } else {
            self.seen[word] &= !bit;
        }
    }
}

/// The word of a number and its bit there.
fn place(number: u64) -> (usize, u64) {
    let at = number % WINDOW;
    let word = usize::try_from(at / WORD).unwrap_or_default();
    (word, 1 << (at % WORD))
}

#[cfg(test)]
mod tests {
    use super::{ReplayWindow, WINDOW};
    use proptest::collection::vec;
    use proptest::prelude::{prop_assert_eq, prop_oneof, proptest};
    use std::collections::BTreeSet;

    proptest! {
        /// Compared with a set of all numbers ever received.
        #[test]
        fn a_number_counts_once_and_not_when_it_is_far_behind(
            numbers in vec(prop_oneof![0_u64..200, 4000..4200_u64, 0..20_000_u64, 40_000..40_010_u64], 0..300),
        ) {
            let (mut window, mut all) = (ReplayWindow::new(), BTreeSet::new());
            for number in numbers {
                let newest = all.last().copied();
                let is_near = newest.is_none_or(|newest: u64| number + WINDOW > newest);
                let is_new = is_near && !all.contains(&number);
                prop_assert_eq!(window.is_new(number), is_new, "{}", number);
                if is_new {
                    window.receive(number);
                    all.insert(number);
                }
                prop_assert_eq!(window.newest(), all.last().copied());
            }
        }
    }

    #[test]
    fn after_a_restart_everything_before_counts_as_received() {
        let mut window = ReplayWindow::after(5000);
        assert_eq!(
            [0, 904, 905, 5000, 5001].map(|number| window.is_new(number)),
            [false, false, false, false, true]
        );
        window.receive(5003);
        assert_eq!(
            [5000, 5001, 5002, 5003].map(|number| window.is_new(number)),
            [false, true, true, false]
        );
    }
}
