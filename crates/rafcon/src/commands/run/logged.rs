//! What the states that a dead runner left active had logged last. Knows the run's journal; a journal that cannot be read has
//! nothing to say here.

use rafcon_storage::journal::{Reader, Record};
use std::collections::BTreeMap;
use std::path::Path;

/// So many of the last events are looked through.
const EVENTS: u64 = 5000;

/// The last line of each of these states that logged any, by path.
pub(super) fn last(folder: &Path, active: &[String]) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let Ok(mut reader) = Reader::open(folder) else { return found };
    let first = reader.last_sequence().unwrap_or_default().saturating_sub(EVENTS) + 1;
    let events = reader.page(first, usize::try_from(EVENTS).unwrap_or_default());
    for entry in events.unwrap_or_default() {
        let Record::Log { place: Some(place), message, .. } = entry.record else { continue };
        let Some(place) = reader.known_places().get(place) else { continue };
        if active.contains(&place.path) {
            found.insert(place.path.clone(), message);
        }
    }
    found
}
