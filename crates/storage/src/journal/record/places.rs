//! Places that a journal names, by number and by path. Stores their definitions only.

use super::{Place, PlaceNumber};
use rafcon_model::ids::DECIDER_ID;
use std::collections::BTreeMap;
use std::sync::Arc;

/// All places that have been defined, each by its latest definition.
#[derive(Debug, Clone, Default)]
pub struct Places {
    places: BTreeMap<PlaceNumber, Known>,
    numbers: BTreeMap<String, PlaceNumber>,
}

#[derive(Debug, Clone)]
struct Known {
    place: Arc<Place>,
    parent: Option<PlaceNumber>,
    is_decider: bool,
}

impl Places {
    /// Defines `number` as `place` from here on.
    pub fn define(&mut self, number: PlaceNumber, place: Place) {
        let above = place.path.rsplit_once('/');
        let parent = above.and_then(|(parent, _)| self.number(parent));
        let is_decider = above.is_some_and(|(_, state)| state == DECIDER_ID);
        self.numbers.insert(place.path.clone(), number);
        self.places.insert(number, Known { place: Arc::new(place), parent, is_decider });
    }

    /// Returns the place with this number.
    pub fn get(&self, number: PlaceNumber) -> Option<&Arc<Place>> {
        Some(&self.places.get(&number)?.place)
    }

    /// Returns the number of the place with this path.
    pub fn number(&self, path: &str) -> Option<PlaceNumber> {
        self.numbers.get(path).copied()
    }

    /// Returns all places, sorted by number.
    pub fn iter(&self) -> impl Iterator<Item = (PlaceNumber, &Arc<Place>)> {
        self.places.iter().map(|(number, known)| (*number, &known.place))
    }

    /// Returns the parent of this place. The root has none.
    pub fn parent(&self, number: PlaceNumber) -> Option<PlaceNumber> {
        self.places.get(&number)?.parent
    }

    pub(in crate::journal) fn is_decider(&self, number: PlaceNumber) -> bool {
        self.places.get(&number).is_some_and(|known| known.is_decider)
    }

    /// Returns the path of a place. Empty if it was never defined.
    pub(in crate::journal) fn path(&self, number: PlaceNumber) -> &str {
        self.get(number).map_or("", |place| &place.path)
    }
}
