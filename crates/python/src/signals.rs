//! `rafcon._native.Signals`: the flags of a state, for scripts.

use crate::{current, thread};
use pyo3::prelude::*;
use rafcon_runner::Place;
use rafcon_runner::signals::{NUDGED, PAUSED, PREEMPTED, STARTED};
use std::sync::Arc;
use std::time::Duration;

/// The flags of the state at one place.
#[pyclass(frozen, module = "rafcon._native")]
#[derive(Debug)]
pub(crate) struct Signals {
    place: Arc<Place>,
}

impl Signals {
    pub(crate) fn new(place: Arc<Place>) -> Self {
        Self { place }
    }

    fn set(&self, flag: u8, on: bool) {
        // In a forked process another thread may have held the flags' lock when the fork happened.
        if !current::is_forked() {
            self.place.signals.set(flag, on);
        }
    }
}

#[pymethods]
impl Signals {
    #[getter]
    fn preempted(&self) -> bool {
        self.place.signals.any(PREEMPTED)
    }

    #[setter]
    fn set_preempted(&self, on: bool) {
        self.set(PREEMPTED, on);
    }

    #[getter]
    fn paused(&self) -> bool {
        self.place.signals.any(PAUSED)
    }

    #[setter]
    fn set_paused(&self, on: bool) {
        self.set(PAUSED, on);
    }

    #[getter]
    fn started(&self) -> bool {
        self.place.signals.any(STARTED)
    }

    #[setter]
    fn set_started(&self, on: bool) {
        self.set(STARTED, on);
    }

    #[getter]
    fn nudged(&self) -> bool {
        self.place.signals.any(NUDGED)
    }

    #[setter]
    fn set_nudged(&self, on: bool) {
        self.set(NUDGED, on);
    }

    /// Waits without the interpreter until any flag of `mask` is set; false if `timeout` seconds passed first.
    fn wait(&self, py: Python<'_>, mask: u8, timeout: Option<f64>) -> bool {
        let signals = &self.place.signals;
        if current::is_forked() || signals.any(mask) {
            return signals.any(mask);
        }
        let timeout = timeout.map(duration);
        thread::leave(py, || signals.wait(mask, timeout))
    }
}

/// Seconds as a duration: zero for a negative or invalid number, the maximum for a number that is too large.
fn duration(seconds: f64) -> Duration {
    if seconds > 0.0 {
        Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)
    } else {
        Duration::ZERO
    }
}
