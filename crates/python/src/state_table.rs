//! Python data of each place in the machine, for the life of the process: the `self` of its scripts and the data of the
//! last run.

use crate::handle::Handle;
use crate::script::Script;
use parking_lot::{Mutex, RwLock};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rafcon_engine::PathId;
use rafcon_runner::Place;
use std::sync::Arc;

/// Data of one place.
#[derive(Debug)]
pub(crate) struct StateSlot {
    /// `self`, with all attributes that scripts set.
    pub(crate) object: Py<PyAny>,
    /// The place in the run.
    pub(crate) place: Arc<Place>,
    /// Script of the current state, with the generation of the machine for which it was found.
    script: Mutex<Option<(u64, Arc<Script>)>>,
    data: Mutex<Data>,
    /// `self.persistent_variables` as last kept.
    persistent: Mutex<Option<Handle>>,
}

/// The dictionaries of the last run of a script.
#[derive(Debug, Default)]
struct Data {
    inputs: Option<Py<PyDict>>,
    outputs: Option<Py<PyDict>>,
}

impl StateSlot {
    pub(crate) fn new(object: Py<PyAny>, place: Arc<Place>, persistent: Option<Handle>) -> Self {
        Self {
            object,
            place,
            script: Mutex::default(),
            data: Mutex::default(),
            persistent: Mutex::new(persistent),
        }
    }

    /// The script, if it is cached for this generation of the machine.
    pub(crate) fn script(&self, generation: u64) -> Option<Arc<Script>> {
        let script = self.script.lock();
        let known = script.as_ref().filter(|(known, _)| *known == generation);
        known.map(|(_, script)| Arc::clone(script))
    }

    /// Caches the script for this generation of the machine.
    pub(crate) fn set_script(&self, generation: u64, script: &Arc<Script>) {
        let before = self.script.lock().replace((generation, Arc::clone(script)));
        drop(before);
    }

    /// The persistent variables as last kept.
    pub(crate) fn persistent(&self) -> Option<Handle> {
        self.persistent.lock().clone()
    }

    /// Sets the persistent variables as last kept.
    pub(crate) fn set_persistent(&self, kept: Handle) {
        let before = self.persistent.lock().replace(kept);
        drop(before);
    }

    /// Stores the inputs and outputs of a script that begins.
    pub(crate) fn begin(&self, inputs: &Bound<'_, PyDict>, outputs: &Bound<'_, PyDict>) {
        let new =
            Data { inputs: Some(inputs.clone().unbind()), outputs: Some(outputs.clone().unbind()) };
        let old = std::mem::replace(&mut *self.data.lock(), new);
        drop(old);
    }

    /// The inputs and outputs of the last run of a script.
    pub(crate) fn data<'py>(
        &self,
        py: Python<'py>,
    ) -> Option<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let data = self.data.lock();
        let dict = |dict: &Option<Py<PyDict>>| dict.as_ref().map(|dict| dict.bind(py).clone());
        Some((dict(&data.inputs)?, dict(&data.outputs)?))
    }
}

/// All slots, by the number of the place.
#[derive(Debug, Default)]
pub(crate) struct StateTable(RwLock<Vec<Option<Arc<StateSlot>>>>);

impl StateTable {
    pub(crate) fn get(&self, path: PathId) -> Option<Arc<StateSlot>> {
        self.0.read().get(path.index()).cloned().flatten()
    }

    /// Inserts a slot at its place and returns it; an existing one is kept and returned instead.
    pub(crate) fn insert(&self, seat: StateSlot) -> Arc<StateSlot> {
        let index = seat.place.path.index();
        let seat = Arc::new(seat);
        let mut seats = self.0.write();
        if seats.len() <= index {
            seats.resize(index + 1, None);
        }
        Arc::clone(seats[index].get_or_insert_with(|| Arc::clone(&seat)))
    }
}
