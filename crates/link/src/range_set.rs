//! Which numbers of a stream something is true of, as ranges.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// A set of numbers, kept as ranges that neither overlap nor touch.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RangeSet {
    /// The last number of each range, by its first.
    ranges: BTreeMap<u64, u64>,
}

impl RangeSet {
    /// All numbers from 1 to `last`. The set is empty if `last` is 0.
    pub fn up_to(last: u64) -> Self {
        let mut set = Self::default();
        if last > 0 {
            set.insert(1..=last);
        }
        set
    }

    /// Adds a range; an empty one changes nothing.
    pub fn insert(&mut self, range: RangeInclusive<u64>) {
        let (mut first, mut last) = range.into_inner();
        if first > last {
            return;
        }
        if let Some((before, end)) = self.ranges.range(..=first).next_back()
            && end.saturating_add(1) >= first
        {
            (first, last) = (*before, last.max(*end));
        }
        while let Some((next, end)) = self.ranges.range(first..).next()
            && *next <= last.saturating_add(1)
        {
            let (next, end) = (*next, *end);
            last = last.max(end);
            self.ranges.remove(&next);
        }
        self.ranges.insert(first, last);
    }

    /// Takes a range out.
    pub fn remove(&mut self, range: RangeInclusive<u64>) {
        let (first, last) = range.into_inner();
        while let Some((start, end)) = self.ranges.range(..=last).next_back()
            && first <= last
            && *end >= first
        {
            let (start, end) = (*start, *end);
            self.ranges.remove(&start);
            if start < first {
                self.ranges.insert(start, first - 1);
            }
            if end > last {
                self.ranges.insert(last + 1, end);
            }
            if start <= first {
                return;
            }
        }
    }

    /// True if the set contains the whole range.
    pub fn contains(&self, range: &RangeInclusive<u64>) -> bool {
        let before = self.ranges.range(..=*range.start()).next_back();
        range.is_empty() || before.is_some_and(|(_, last)| last >= range.end())
    }

    /// The last number of the range that begins at 1; 0 without one.
    pub fn contiguous(&self) -> u64 {
        self.ranges.get(&1).copied().unwrap_or(0)
    }

    /// The first range of numbers from `from` to `to` that are in neither set.
    pub fn first_gap(&self, other: &Self, from: u64, to: u64) -> Option<RangeInclusive<u64>> {
        let mut first = from;
        while first <= to {
            let Some(last) = self.end_at(first).max(other.end_at(first)) else {
                let next = [self, other].map(|set| set.ranges.range(first..).next());
                let next = next.into_iter().flatten().map(|(next, _)| *next).min();
                return Some(first..=next.map_or(to, |next| to.min(next - 1)));
            };
            first = last.checked_add(1)?;
        }
        None
    }

    /// The last number of the range that has this one.
    pub fn end_at(&self, number: u64) -> Option<u64> {
        let (_, last) = self.ranges.range(..=number).next_back()?;
        (*last >= number).then_some(*last)
    }

    /// Count of all numbers in the set.
    pub fn count(&self) -> u64 {
        self.ranges().map(|range| range.end() - range.start() + 1).sum()
    }

    /// Count of separate ranges.
    pub fn ranges_count(&self) -> usize {
        self.ranges.len()
    }

    /// Its ranges, in order.
    pub fn ranges(&self) -> impl DoubleEndedIterator<Item = RangeInclusive<u64>> {
        self.ranges.iter().map(|(first, last)| *first..=*last)
    }
}

impl FromIterator<RangeInclusive<u64>> for RangeSet {
    fn from_iter<I: IntoIterator<Item = RangeInclusive<u64>>>(ranges: I) -> Self {
        let mut set = Self::default();
        ranges.into_iter().for_each(|range| set.insert(range));
        set
    }
}

#[cfg(test)]
mod tests {
    use super::RangeSet;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #[test]
        fn a_set_of_ranges_is_the_set_of_their_numbers(
            ranges in prop::collection::vec((1..40_u64, 0..12_u64), 0..20),
            others in prop::collection::vec((1..40_u64, 0..12_u64), 0..6),
            (taken, length) in (1..40_u64, 0..12_u64),
        ) {
            let build = |ranges: &[(u64, u64)]| {
                let (mut set, mut numbers) = (RangeSet::default(), BTreeSet::new());
                for (first, length) in ranges {
                    set.insert(*first..=first + length - 1);
                    numbers.extend(*first..first + length);
                }
                (set, numbers)
            };
            let ((set, numbers), (other, other_numbers)) = (build(&ranges), build(&others));
            let listed: BTreeSet<u64> = set.ranges().flatten().collect();
            prop_assert_eq!(&listed, &numbers);
            let ends: Vec<_> = set.ranges().collect();
            prop_assert!(ends.windows(2).all(|pair| pair[0].end() + 1 < *pair[1].start()));
            prop_assert_eq!(set.contiguous(), (1..60).take_while(|n| numbers.contains(n)).last().unwrap_or(0));
            let (mut rest, mut rest_numbers) = (set.clone(), numbers.clone());
            rest.remove(taken..=taken + length - 1);
            rest_numbers.retain(|number| !(taken..taken + length).contains(number));
            prop_assert_eq!(rest.ranges().flatten().collect::<BTreeSet<u64>>(), rest_numbers);
            for first in 1..45 {
                let missing = |n: &u64| !numbers.contains(n) && !other_numbers.contains(n);
                let start = (first..=50).find(missing);
                let gap = start.map(|start| start..=(start..=50).take_while(missing).last().unwrap());
                prop_assert_eq!(set.first_gap(&other, first, 50), gap);
                prop_assert_eq!(set.contains(&(first..=first + 3)), (first..=first + 3).all(|n| numbers.contains(&n)));
            }
        }
    }
}
