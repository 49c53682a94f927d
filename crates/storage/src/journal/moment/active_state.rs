//! A moment for readers: active states with their data by port, ready to be displayed or restored.
//!
//! Uses the names of places. Does not depend on the storage of steps.

use super::inside::End;
use super::{Active, Moment, Whole};
use crate::journal::record::{Kept, Place, PlaceNumber, Places};
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::sync::Arc;

/// An active state at a moment. Orders are numbers of records: of two values for one target, the value with the higher order is
/// newer.
#[derive(Debug, Clone, PartialEq)]
pub struct ActiveStateData {
    /// Place of the state.
    pub place: Arc<Place>,
    /// Index of the parent in this list. `None` for the root.
    pub parent: Option<usize>,
    /// Number of the record of its entry.
    pub order: u64,
    /// Entry time, in ns since the start of the run.
    pub since_ns: u64,
    /// True if a command or a deadline preempted it or one of its containers. Races and a stop do not count.
    pub asked: bool,
    /// Inputs by port id. Empty if values were not recorded.
    pub inputs: Vec<(u64, Kept)>,
    /// True if it has inputs that were not recorded.
    pub lacks_inputs: bool,
    /// Scoped variables of a container.
    pub scoped: Vec<ScopedValue>,
    /// Last end of each child, sorted by time.
    pub ended: Vec<ChildEnd>,
    /// Child that ended last.
    pub last: Option<SmolStr>,
}

/// A scoped variable at a moment.
#[derive(Debug, Clone, PartialEq)]
pub struct ScopedValue {
    /// Id of the variable.
    pub port: u64,
    /// Value of the variable.
    pub value: Kept,
    /// Number of the record that set it.
    pub order: u64,
}

/// The end of a child.
#[derive(Debug, Clone, PartialEq)]
pub struct ChildEnd {
    /// Place of the child.
    pub place: Arc<Place>,
    /// Outcome of the child.
    pub outcome: i64,
    /// Outputs by port id, without those that the script left out.
    pub outputs: Vec<(u64, Kept)>,
    /// True if it has outputs that were not recorded.
    pub lacks_outputs: bool,
    /// Error of the child, if it has one.
    pub error: Option<Kept>,
    /// Number of the record of its end.
    pub order: u64,
}

impl ActiveStateData {
    /// Returns the id of the state: the last part of its path.
    pub fn state(&self) -> &str {
        last_of(&self.place.path)
    }
}

impl ChildEnd {
    /// Returns the id of the child: the last part of its path.
    pub fn state(&self) -> &str {
        last_of(&self.place.path)
    }
}

impl Moment {
    /// Returns the number of the last record.
    pub fn sequence(&self) -> u64 {
        self.sequence
    }

    /// Returns the time of the last record, in ns since the start of the run.
    pub fn t_ns(&self) -> u64 {
        self.t_ns
    }

    /// Returns the number of states executed, without library states.
    pub fn states_run(&self) -> u64 {
        self.states_run
    }

    /// Returns the number of entries, including undone ones and those that undo others.
    pub fn entries(&self) -> u64 {
        self.entries
    }

    /// Returns the part of the moment that concerns the whole run.
    pub fn whole(&self) -> &Whole {
        &self.whole
    }

    /// Returns the places that are defined at this moment.
    pub fn places(&self) -> &Places {
        &self.places
    }

    /// Returns the global variables by name.
    pub fn globals(&self) -> &BTreeMap<SmolStr, Kept> {
        &self.globals
    }

    /// Returns the persistent data of states.
    pub fn persistent(&self) -> impl Iterator<Item = (&Arc<Place>, &Kept)> {
        let known = |(place, kept)| Some((self.places.get(place)?, kept));
        self.persistent.iter().map(|(place, kept)| (*place, kept)).filter_map(known)
    }

    /// Returns the active states, each after its parent; siblings in the order of their entries.
    pub fn active(&self) -> Vec<ActiveStateData> {
        let mut below: BTreeMap<Option<PlaceNumber>, Vec<(PlaceNumber, &Active)>> = BTreeMap::new();
        for (place, active) in &self.active {
            below.entry(self.places.parent(*place)).or_default().push((*place, active));
        }
        let mut list: Vec<ActiveStateData> = Vec::new();
        let mut next: Vec<(Option<usize>, PlaceNumber, &Active)> = Vec::new();
        push_sorted(&mut next, None, below.remove(&None));
        while let Some((parent, place, active)) = next.pop() {
            let index = list.len();
            list.extend(self.standing(place, parent, active));
            if list.len() > index {
                push_sorted(&mut next, Some(index), below.remove(&Some(place)));
            }
        }
        list
    }

    fn standing(
        &self,
        number: PlaceNumber,
        parent: Option<usize>,
        it: &Active,
    ) -> Option<ActiveStateData> {
        let place = Arc::clone(self.places.get(number)?);
        let mut ended: Vec<ChildEnd> =
            it.inside.ended().into_values().filter_map(|end| self.ended(end)).collect();
        ended.sort_by_key(|end| end.order);
        let variable = |(port, v): (u64, &super::inside::ValueAt)| ScopedValue {
            port,
            value: v.value.clone(),
            order: v.order,
        };
        Some(ActiveStateData {
            parent,
            order: it.order,
            since_ns: it.t_ns,
            asked: it.asked,
            inputs: by_port(&place.inputs, &it.inputs),
            lacks_inputs: it.inputs.len() < place.inputs.len(),
            scoped: it.inside.scoped().into_iter().map(variable).collect(),
            ended,
            last: it.inside.last().map(|last| last_of(self.places.path(last)).into()),
            place,
        })
    }

    fn ended(&self, end: &End) -> Option<ChildEnd> {
        let place = Arc::clone(self.places.get(end.place)?);
        Some(ChildEnd {
            outcome: end.outcome,
            outputs: by_port(&place.outputs, &end.outputs),
            lacks_outputs: end.outputs.len() < place.outputs.len(),
            error: end.error.clone(),
            order: end.order,
            place,
        })
    }
}

/// Returns the recorded values, each with its port.
fn by_port(ports: &[(u64, SmolStr)], values: &[Kept]) -> Vec<(u64, Kept)> {
    let there = ports.iter().zip(values).filter(|(_, value)| **value != Kept::Absent);
    there.map(|((port, _), value)| (*port, value.clone())).collect()
}

/// Pushes states on a stack, the first entered one on top.
fn push_sorted<'a>(
    stack: &mut Vec<(Option<usize>, PlaceNumber, &'a Active)>,
    parent: Option<usize>,
    found: Option<Vec<(PlaceNumber, &'a Active)>>,
) {
    let mut found = found.unwrap_or_default();
    found.sort_by_key(|(_, active)| std::cmp::Reverse(active.order));
    stack.extend(found.into_iter().map(|(place, active)| (parent, place, active)));
}

fn last_of(path: &str) -> &str {
    path.rsplit_once('/').map_or(path, |(_, last)| last)
}
