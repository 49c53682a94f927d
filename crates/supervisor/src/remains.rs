//! What a dead runner left in the folder of its run: the marks of running scripts, and the journal. What cannot be read has
//! nothing to say here.

use rafcon_protocol::{Event, active};
use rafcon_storage::journal::{Reader, Record};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Duration;

/// So many of the last events are looked through for logs.
const EVENTS: u64 = 5000;

/// Paths of the states whose scripts ran when the runner of this folder ended. Better than its last messages: the marks were
/// made before each script began.
pub fn running(folder: &Path) -> Vec<String> {
    let slots = fs::read(folder.join(active::SLOTS_FILE)).unwrap_or_default();
    let paths = fs::read_to_string(folder.join(active::PATHS_FILE)).unwrap_or_default();
    active::running(&slots, &paths)
}

/// When and how the run in this folder ended, if its runner kept an end that it could not tell any more.
pub fn kept_end(folder: &Path) -> Option<(Duration, Event)> {
    let events = Reader::open(folder).ok()?.tail().ok()?;
    let end = events.into_iter().rev().find_map(|entry| match entry.record {
        Record::Told(event) => Some((Duration::from_nanos(entry.t_ns), *event)),
        _ => None,
    });
    end.filter(|(_, event)| matches!(event, Event::Finished { .. }))
}

/// The last line of each of these states that logged any, by path.
pub fn last_logged(folder: &Path, active: &[String]) -> BTreeMap<String, String> {
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
