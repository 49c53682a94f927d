//! A moment for readers: active states with their data by port, ready to be shown or restored.
//!
//! Knows names of places. Does not know how steps are kept.

use super::inside::End;
use super::{Active, Moment, Whole};
use crate::journal::record::{Kept, Place, PlaceNumber, Places};
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::sync::Arc;

/// One active state. Orders are numbers of records: of two values for one target, the value with the higher order is newer.
#[derive(Debug, Clone, PartialEq)]
pub struct ActiveStateData {
    /// Its place.
    pub place: Arc<Place>,
    /// Index of its parent in the same list; `None` for the root.
    pub parent: Option<usize>,
    /// The number of the record of its entry.
    pub order: u64,
    /// When it was entered, in ns since the start of the run.
    pub since_ns: u64,
    /// Whether a command or a deadline preempted it or a container of it. Races and a stop do not count.
    pub asked: bool,
    /// Its inputs by port id. Empty if values were not kept.
    pub inputs: Vec<(u64, Kept)>,
    /// Whether it has inputs that were not kept.
    pub lacks_inputs: bool,
    /// The scoped variables of a container.
    pub scoped: Vec<ScopedValue>,
    /// The last end of each child, in the order of the ends.
    pub ended: Vec<ChildEnd>,
    /// The child that ended last.
    pub last: Option<SmolStr>,
}

/// A scoped variable.
#[derive(Debug, Clone, PartialEq)]
pub struct ScopedValue {
    /// Its id.
    pub port: u64,
    /// Its value.
    pub value: Kept,
    /// The number of the record.
    pub order: u64,
}

/// How a child ended.
#[derive(Debug, Clone, PartialEq)]
pub struct ChildEnd {
    /// The place of the child.
    pub place: Arc<Place>,
    /// Its outcome.
    pub outcome: i64,
    /// Its outputs by port id, without those that its script left out.
    pub outputs: Vec<(u64, Kept)>,
    /// Whether it has outputs that were not kept.
    pub lacks_outputs: bool,
    /// Its error, if it left one.
    pub error: Option<Kept>,
    /// The number of the record.
    pub order: u64,
}

impl ActiveStateData {
    /// Its id: the last part of its path.
    pub fn state(&self) -> &str {
        last_of(&self.place.path)
    }
}

impl ChildEnd {
    /// Its id: the last part of its path.
    pub fn state(&self) -> &str {
        last_of(&self.place.path)
    }
}

impl Moment {
    /// The number of the last record.
    pub fn sequence(&self) -> u64 {
        self.sequence
    }

    /// Its time, in ns since the start of the run.
    pub fn t_ns(&self) -> u64 {
        self.t_ns
    }

    /// States run so far; library states are not counted.
    pub fn states_run(&self) -> u64 {
        self.states_run
    }

    /// Entries so far, including undone ones and those that undo others.
    pub fn entries(&self) -> u64 {
        self.entries
    }

    /// What the moment says about the whole run.
    pub fn whole(&self) -> &Whole {
        &self.whole
    }

    /// The places defined so far.
    pub fn places(&self) -> &Places {
        &self.places
    }

    /// Global variables by name.
    pub fn globals(&self) -> &BTreeMap<SmolStr, Kept> {
        &self.globals
    }

    /// Persistent values of states.
    pub fn persistent(&self) -> impl Iterator<Item = (&Arc<Place>, &Kept)> {
        let known = |(place, kept)| Some((self.places.get(place)?, kept));
        self.persistent.iter().map(|(place, kept)| (*place, kept)).filter_map(known)
    }

    /// The active states, each after its parent; siblings in the order of their entries.
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

/// The kept values, each with its port.
fn by_port(ports: &[(u64, SmolStr)], values: &[Kept]) -> Vec<(u64, Kept)> {
    let there = ports.iter().zip(values).filter(|(_, value)| **value != Kept::Absent);
    there.map(|((port, _), value)| (*port, value.clone())).collect()
}

/// Pushes states on a stack, the first entered on top.
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
