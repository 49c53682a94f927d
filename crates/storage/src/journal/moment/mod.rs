//! State of a run after one of its events: active states and their data, variables, questions, held branches.
//!
//! Defines the effect of each record, not the source of records or the next actions of a machine.

mod active_state;
mod bytes;
mod inside;
mod tracker;
mod whole;

pub use active_state::{ActiveStateData, ChildEnd, ScopedValue};
pub use bytes::BadMoment;
pub(super) use bytes::{values_in, without_values};
pub(in crate::journal) use tracker::{Keyframe, Tracker};
pub use whole::{ANSWERS_MAX, GroundSilence, StopRequest, Whole};

use crate::journal::record::{Definition, Kept, PlaceNumber, Places, Record};
use inside::{End, Inside};
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::num::NonZeroU64;

/// Maximum number of ended states stored for steps back, more than any run steps back. If it is exceeded, half of them are dropped.
const STEPS_MAX: usize = 24_000;
/// Number of entries between two counts of the steps.
const COUNT_EVERY: u64 = 1024;

/// State of a run after one of its records. A new moment is the one before the first record.
#[derive(Debug, Clone, Default)]
pub struct Moment {
    places: Places,
    sequence: u64,
    t_ns: u64,
    entries: u64,
    states_run: u64,
    active: BTreeMap<PlaceNumber, Active>,
    globals: BTreeMap<SmolStr, Kept>,
    persistent: BTreeMap<PlaceNumber, Kept>,
    whole: Whole,
    lacks_steps: bool,
    /// Moment that the next entry of the root restores.
    restored: Option<Vec<u8>>,
}

#[derive(Debug, Clone)]
struct Active {
    inputs: Vec<Kept>,
    /// Number of the record of its entry.
    order: u64,
    t_ns: u64,
    /// True if a command or a deadline preempted it or one of its containers.
    asked: bool,
    inside: Inside,
}

impl Moment {
    /// Creates the moment before the first event of a run with these places.
    pub fn new(places: Places) -> Self {
        Self { places, ..Self::default() }
    }

    /// Applies the definition of a place. Definitions of values have no effect.
    pub fn define(&mut self, definition: &Definition) {
        match definition {
            Definition::Place(number, place) => self.places.define(*number, place.clone()),
            Definition::Value(..) => {}
        }
    }

    /// Applies a record with its number and time.
    pub fn apply(&mut self, sequence: u64, t_ns: u64, record: &Record) {
        (self.sequence, self.t_ns) = (sequence, t_ns);
        match record {
            Record::Entered { place, inputs, undoes } => self.enter(*place, inputs, *undoes),
            Record::Left { place, outcome, outputs, error, undoes } => {
                self.leave(
                    End {
                        place: *place,
                        entered: 0,
                        inputs: Vec::new(),
                        outcome: *outcome,
                        outputs: outputs.clone(),
                        error: error.clone(),
                        order: sequence,
                        inside: None,
                        is_open: false,
                    },
                    undoes.is_some(),
                );
            }
            Record::Scoped { place, port, value } => {
                if let Some(active) = self.active.get_mut(place) {
                    let value = inside::ValueAt { value: value.clone(), order: sequence };
                    active.inside.set(*port, value);
                }
            }
            Record::Global { name, value } => match value {
                Some(value) => drop(self.globals.insert(name.clone(), value.clone())),
                None => drop(self.globals.remove(name)),
            },
            Record::Persistent { place, value } => {
                self.persistent.insert(*place, value.clone());
            }
            Record::WentBack { moment, .. } => self.restored = Some(moment.clone()),
            Record::Log { .. } => {}
            Record::Told(event) => self.apply_event(event),
        }
    }

    fn enter(&mut self, place: PlaceNumber, inputs: &[Kept], undoes: Option<NonZeroU64>) {
        let parent = self.places.parent(place);
        if parent.is_none() {
            self.begin_restored();
        }
        self.count_entry();
        self.whole.entered(self.places.path(place));
        // Only a resumed run enters an active state again. The state's data is kept.
        if self.active.contains_key(&place) {
            return;
        }
        let is_library = self.places.get(place).is_some_and(|place| place.is_library);
        self.states_run += u64::from(undoes.is_none() && !is_library);
        let around = parent.and_then(|parent| self.active.get_mut(&parent));
        let (order, t_ns) = (self.sequence, self.t_ns);
        let (inputs, asked, inside) = (inputs.to_vec(), false, Inside::default());
        let mut active = Active { inputs, order, t_ns, asked, inside };
        if let Some(around) = around {
            around.inside.begin();
            if undoes.is_some() {
                match around.inside.reopen(place) {
                    Some(end) => {
                        active.order = end.entered;
                        active.inside = end.inside.map(|inside| *inside).unwrap_or_default();
                    }
                    None => self.lacks_steps = true,
                }
            }
        }
        self.active.insert(place, active);
    }

    fn leave(&mut self, mut end: End, backwards: bool) {
        self.whole.left(self.places.path(end.place));
        let Some(mut active) = self.active.remove(&end.place) else { return };
        let parent = self.places.parent(end.place);
        let Some(around) = parent.and_then(|parent| self.active.get_mut(&parent)) else { return };
        if backwards {
            return around.inside.undo(end.place, |place| self.places.is_decider(place));
        }
        active.inside.begin();
        (end.entered, end.inputs) = (active.order, active.inputs);
        end.inside = (!active.inside.is_empty()).then(|| Box::new(active.inside));
        around.inside.end(end);
    }

    fn count_entry(&mut self) {
        self.entries += 1;
        if self.entries.is_multiple_of(COUNT_EVERY) && self.steps() > STEPS_MAX {
            self.settle(STEPS_MAX / 2);
        }
    }

    fn steps(&self) -> usize {
        self.active.values().map(|active| active.inside.weight()).sum()
    }

    /// Drops the oldest steps, the outermost first, until the given number remains.
    fn settle(&mut self, wanted: usize) {
        let mut steps = self.steps();
        let mut outermost: Vec<&mut Active> = self.active.values_mut().collect();
        outermost.sort_by_key(|active| active.order);
        for active in outermost {
            let mut before = active.inside.weight();
            while steps > wanted && active.inside.settle_oldest() {
                let now = active.inside.weight();
                steps -= before - now;
                before = now;
            }
        }
    }

    /// Restores the active states of the moment to which the run went back, and its global and persistent variables. Variables that
    /// did not exist then are kept.
    fn begin_restored(&mut self) {
        let Some(bytes) = self.restored.take() else { return };
        if let Ok(earlier) = Self::from_bytes(&bytes, self.places.clone()) {
            self.active = earlier.active;
            self.whole.stop = None;
            self.globals.extend(earlier.globals);
            self.persistent.extend(earlier.persistent);
        }
    }

    /// Returns true if a step back exceeded the stored steps. An exact result then needs an earlier start.
    pub fn lacks_steps(&self) -> bool {
        self.lacks_steps
    }

    /// Skips a state: the branch that was held before it continues.
    fn skip(&mut self, path: &str, outcome: i64) {
        let Some(place) = self.places.number(path).filter(|place| !self.active.contains_key(place))
        else {
            return;
        };
        let outputs = self.places.get(place).map_or(0, |place| place.outputs.len());
        let sequence = self.sequence;
        let Some(around) = self.around(place) else { return };
        around.inside.begin();
        around.inside.end(End {
            place,
            entered: sequence,
            inputs: Vec::new(),
            outcome,
            outputs: vec![Kept::Absent; outputs],
            error: None,
            order: sequence,
            inside: None,
            is_open: false,
        });
    }

    /// Holds a branch before a state. If the state was skipped, the skip was undone, or the state is next again.
    fn stands_before(&mut self, path: &str) {
        if let Some(place) = self.places.number(path)
            && let Some(around) = self.around(place)
        {
            around.inside.forget_skipped(place);
        }
    }

    /// Returns the active parent of this place.
    fn around(&mut self, place: PlaceNumber) -> Option<&mut Active> {
        self.active.get_mut(&self.places.parent(place)?)
    }

    /// Marks a state and all active states in it as preempted, except its handlers, which were entered at that time.
    fn preempt(&mut self, path: &str) {
        let Some(top) = self.places.number(path) else { return };
        let is_below = |place: PlaceNumber, places: &Places| {
            std::iter::successors(Some(place), |&place| places.parent(place)).any(|at| at == top)
        };
        for (place, active) in &mut self.active {
            active.asked |= active.t_ns < self.t_ns && is_below(*place, &self.places);
        }
    }

    fn drop_state(&mut self, path: &str) {
        self.whole.left(path);
        if let Some(place) = self.places.number(path) {
            self.active.remove(&place);
        }
    }
}
