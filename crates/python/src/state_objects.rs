//! Python data of each place: created on first use, and updated when the machine changes during the run.

use crate::codes::Codes;
use crate::handle::Handle;
use crate::runtime::Runtime;
use crate::script::{CompileContext, Script};
use crate::scripts::{PythonScripts, kind_name};
use crate::signals::Signals;
use crate::state_table::{StateSlot, StateTable};
use parking_lot::{Mutex, RwLock};
use pyo3::intern;
use pyo3::prelude::*;
use rafcon_engine::{NodeId, Program};
use rafcon_runner::Place;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The slots of a run, and the scripts that they share.
#[derive(Debug)]
pub(crate) struct StateObjects {
    program: RwLock<Arc<Program<Handle>>>,
    /// Counts the changes of the program.
    generation: AtomicU64,
    scripts: RwLock<BTreeMap<NodeId, Arc<Script>>>,
    codes: Arc<Codes>,
    seats: StateTable,
    /// Persistent values from before the restart that states have not requested yet, by path.
    persistent: Mutex<BTreeMap<String, Handle>>,
}

impl StateObjects {
    pub(crate) fn new(program: Arc<Program<Handle>>) -> Self {
        Self {
            program: RwLock::new(program),
            generation: AtomicU64::new(0),
            scripts: RwLock::default(),
            codes: Arc::default(),
            seats: StateTable::default(),
            persistent: Mutex::default(),
        }
    }

    pub(crate) fn program(&self) -> Arc<Program<Handle>> {
        Arc::clone(&self.program.read())
    }

    /// Replaces the program. Does not enter the interpreter: changed scripts are detected at their next entry.
    pub(crate) fn change(&self, program: Arc<Program<Handle>>) {
        *self.program.write() = program;
        self.generation.fetch_add(1, Ordering::Release);
    }

    /// Number of changes of the program.
    pub(crate) fn generation(&self) -> u64 {
        self.generation.load(Ordering::Acquire)
    }

    /// Stores the persistent value of a state from before the restart, until the state requests it.
    pub(crate) fn restore_persistent(&self, path: &str, value: Handle) {
        self.persistent.lock().insert(path.to_owned(), value);
    }

    /// The kinds of the states that run scripts, each once.
    pub(crate) fn script_kinds(&self) -> BTreeSet<&'static str> {
        let program = self.program();
        let nodes = program.nodes().filter(|(_, node)| node.is_script());
        nodes.map(|(_, node)| kind_name(node.state().kind.name())).collect()
    }
}

impl PythonScripts {
    /// Python data of a place, created at the first call.
    pub(crate) fn seat(&self, py: Python<'_>, place: &Arc<Place>) -> PyResult<Arc<StateSlot>> {
        match self.seating.seats.get(place.path) {
            Some(seat) => Ok(seat),
            None => self.make_seat(py, place),
        }
    }

    /// Assigns an object that was made elsewhere to a place without an object.
    pub(crate) fn seat_with(&self, object: &Bound<'_, PyAny>, place: &Arc<Place>) -> PyResult<()> {
        let py = object.py();
        let signals = Py::new(py, Signals::new(Arc::clone(place)))?;
        object.call_method1(intern!(py, "_bind"), (place.path.0, signals))?;
        self.seating.seats.insert(StateSlot::new(object.clone().unbind(), Arc::clone(place), None));
        Ok(())
    }

    fn make_seat(&self, py: Python<'_>, place: &Arc<Place>) -> PyResult<Arc<StateSlot>> {
        let program = self.seating.program();
        let kind = kind_name(program.node(place.node).state().kind.name());
        let signals = Py::new(py, Signals::new(Arc::clone(place)))?;
        let object = Runtime::get(py)?.new_state.call1(py, (place.path.0, kind, signals))?;
        let before = self.seating.persistent.lock().remove(&*place.text);
        if let Some(before) = &before {
            object.setattr(py, intern!(py, "persistent_variables"), before.bind(py))?;
        }
        let seat = StateSlot::new(object, Arc::clone(place), before);
        Ok(self.seating.seats.insert(seat))
    }

    /// The current script of the state at `seat`.
    pub(crate) fn script_of(&self, py: Python<'_>, seat: &StateSlot) -> Arc<Script> {
        let generation = self.seating.generation.load(Ordering::Acquire);
        if let Some(script) = seat.script(generation) {
            return script;
        }
        let script = self.current_script(py, &seat.place);
        seat.set_script(generation, &script);
        script
    }

    fn current_script(&self, py: Python<'_>, place: &Place) -> Arc<Script> {
        let program = self.seating.program();
        let known = self.seating.scripts.read().get(&place.node).cloned();
        if let Some(known) = known.filter(|known| known.is_of(program.node(place.node))) {
            return known;
        }
        let how = CompileContext {
            file: self.files.script(&place.text),
            recompile: self.config.recompile_scripts,
            codes: Arc::clone(&self.seating.codes),
        };
        let script = Arc::new(Script::new(py, &program, place.node, how));
        let before = self.seating.scripts.write().insert(place.node, Arc::clone(&script));
        drop(before);
        script
    }
}
