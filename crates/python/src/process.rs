//! `rafcon._native.main`: turns this process into a runner.

use crate::handle::Handle;
use crate::literals::{PythonLiterals, from_json};
use crate::runtime::Runtime;
use crate::scripts::PythonScripts;
use crate::{config, current, early, fork, globals, package, process_output};
use pyo3::prelude::*;
use pyo3::types::PyModule;
use rafcon_engine::Literals;
use rafcon_protocol::{Launch, LogLevel};
use rafcon_runner::{Built, Driver, Host, Opening, ServeError, ValueError, serve};
use smol_str::SmolStr;
use std::os::fd::{FromRawFd as _, OwnedFd, RawFd};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::time::Duration;

/// Timeout of Python's shutdown after the end of the run.
const EXIT_TIMEOUT: Duration = Duration::from_secs(5);

/// Python before its machine is known.
#[derive(Debug, Default)]
pub(crate) struct PythonHost {
    literals: PythonLiterals,
    built: Option<Built>,
    inputs: Vec<(SmolStr, Handle)>,
}

impl PythonHost {
    /// Hosts a machine that the program has built (or a resumed run), with the inputs of its root.
    pub(crate) fn embedded(built: Option<Built>, inputs: Vec<(SmolStr, Handle)>) -> Self {
        Self { literals: PythonLiterals, built, inputs }
    }
}

impl Host for PythonHost {
    type Scripts = PythonScripts;

    fn literals(&mut self) -> &mut dyn Literals<Handle> {
        &mut self.literals
    }

    fn value(&mut self, json: &serde_json::Value) -> Result<Handle, ValueError> {
        from_json(json)
    }

    fn launched(&mut self, launch: &Launch) {
        if current::is_embedded() {
            return;
        }
        let begun = Python::attach(|py| Runtime::get(py)?.begin_plugins(py, launch));
        if let Err(error) = begun {
            let message = format!("the plugins cannot learn which machine runs: {error}");
            early::say(LogLevel::Error, message);
        }
    }

    fn built(&mut self) -> Option<Built> {
        self.built.take()
    }

    fn inputs(&mut self) -> Vec<(SmolStr, Handle)> {
        std::mem::take(&mut self.inputs)
    }

    fn open(self, opening: Opening<Handle>) -> PythonScripts {
        PythonScripts::new(opening)
    }

    fn opened(driver: &Arc<Driver<PythonScripts>>) {
        current::set(driver);
        let scripts = driver.scripts();
        if current::is_embedded() {
            let keeper = &scripts.keeper;
            if let Err(error) = Python::attach(|py| globals::keep_embedded(py, keeper)) {
                let message = format!("the global variables cannot be kept: {error}");
                current::say(LogLevel::Error, message);
            }
            return;
        }
        early::hand_over(driver);
        let roots = scripts.files.libraries().roots();
        let ready = Python::attach(|py| {
            Runtime::get(py)?.prepare.call1(py, (scripts.seating.script_kinds(),))?;
            globals::keep(py, &scripts.keeper)?;
            config::put_in_force(py, &scripts.config, roots)
        });
        if let Err(error) = ready {
            current::say(
                LogLevel::Error,
                format!("scripts may see the default configuration: {error}"),
            );
        }
    }
}

/// Runs the machine for the viewer at the other end of the socket `fd`; returns the process's exit code.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, fd: RawFd) -> PyResult<i32> {
    let stream = adopt(py, fd)?;
    package::install(py)?;
    let module = py.import("rafcon._native")?;
    fork::register(&module)?;
    let runtime = Runtime::get(py)?;
    default_signals(py)?;
    read_output(py)?;
    runtime.install_capture.call0(py)?;
    runtime.load_plugins(py)?;
    // All objects alive now stay; exclude them from later collections.
    py.import("gc")?.call_method0("freeze")?;
    let end = py.detach(|| serve(stream, PythonHost::default()));
    let code = exit_code(end);
    end_soon(code);
    runtime.flush_all.call0(py)?;
    runtime.hooks.call_method0(py, "shut_down")?;
    process_output::close();
    early::print();
    Ok(code)
}

/// Ends the process after a timeout: functions of `atexit` and threads of libraries may run forever.
fn end_soon(code: i32) {
    let wait = move || {
        std::thread::park_timeout(EXIT_TIMEOUT);
        signal_hook::low_level::exit(code);
    };
    // Without the thread the process ends together with Python.
    drop(std::thread::Builder::new().name("exit".to_owned()).spawn(wait));
}

/// Environment variable of a starter that leaves standard output and error to the runner until the end of the run.
const READS_OUTPUT: &str = "RAFCON_READS_OUTPUT";

fn read_output(py: Python<'_>) -> PyResult<()> {
    let environment = py.import("os")?.getattr("environ")?;
    let wanted = environment.call_method1("pop", (READS_OUTPUT, py.None()))?;
    if !wanted.is_none()
        && let Err(error) = process_output::install()
    {
        let message = format!("output of child processes is logged after the run only: {error}");
        early::say(LogLevel::Info, message);
    }
    Ok(())
}

/// Provides the package `rafcon` to a program that has loaded this module itself and is no runner.
#[pyfunction]
pub(crate) fn serve_package(py: Python<'_>) -> PyResult<()> {
    package::install(py)
}

/// Lets signals end the process, regardless of the threads of scripts. Python's own handler would raise `KeyboardInterrupt`
/// in the thread that waits for the run.
pub(crate) fn default_signals(py: Python<'_>) -> PyResult<()> {
    let signal = py.import("signal")?;
    let default = signal.getattr("SIG_DFL")?;
    for name in ["SIGINT", "SIGTERM", "SIGHUP"] {
        signal.call_method1("signal", (signal.getattr(name)?, &default))?;
    }
    Ok(())
}

/// The exit code is for callers without a connection; viewers receive more.
#[expect(clippy::print_stderr, reason = "without a viewer there is no other place to report it")]
fn exit_code(end: Result<(), ServeError>) -> i32 {
    match end {
        Ok(()) => 0,
        Err(ServeError::Load(_told_already)) => 1,
        Err(error) => {
            eprintln!("rafcon: {error}");
            1
        }
    }
}

/// Takes ownership of the socket, and hides it from programs that scripts start.
#[expect(unsafe_code, reason = "an inherited descriptor has no safe door")]
pub(crate) fn adopt(py: Python<'_>, fd: RawFd) -> PyResult<UnixStream> {
    let os = py.import("os")?;
    os.call_method1("set_inheritable", (fd, false))?;
    // SAFETY: `set_inheritable` has just shown that the descriptor is open, and the parent process passed it to this
    // process alone.
    Ok(UnixStream::from(unsafe { OwnedFd::from_raw_fd(fd) }))
}

/// Adds the content of the compiled module for imports.
pub(crate) fn fill(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("VERSION", env!("CARGO_PKG_VERSION"))?;
    module.add("PROTOCOL", rafcon_protocol::VERSION)?;
    module.add_class::<crate::signals::Signals>()?;
    module.add_class::<crate::run_messages::RunMessages>()?;
    module.add_class::<crate::build::Document>()?;
    module.add_class::<crate::build_files::LibraryRoots>()?;
    module.add_class::<package::Importer>()
}
