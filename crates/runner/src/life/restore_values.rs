//! Converts a moment of a journal to the engine's configuration. Values that cannot be restored become placeholders,
//! which no script receives.

use crate::Scripts;
use crate::drive::error::ValueError;
use crate::places::limits;
use rafcon_engine::{ActiveStateData, ChildEnd, ScopedValue};
use rafcon_model::{Machine, OutcomeId, PortId, StateId, StatePath};
use rafcon_protocol::Keeping;
use rafcon_storage::journal::folder::VALUES_FOLDER;
use rafcon_storage::journal::{self, Kept, Moment, Place, Reader};
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Restores values of one journal, each only once.
pub(crate) struct ValueRestorer<'r, S: Scripts> {
    scripts: &'r S,
    reader: &'r Reader,
    machine: &'r Machine,
    values: PathBuf,
    made: BTreeMap<u64, S::Value>,
    /// True if a value became a placeholder.
    lost: bool,
}

/// Restored data outside of the active states.
pub(crate) struct RestoreContext<D> {
    /// Global variables by name.
    pub(crate) globals: Vec<(SmolStr, D)>,
    /// Persistent values of states by path.
    pub(crate) persistent: Vec<(String, D)>,
    /// Values that could not be restored, described for people.
    pub(crate) problems: Vec<String>,
}

impl<'r, S: Scripts> ValueRestorer<'r, S> {
    /// A restorer for a run with this journal that continues with `machine`.
    pub(crate) fn new(scripts: &'r S, reader: &'r Reader, machine: &'r Machine) -> Self {
        let values = reader.folder().join(VALUES_FOLDER);
        Self { scripts, reader, machine, values, made: BTreeMap::new(), lost: false }
    }

    /// True if a value could not be restored.
    pub(crate) fn note_lost_values(&self) -> bool {
        self.lost
    }

    /// The active states; `None` if none was active.
    pub(crate) fn root(&mut self, moment: &Moment) -> Option<ActiveStateData<S::Value>> {
        let standing = moment.active();
        let mut below: Vec<Vec<ActiveStateData<S::Value>>> =
            standing.iter().map(|_| Vec::new()).collect();
        for (index, state) in standing.iter().enumerate().rev() {
            let mut children = std::mem::take(&mut below[index]);
            children.reverse();
            let around = state.parent.map(|parent| &standing[parent]);
            let restored = ActiveStateData { children, ..self.state(state, around) };
            match state.parent {
                Some(parent) => below[parent].push(restored),
                None => return Some(restored),
            }
        }
        None
    }

    /// Restores global variables and persistent values of states.
    pub(crate) fn restore_context(&mut self, moment: &Moment) -> RestoreContext<S::Value> {
        let mut problems = Vec::new();
        let mut made = |kept: &Kept, what: String| match self.make(kept) {
            Ok(value) => Some(value),
            Err(why) => {
                problems.push(format!("{what} cannot be put back: {why}"));
                None
            }
        };
        let globals = moment.globals().iter().filter_map(|(name, kept)| {
            Some((name.clone(), made(kept, format!("the global variable \"{name}\""))?))
        });
        let globals = globals.collect();
        let persistent = moment.persistent().filter_map(|(place, kept)| {
            let what = format!("what {} keeps from one run to the next", place.path);
            Some((place.path.clone(), made(kept, what)?))
        });
        let persistent = persistent.collect();
        RestoreContext { globals, persistent, problems }
    }

    /// Restores values of a state by the names of its ports.
    pub(crate) fn named(
        &mut self,
        place: &Place,
        ports: &[(u64, SmolStr)],
        kept: &[Kept],
    ) -> Vec<(SmolStr, S::Value)> {
        let ports = ports.iter().zip(kept);
        let ports = ports.filter(|(_, kept)| **kept != Kept::Absent);
        ports.map(|((_, name), kept)| (name.clone(), self.value(kept, name, place))).collect()
    }

    fn state(
        &mut self,
        state: &journal::ActiveStateData,
        around: Option<&journal::ActiveStateData>,
    ) -> ActiveStateData<S::Value> {
        let place = &*state.place;
        let whole = self.is_kept_whole(&place.path);
        let scoped = state.scoped.iter().map(|variable| ScopedValue {
            port: port(variable.port),
            value: self.value(&variable.value, name_of(&place.scoped, variable.port), place),
            order: variable.order,
        });
        let mut scoped: Vec<_> = scoped.collect();
        if !whole {
            scoped.extend(place.scoped.iter().map(|(id, name)| ScopedValue {
                port: port(*id),
                value: self.unkept(name, place),
                order: state.order,
            }));
        }
        ActiveStateData {
            state: StateId::new(state.state()),
            inputs: self.ports(&state.inputs, state.lacks_inputs, &place.inputs, place),
            order: state.order,
            error: self.given_error(around),
            preempted: state.asked.then_some(true),
            scoped,
            ended: state.ended.iter().map(|ended| self.end(ended)).collect(),
            last: state.last.as_ref().map(|last| StateId::new(last.as_str())),
            children: Vec::new(),
        }
    }

    /// The error that the last ended child passed on.
    fn given_error(&mut self, around: Option<&journal::ActiveStateData>) -> Option<S::Value> {
        let around = around?;
        let last = around.last.as_ref()?;
        let ended = around.ended.iter().find(|ended| ended.state() == last.as_str())?;
        self.error_of(ended)
    }

    fn error_of(&mut self, ended: &journal::ChildEnd) -> Option<S::Value> {
        ended.error.as_ref().map(|error| self.value(error, "error", &ended.place))
    }

    fn end(&mut self, ended: &journal::ChildEnd) -> ChildEnd<S::Value> {
        let place = &*ended.place;
        ChildEnd {
            state: StateId::new(ended.state()),
            outcome: OutcomeId(ended.outcome),
            outputs: self.ports(&ended.outputs, ended.lacks_outputs, &place.outputs, place),
            error: self.error_of(ended),
            order: ended.order,
        }
    }

    fn ports(
        &mut self,
        kept: &[(u64, Kept)],
        lacks: bool,
        all: &[(u64, SmolStr)],
        place: &Place,
    ) -> Vec<(PortId, S::Value)> {
        if lacks {
            return all.iter().map(|(id, name)| (port(*id), self.unkept(name, place))).collect();
        }
        let values = kept.iter();
        values.map(|(id, kept)| (port(*id), self.value(kept, name_of(all, *id), place))).collect()
    }

    /// The restored value, or a placeholder.
    fn value(&mut self, kept: &Kept, name: &str, place: &Place) -> S::Value {
        self.make(kept).unwrap_or_else(|why| self.stand_in(name, place, &why.0))
    }

    fn unkept(&mut self, name: &str, place: &Place) -> S::Value {
        self.stand_in(name, place, "the journal keeps no values of this state")
    }

    fn stand_in(&mut self, name: &str, place: &Place, why: &str) -> S::Value {
        self.lost = true;
        self.scripts
            .lost(&format!("the value of \"{name}\" of {} cannot be made again: {why}", place.path))
    }

    fn make(&mut self, kept: &Kept) -> Result<S::Value, ValueError> {
        let Kept::Value(number) = kept else { return self.scripts.plain(kept) };
        if let Some(value) = self.made.get(&number.0) {
            return Ok(value.clone());
        }
        let stored = self.reader.value(*number).map_err(|error| error.to_string())?;
        let stored = stored.ok_or("it was given up to keep the journal small")?;
        let value = self.scripts.restore(&stored, &self.values)?;
        self.made.insert(number.0, value.clone());
        Ok(value)
    }

    /// True if the values of the state at this path are kept.
    fn is_kept_whole(&self, path: &str) -> bool {
        let path = StatePath::parse(path);
        let around = (1..=path.0.len()).map(|length| StatePath(path.0[..length].to_vec()));
        let states = around.filter_map(|path| self.machine.state(&path));
        let run = self.reader.about().keeping;
        states.fold(run, |around, state| limits::keeping_of(state, around)) == Keeping::Full
    }
}

fn port(id: u64) -> PortId {
    PortId(id.cast_signed())
}

fn name_of(ports: &[(u64, SmolStr)], id: u64) -> &str {
    ports.iter().find(|(other, _)| *other == id).map_or("", |(_, name)| name)
}
