//! Encodes moments as the shortest equivalent sequence of records, so that a reader need not start at the first event.
//!
//! Layout: version (u8), length of the header (u32, little-endian), header (JSON), items. In the time field, these items contain
//! the number of the record that they replace, counted from 0 for each. The places are those of the journal.

use super::inside::{End, Inside, Step};
use super::{Active, Moment, Whole};
use crate::journal::record::{Item, Items, Kept, PlaceNumber, Places, Record};
use serde::{Deserialize, Serialize};
use std::num::NonZeroU64;

const VERSION: u8 = 1;
/// Number of ended states that are encoded. To step back further, read from an earlier moment.
const STEPS_KEPT: usize = 500;
/// Replaces the number of any entry, because the place identifies the undone step.
const SOME_ENTRY: Option<NonZeroU64> = Some(NonZeroU64::MIN);

/// The bytes are not a moment, or have another version.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("not a moment of a journal: {0}")]
pub struct BadMoment(&'static str);

#[derive(Debug, Serialize, Deserialize)]
struct Header {
    sequence: u64,
    t_ns: u64,
    entries: u64,
    states_run: u64,
    /// Entry time of each active state, in the order of the entries.
    since_ns: Vec<u64>,
    /// Places of preempted states.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    asked: Vec<u32>,
    /// Places of containers in which a step was just undone.
    undone: Vec<u32>,
    whole: Whole,
}

impl Moment {
    /// Encodes the moment, with a limited number of steps for steps back.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.to_bytes_with_steps(STEPS_KEPT)
    }

    /// Encodes the moment, with at most `steps` steps for steps back.
    pub fn to_bytes_with_steps(&self, steps: usize) -> Vec<u8> {
        if self.steps() <= steps {
            return self.all_to_bytes();
        }
        let mut shorter = self.clone();
        shorter.settle(steps);
        shorter.all_to_bytes()
    }

    fn all_to_bytes(&self) -> Vec<u8> {
        let active = self.in_order();
        let header = Header {
            sequence: self.sequence,
            t_ns: self.t_ns,
            entries: self.entries,
            states_run: self.states_run,
            since_ns: active.iter().map(|(_, active)| active.t_ns).collect(),
            asked: self.asked().collect(),
            undone: self.undone().collect(),
            whole: self.whole.clone(),
        };
        let header = serde_json::to_vec(&header).unwrap_or_default();
        let mut out = vec![VERSION];
        out.extend_from_slice(&u32::try_from(header.len()).unwrap_or_default().to_le_bytes());
        out.extend_from_slice(&header);
        let mut items = MomentWriter { out };
        for (place, active) in active {
            items.active(place, active, self.is_reopened(place));
        }
        items.data(self);
        items.out
    }

    /// Decodes the bytes of [`Moment::to_bytes`], in a run with these places.
    pub fn from_bytes(bytes: &[u8], places: Places) -> Result<Self, BadMoment> {
        let (header, items) = split(bytes)?;
        let mut moment = Self::new(places);
        let mut items = Items::new(items, 0);
        while let Some(item) = items.next() {
            match item.map_err(|_broken| BadMoment("an item is broken"))? {
                Item::Record(order, record) => moment.apply(order, 0, &record),
                Item::Definition(definition) => moment.define(&definition),
            }
            items.count_from_zero();
        }
        moment.take_header(header);
        Ok(moment)
    }

    fn take_header(&mut self, header: Header) {
        let mut active: Vec<&mut Active> = self.active.values_mut().collect();
        active.sort_by_key(|active| active.order);
        for (active, since_ns) in active.into_iter().zip(&header.since_ns) {
            active.t_ns = *since_ns;
        }
        for place in header.asked {
            if let Some(active) = self.active.get_mut(&PlaceNumber(place)) {
                active.asked = true;
            }
        }
        for place in header.undone {
            if let Some(active) = self.active.get_mut(&PlaceNumber(place)) {
                active.inside.set_undone();
            }
        }
        (self.sequence, self.t_ns) = (header.sequence, header.t_ns);
        (self.entries, self.states_run) = (header.entries, header.states_run);
        (self.whole, self.lacks_steps) = (header.whole, false);
    }

    fn asked(&self) -> impl Iterator<Item = u32> {
        self.active.iter().filter(|(_, active)| active.asked).map(|(place, _)| place.0)
    }

    fn undone(&self) -> impl Iterator<Item = u32> {
        let undone = self.active.iter().filter(|(_, active)| active.inside.is_undone());
        undone.map(|(place, _)| place.0)
    }

    fn in_order(&self) -> Vec<(PlaceNumber, &Active)> {
        let mut active: Vec<_> = self.active.iter().map(|(place, it)| (*place, it)).collect();
        active.sort_by_key(|(_, active)| active.order);
        active
    }

    fn is_reopened(&self, place: PlaceNumber) -> bool {
        let around = self.places.parent(place).and_then(|parent| self.active.get(&parent));
        around.is_some_and(|around| around.inside.is_open(place))
    }
}

impl Record {
    /// Passes all values in the record to `see`.
    pub fn values(&self, see: &mut dyn FnMut(&Kept)) {
        match self {
            Self::Entered { inputs, .. } => inputs.iter().for_each(see),
            Self::Left { outputs, error, .. } => outputs.iter().chain(error).for_each(see),
            Self::Scoped { value, .. } | Self::Persistent { value, .. } => see(value),
            Self::Global { value, .. } => value.iter().for_each(see),
            // A damaged moment has no values.
            Self::WentBack { moment, .. } => drop(values_in(moment, see)),
            Self::Log { .. } | Self::Told(_) => {}
        }
    }
}

/// Passes all values in a moment to `see`.
pub(in crate::journal) fn values_in(
    moment: &[u8],
    see: &mut dyn FnMut(&Kept),
) -> Result<(), BadMoment> {
    let (_, items) = split(moment)?;
    for item in Items::new(items, 0) {
        match item.map_err(|_broken| BadMoment("an item is broken"))? {
            Item::Record(_, record) => record.values(see),
            Item::Definition(_) => {}
        }
    }
    Ok(())
}

/// Returns an encoded moment without its values.
pub(in crate::journal) fn without_values(moment: &[u8]) -> Result<Vec<u8>, BadMoment> {
    let (_, rest) = split(moment)?;
    let mut out = moment[..moment.len() - rest.len()].to_vec();
    let mut items = Items::new(rest, 0);
    while let Some(item) = items.next() {
        let mut item = item.map_err(|_broken| BadMoment("an item is broken"))?;
        if let Item::Record(_, record) = &mut item {
            record.forget_values();
        }
        item.write(&mut 0, &mut out);
        items.count_from_zero();
    }
    Ok(out)
}

fn split(bytes: &[u8]) -> Result<(Header, &[u8]), BadMoment> {
    let (version, rest) = bytes.split_first().ok_or(BadMoment("it is empty"))?;
    if *version != VERSION {
        return Err(BadMoment("it is of another version"));
    }
    let (length, rest) = rest.split_first_chunk().ok_or(BadMoment("it is cut off"))?;
    let length = usize::try_from(u32::from_le_bytes(*length)).unwrap_or(usize::MAX);
    let (header, items) = rest.split_at_checked(length).ok_or(BadMoment("it is cut off"))?;
    let header = serde_json::from_slice(header).map_err(|_bad| BadMoment("a bad header"))?;
    Ok((header, items))
}

/// Writer for the items of a moment.
struct MomentWriter {
    out: Vec<u8>,
}

impl MomentWriter {
    fn active(&mut self, place: PlaceNumber, active: &Active, reopened: bool) {
        let undoes = if reopened { SOME_ENTRY } else { None };
        let inputs = active.inputs.clone();
        self.record(active.order, Record::Entered { place, inputs, undoes });
        self.inside(place, &active.inside);
    }

    fn inside(&mut self, place: PlaceNumber, inside: &Inside) {
        for step in inside.all() {
            match step {
                Step::Scoped(port, variable) => {
                    let value = variable.value;
                    self.record(variable.order, Record::Scoped { place, port, value });
                }
                Step::End(end) => self.end(end),
            }
        }
    }

    fn end(&mut self, end: End) {
        let End { place, inputs, outcome, outputs, error, .. } = end;
        self.record(end.entered, Record::Entered { place, inputs, undoes: None });
        if let Some(inside) = &end.inside {
            self.inside(place, inside);
        }
        self.record(end.order, Record::Left { place, outcome, outputs, error, undoes: None });
    }

    fn data(&mut self, moment: &Moment) {
        for (name, value) in &moment.globals {
            let (name, value) = (name.clone(), Some(value.clone()));
            self.record(0, Record::Global { name, value });
        }
        for (place, value) in &moment.persistent {
            self.record(0, Record::Persistent { place: *place, value: value.clone() });
        }
        // The last item, because the next entry of the root would consume it.
        if let Some(restored) = &moment.restored {
            self.record(0, Record::WentBack { sequence: 0, moment: restored.clone() });
        }
    }

    fn record(&mut self, order: u64, record: Record) {
        Item::Record(order, record).write(&mut 0, &mut self.out);
    }
}
