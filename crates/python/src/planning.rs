//! Planning for Python code. Knows how to wait without the interpreter; the supervisor knows plans and engines.

use crate::build_files::LibraryRoots;
use parking_lot::{Condvar, Mutex};
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use rafcon_protocol::api::{MakePlan, PlanFound};
use rafcon_storage::{Libraries, Naming, save};
use rafcon_supervisor::planning::{Cancel, Planner, machine_of};
use rafcon_supervisor::{Interpreter, ProgramEnvironment};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Events that have not been requested yet.
#[derive(Debug, Default)]
struct Events {
    lines: Mutex<VecDeque<String>>,
    came: Condvar,
}

impl Events {
    fn tell(&self, event: &rafcon_protocol::api::PlanEvent) {
        let line = serde_json::to_string(event).unwrap_or_default();
        self.lines.lock().push_back(line);
        self.came.notify_all();
    }
}

/// `rafcon._native.Planning`: an engine that plans on its own thread until it is done, cancelled or dropped.
#[pyclass(frozen, module = "rafcon._native")]
#[derive(Debug)]
pub(crate) struct Planning {
    events: Arc<Events>,
    cancel: Cancel,
}

#[pymethods]
impl Planning {
    /// Starts planning. The request is JSON, as for `POST /plans`; `python` is the interpreter for other engines.
    #[new]
    fn new(request: &str, roots: &LibraryRoots, python: PathBuf) -> PyResult<Self> {
        let request: MakePlan = serde_json::from_str(request)
            .map_err(|error| PyValueError::new_err(format!("the request does not fit: {error}")))?;
        let planning = Self { events: Arc::default(), cancel: Cancel::default() };
        let (events, cancel) = (Arc::clone(&planning.events), planning.cancel.clone());
        let libraries = Arc::clone(&roots.libraries);
        let work = move || run(&request, &libraries, &python, &cancel, &events);
        std::thread::Builder::new().name("planning".to_owned()).spawn(work)?;
        Ok(planning)
    }

    /// The next event as JSON; None if none arrives within these seconds.
    fn next(&self, py: Python<'_>, seconds: f64) -> Option<String> {
        let patience = Duration::try_from_secs_f64(seconds).unwrap_or_default();
        py.detach(|| {
            let mut lines = self.events.lines.lock();
            if lines.is_empty() {
                self.events.came.wait_for(&mut lines, patience);
            }
            lines.pop_front()
        })
    }

    /// Ends the engine at once.
    fn cancel(&self) {
        self.cancel.cancel();
    }
}

impl Drop for Planning {
    fn drop(&mut self) {
        self.cancel.cancel();
    }
}

fn run(request: &MakePlan, libraries: &Libraries, python: &Path, cancel: &Cancel, events: &Events) {
    let environment = ProgramEnvironment::default();
    let Ok(python) = Interpreter::choose(Some(python), &environment) else { return };
    let planner = Planner { libraries, python: &python, environment: &environment };
    let last = planner.plan(request, cancel, &mut |event| events.tell(&event));
    events.tell(&last);
}

/// `rafcon._native.save_plan`: writes the machine of a plan, given as JSON, to a folder.
#[pyfunction]
pub(crate) fn save_plan(
    py: Python<'_>,
    found: &str,
    roots: &LibraryRoots,
    folder: PathBuf,
) -> PyResult<()> {
    let found: PlanFound = serde_json::from_str(found)
        .map_err(|error| PyValueError::new_err(format!("this is no plan: {error}")))?;
    py.detach(move || {
        let machine = machine_of(&found, &roots.libraries).map_err(PyValueError::new_err)?;
        save(&machine, &folder, None, Naming::default())
            .map(drop)
            .map_err(|error| PyOSError::new_err(error.to_string()))
    })
}
