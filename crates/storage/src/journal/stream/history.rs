//! What the numbers of places stood for, at each moment of a run.

use crate::journal::record::{Place, PlaceNumber};
use std::sync::Arc;

/// The definitions of each place, with the number of the first event that they hold for.
type Definitions = Vec<(u64, Arc<Place>)>;

/// All definitions of all places.
#[derive(Debug, Clone, Default)]
pub struct PlaceHistory {
    places: Vec<Definitions>,
}

/// No run has more places: a number above is an error of its sender.
const PLACES_MAX: usize = 4 << 20;

impl PlaceHistory {
    /// From event `from` on, the number stands for `place`. It may be said again, in any order.
    pub fn define(&mut self, from: u64, number: PlaceNumber, place: Arc<Place>) {
        let index = number.0 as usize;
        if index >= PLACES_MAX {
            return;
        }
        if self.places.len() <= index {
            self.places.resize_with(index + 1, Vec::new);
        }
        let known = &mut self.places[index];
        let at = known.partition_point(|(first, _)| *first <= from);
        match at.checked_sub(1).and_then(|before| known.get_mut(before)) {
            Some((first, there)) if *first == from => *there = place,
            Some((_, there)) if *there == place => {}
            _ => known.insert(at, (from, place)),
        }
    }

    /// What the number stands for in event `sequence`.
    pub fn at(&self, number: PlaceNumber, sequence: u64) -> Option<&Arc<Place>> {
        let definitions = self.places.get(number.0 as usize)?;
        let after = definitions.partition_point(|(from, _)| *from <= sequence);
        Some(&definitions.get(after.checked_sub(1)?)?.1)
    }

    /// The latest definition of each place, by number; none of numbers that are free.
    pub fn latest(&self) -> impl ExactSizeIterator<Item = (PlaceNumber, Option<&Arc<Place>>)> {
        let latest = self.places.iter().map(|known| known.last().map(|(_, place)| place));
        latest
            .enumerate()
            .map(|(number, place)| (PlaceNumber(u32::try_from(number).unwrap_or(u32::MAX)), place))
    }

    /// All definitions, each with the first event that it holds for, by number.
    pub fn all(&self) -> impl Iterator<Item = (PlaceNumber, u64, &Arc<Place>)> {
        (0..).map(PlaceNumber).zip(&self.places).flat_map(|(number, known)| {
            known.iter().map(move |(from, place)| (number, *from, place))
        })
    }
}
