//! The complete list of Python functions that Rust calls: the module `rafcon._runtime`, imported once.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;
use rafcon_protocol::Launch;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Functions and objects of `rafcon._runtime`.
#[derive(Debug)]
pub(crate) struct Runtime {
    /// Prepares this thread for running scripts.
    pub(crate) adopt_thread: Py<PyAny>,
    /// Loads the classes of some kinds of states.
    pub(crate) prepare: Py<PyAny>,
    /// Makes the `self` of a script.
    pub(crate) new_state: Py<PyAny>,
    /// Passes the ends of its branches to a decider.
    pub(crate) set_verdicts: Py<PyAny>,
    /// The `gvm` of scripts.
    pub(crate) global_variables: Py<PyAny>,
    /// Reads a global variable for a default.
    pub(crate) resolve_global: Py<PyAny>,
    /// Restores a global variable from its kept value.
    pub(crate) restore_global: Py<PyAny>,
    /// Starts keeping the global variables in a journal.
    pub(crate) keep_globals: Py<PyAny>,
    pub(crate) note_globals: Py<PyAny>,
    /// The type with a dotted name.
    pub(crate) resolve_type: Py<PyAny>,
    /// The value of a text that only Python can read.
    pub(crate) convert: Py<PyAny>,
    /// An object from the encoding of files.
    pub(crate) decode: Py<PyAny>,
    /// `decode` for values from clients: plain data only, without imports.
    pub(crate) decode_plain: Py<PyAny>,
    /// Encodes an object for the protocol.
    pub(crate) encode: Py<PyAny>,
    /// Encodes all global variables for the protocol.
    pub(crate) encode_globals: Py<PyAny>,
    /// A traceback for users.
    pub(crate) format_error: Py<PyAny>,
    /// Sends the unfinished lines of this thread.
    pub(crate) flush_capture: Py<PyAny>,
    /// Sends the unfinished lines of all threads.
    pub(crate) flush_all: Py<PyAny>,
    /// Unfinished lines; empty if there is nothing to send.
    pub(crate) pending: Py<PyDict>,
    /// Hooks of the plugins.
    pub(crate) hooks: Py<PyAny>,
    /// True if a plugin registered hooks around scripts.
    hooked: AtomicBool,
    /// Ends a script that was preempted inside a call.
    pub(crate) state_preempted: Py<PyAny>,
    /// Replaces the configuration in force.
    pub(crate) configure: Py<PyAny>,
    /// Forwards printed and logged output of scripts to the run.
    pub(crate) install_capture: Py<PyAny>,
    /// Dictionary of Python's module `builtins`.
    pub(crate) builtins: Py<PyAny>,
    /// Returns the built-in names for a script that uses the dialogs of the desktop; `None` for other scripts.
    builtins_for: Py<PyAny>,
    /// The function `copy.deepcopy` of Python.
    pub(crate) deep_copy: Py<PyAny>,
    /// The function `json.dumps` of Python.
    pub(crate) write_json: Py<PyAny>,
    /// Evaluates the condition of a breakpoint.
    pub(crate) check: Py<PyAny>,
    /// Short description of an error.
    pub(crate) why: Py<PyAny>,
    /// The pickle of an object.
    pub(crate) pickle: Py<PyAny>,
    /// The object of a pickle.
    pub(crate) unpickle: Py<PyAny>,
}

static RUNTIME: PyOnceLock<Runtime> = PyOnceLock::new();

impl Runtime {
    /// The single instance, imported at the first call.
    pub(crate) fn get(py: Python<'_>) -> PyResult<&Self> {
        RUNTIME.get_or_try_init(py, || Self::import(py))
    }

    /// Loads the user's plugins.
    pub(crate) fn load_plugins(&self, py: Python<'_>) -> PyResult<()> {
        self.hooks.call_method0(py, "load")?;
        self.heed_plugins(py)
    }

    /// Passes the launch to the plugins.
    pub(crate) fn begin_plugins(&self, py: Python<'_>, launch: &Launch) -> PyResult<()> {
        let path = |path: &Path| path.to_string_lossy().into_owned();
        let config = launch.config.as_deref().map(path);
        let start_from = launch.start_from.as_deref();
        self.hooks.call_method1(py, "begin", (path(&launch.machine), config, start_from))?;
        Ok(())
    }

    /// Updates the flag for hooks around scripts, after the embedding program loaded plugins.
    pub(crate) fn heed_plugins(&self, py: Python<'_>) -> PyResult<()> {
        let active = self.hooks.bind(py).getattr("active")?.is_truthy()?;
        self.hooked.store(active, Ordering::Relaxed);
        Ok(())
    }

    /// The plugins, if one registered hooks around scripts.
    pub(crate) fn script_hooks<'py>(&self, py: Python<'py>) -> Option<&Bound<'py, PyAny>> {
        self.hooked.load(Ordering::Relaxed).then(|| self.hooks.bind(py))
    }

    /// The built-in names for a script.
    pub(crate) fn builtins_for(&self, py: Python<'_>, text: &str) -> PyResult<Py<PyAny>> {
        if text.contains("rafcon.gui") {
            let own = self.builtins_for.call1(py, (text,))?;
            if !own.is_none(py) {
                return Ok(own);
            }
        }
        Ok(self.builtins.clone_ref(py))
    }

    fn import(py: Python<'_>) -> PyResult<Self> {
        let module = py.import("rafcon._runtime")?;
        let get = |name: &str| module.getattr(name).map(Bound::unbind);
        Ok(Self {
            adopt_thread: get("adopt_thread")?,
            prepare: get("prepare")?,
            new_state: get("new_state")?,
            set_verdicts: get("set_verdicts")?,
            global_variables: get("global_variable_manager")?,
            resolve_global: get("resolve_global")?,
            keep_globals: get("keep_globals")?,
            note_globals: get("note_globals")?,
            restore_global: get("restore_global")?,
            resolve_type: get("resolve_type")?,
            convert: get("convert")?,
            decode: get("decode")?,
            decode_plain: get("decode_plain")?,
            encode: get("encode")?,
            encode_globals: get("encode_globals")?,
            format_error: get("format_error")?,
            flush_capture: get("flush_capture")?,
            flush_all: get("flush_all")?,
            pending: module.getattr("pending")?.cast_into::<PyDict>()?.unbind(),
            hooks: get("hooks")?,
            hooked: AtomicBool::new(false),
            state_preempted: get("StatePreempted")?,
            configure: get("configure")?,
            install_capture: get("install_capture")?,
            builtins: py.import("builtins")?.dict().into_any().unbind(),
            builtins_for: get("builtins_for")?,
            deep_copy: py.import("copy")?.getattr("deepcopy")?.unbind(),
            write_json: py.import("json")?.getattr("dumps")?.unbind(),
            check: get("check")?,
            why: get("why")?,
            pickle: get("pickle")?,
            unpickle: get("unpickle")?,
        })
    }
}
