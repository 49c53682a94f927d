//! Selects events of a run. Handles records and their names, not their display.

use super::{Entry, damaged};
use crate::journal::record::{Place, PlaceNumber, Places, Record};
use rafcon_protocol::{Event, LogLevel};
use std::collections::BTreeMap;

/// Conditions of a search. By default every event matches.
#[derive(Debug, Clone, Default)]
pub struct Filter {
    /// Text in the state's path of ids or names. With `*` or `?`, a pattern for the whole path.
    pub state: Option<String>,
    /// Outcome of a state's end, by name or id.
    pub outcome: Option<String>,
    /// Text in the event, in any case.
    pub text: Option<String>,
    /// Kinds of events by their names in the protocol. Empty for all.
    pub kinds: Vec<String>,
    /// Lowest severity of log lines. Other events are not affected.
    pub level: Option<LogLevel>,
    /// Earliest time, in ns since the start of the run.
    pub from_ns: Option<u64>,
    /// Latest time, in ns since the start of the run.
    pub to_ns: Option<u64>,
}

/// A filter that is applied to one run.
#[derive(Debug)]
pub struct FilterState<'f> {
    filter: &'f Filter,
    text: Option<String>,
    states: BTreeMap<PlaceNumber, bool>,
}

impl Filter {
    /// Prepares the filter for one run.
    pub fn sieve(&self) -> FilterState<'_> {
        let text = self.text.as_ref().map(|text| text.to_lowercase());
        FilterState { filter: self, text, states: BTreeMap::new() }
    }

    /// Returns true if no event after this time matches.
    pub fn is_past(&self, t_ns: u64) -> bool {
        self.to_ns.is_some_and(|to| t_ns > to)
    }

    fn wants_path(&self, path: &str, names: &str) -> bool {
        self.state.as_ref().is_none_or(|pattern| fits(pattern, path) || fits(pattern, names))
    }
}

impl FilterState<'_> {
    /// Returns true if the event may match. Its values are not examined.
    pub fn lets_through(&mut self, entry: &Entry, places: &Places) -> bool {
        let filter = self.filter;
        // A damaged range may contain matching events.
        if damaged(&entry.record).is_some() {
            return true;
        }
        filter.from_ns.is_none_or(|from| entry.t_ns >= from)
            && !filter.is_past(entry.t_ns)
            && (filter.kinds.is_empty() || filter.kinds.iter().any(|k| k == kind(&entry.record)))
            && matters(filter.level, &entry.record)
            && self.fits_outcome(&entry.record, places)
            && self.fits_state(&entry.record, places)
    }

    /// Returns true if the state's names or any text of the event contain the filter's text.
    pub fn has_text(&self, event: &Event, names: &str) -> bool {
        let Some(wanted) = &self.text else { return true };
        if matches!(event, Event::Damaged { .. }) {
            return true;
        }
        let said = serde_json::to_string(event).unwrap_or_default();
        said.to_lowercase().contains(wanted) || names.to_lowercase().contains(wanted)
    }

    fn fits_outcome(&self, record: &Record, places: &Places) -> bool {
        let Some(wanted) = &self.filter.outcome else { return true };
        match record {
            Record::Left { place, outcome, .. } => {
                let place = places.get(*place);
                outcome.to_string() == *wanted || outcome_name(place, *outcome) == *wanted
            }
            Record::Told(event) => match &**event {
                Event::Finished { outcome, .. } | Event::Forced { outcome, .. } => {
                    outcome.name == *wanted || outcome.id.to_string() == *wanted
                }
                _ => false,
            },
            _ => false,
        }
    }

    fn fits_state(&mut self, record: &Record, places: &Places) -> bool {
        if self.filter.state.is_none() {
            return true;
        }
        if let Some(number) = place_of(record) {
            let filter = self.filter;
            let place = || places.get(number);
            let fits = || place().is_some_and(|place| filter.wants_path(&place.path, &place.names));
            return *self.states.entry(number).or_insert_with(fits);
        }
        let Record::Told(event) = record else { return false };
        let path = path_of(event);
        let names = places.number(path).and_then(|number| places.get(number));
        !path.is_empty() && self.filter.wants_path(path, names.map_or("", |place| &place.names))
    }
}

fn matters(least: Option<LogLevel>, record: &Record) -> bool {
    match (least, record) {
        (Some(least), Record::Log { level, .. }) => *level >= least,
        _ => true,
    }
}

fn outcome_name(place: Option<&std::sync::Arc<Place>>, id: i64) -> String {
    super::outcome_of(place.map(|place| &**place), id).name
}

/// Returns the place in a record.
pub fn place_of(record: &Record) -> Option<PlaceNumber> {
    match record {
        Record::Entered { place, .. }
        | Record::Left { place, .. }
        | Record::Scoped { place, .. }
        | Record::Persistent { place, .. } => Some(*place),
        Record::Log { place, .. } => *place,
        Record::Global { .. } | Record::WentBack { .. } | Record::Told(_) => None,
    }
}

/// Returns the path in an event. Empty if it has none.
pub fn path_of(event: &Event) -> &str {
    match event {
        Event::Entered { path, .. }
        | Event::Left { path, .. }
        | Event::Scoped { path, .. }
        | Event::Persistent { path, .. }
        | Event::Held { path, .. }
        | Event::Hit { path, .. }
        | Event::Forced { path, .. }
        | Event::Dropped { path }
        | Event::ChangeWaits { path, .. }
        | Event::DeadlinePassed { path, .. }
        | Event::LossRecovery { path, .. }
        | Event::CutOff { path, .. }
        | Event::Log { path, .. }
        | Event::Waiting { path, .. } => path,
        Event::BreakpointSet { breakpoint } => &breakpoint.path,
        Event::Asked { question } => &question.path,
        _ => "",
    }
}

/// Returns the protocol's name of a record's kind.
pub fn kind(record: &Record) -> &'static str {
    match record {
        Record::Entered { .. } => "entered",
        Record::Left { .. } => "left",
        Record::Scoped { .. } => "scoped",
        Record::Global { .. } => "global",
        Record::Persistent { .. } => "persistent",
        Record::Log { .. } => "log",
        Record::WentBack { .. } => "went_back",
        Record::Told(event) => kind_of(event),
    }
}

/// All kinds of events.
pub const KINDS: [&str; 29] = [
    "entered",
    "left",
    "scoped",
    "global",
    "persistent",
    "held",
    "hit",
    "breakpoint_set",
    "breakpoint_removed",
    "forced",
    "dropped",
    "root",
    "change_waits",
    "commanded",
    "asked",
    "closed",
    "deadline_passed",
    "silence",
    "loss_recovery",
    "cut_off",
    "resumed",
    "went_back",
    "thinned",
    "damaged",
    "log",
    "waiting",
    "paused",
    "stopping",
    "finished",
];

/// Returns the protocol's name of an event's kind.
pub fn kind_of(event: &Event) -> &'static str {
    match event {
        Event::Entered { .. } => "entered",
        Event::Left { .. } => "left",
        Event::Scoped { .. } => "scoped",
        Event::Global { .. } => "global",
        Event::Persistent { .. } => "persistent",
        Event::Held { .. } => "held",
        Event::Hit { .. } => "hit",
        Event::BreakpointSet { .. } => "breakpoint_set",
        Event::BreakpointRemoved { .. } => "breakpoint_removed",
        Event::Forced { .. } => "forced",
        Event::Dropped { .. } => "dropped",
        Event::Root { .. } => "root",
        Event::ChangeWaits { .. } => "change_waits",
        Event::Commanded { .. } => "commanded",
        Event::Asked { .. } => "asked",
        Event::Closed { .. } => "closed",
        Event::DeadlinePassed { .. } => "deadline_passed",
        Event::Silence { .. } => "silence",
        Event::LossRecovery { .. } => "loss_recovery",
        Event::CutOff { .. } => "cut_off",
        Event::Resumed { .. } => "resumed",
        Event::WentBack { .. } => "went_back",
        Event::Thinned { .. } => "thinned",
        Event::Damaged { .. } => "damaged",
        Event::Log { .. } => "log",
        Event::Waiting { .. } => "waiting",
        Event::Paused { .. } => "paused",
        Event::Stopping => "stopping",
        Event::Finished { .. } => "finished",
    }
}

/// Returns true if a pattern matches a part of the text, or with `*` and `?` the whole text.
fn fits(pattern: &str, text: &str) -> bool {
    let (pattern, text) = (pattern.to_lowercase(), text.to_lowercase());
    if !pattern.contains(['*', '?']) {
        return text.contains(&pattern);
    }
    let (pattern, text): (Vec<char>, Vec<char>) =
        (pattern.chars().collect(), text.chars().collect());
    // `again`: the position for the next attempt if the pattern after the last star does not match.
    let (mut at, mut read, mut again) = (0, 0, None);
    while read < text.len() {
        match pattern.get(at) {
            Some('*') => {
                at += 1;
                again = Some((at, read));
            }
            Some(c) if *c == '?' || *c == text[read] => (at, read) = (at + 1, read + 1),
            _ => {
                let Some((after, from)) = again else { return false };
                (at, read, again) = (after, from + 1, Some((after, from + 1)));
            }
        }
    }
    pattern[at..].iter().all(|c| *c == '*')
}

#[cfg(test)]
mod tests {
    use super::fits;

    fn check(pattern: &str, text: &str, expected: bool) {
        assert_eq!(fits(pattern, text), expected, "{pattern} {text}");
    }

    #[test]
    fn a_pattern_is_a_part_or_a_whole() {
        check("scan", "Mission/Scan room", true);
        check("scan*", "Mission/Scan room", false);
        check("*scan*", "Mission/Scan room", true);
        check("mission/*/look", "Mission/Search/Look", true);
        check("m?ssion", "Mission", true);
        check("*o*o?", "Mission/Scan room", true);
        check("*x", "Mission", false);
        check("", "", true);
    }
}
