//! The port between a run and the host of its scripts. It passes values as handles, and needs no interpreter.

use crate::drive::error::ValueError;
use crate::record::keep::Keep;
use crate::{Driver, Place, StateFiles};
use rafcon_engine::{Check, Datum, Finish, Globals, Job, Literals, Program, ScriptResult};
use rafcon_model::Machine;
use rafcon_protocol::{Keeping, Launch};
use rafcon_storage::journal::{Kept, Stored};
use rafcon_storage::{Config, Libraries, Saved};
use smol_str::SmolStr;
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A host of scripts: an interpreter, or plain Rust in tests.
///
/// A branch's thread is inside [`Scripts::inhabit`] for its whole life. A value may be dropped while the engine is
/// locked, so a value's own clean-up must wait until [`Scripts::settle`].
pub trait Scripts: Debug + Send + Sync + 'static {
    /// A handle to a value.
    type Value: Datum + Debug + Send + Sync + 'static;

    /// Runs one script on this thread, to its end.
    fn run(&self, job: Job<Self::Value>, place: &Arc<Place>) -> ScriptResult<Self::Value>;

    /// The result of a script that could not run, with the reason as its error.
    fn failure(&self, reason: &str) -> ScriptResult<Self::Value>;

    /// Enters the interpreter for as long as `life` runs.
    fn inhabit(&self, life: &mut (dyn FnMut() + Send));

    /// Leaves the interpreter to others while `wait` runs; used for everything that may block.
    fn park(&self, wait: &mut (dyn FnMut() + Send));

    /// Called with no lock held after the engine was used on this thread, to clean up dropped values.
    fn settle(&self);

    /// The run's global variables.
    fn globals(&self) -> &dyn Globals<Self::Value>;

    /// Receives the result of the run, with the values themselves. Called before [`Scripts::finished`].
    fn ended(&self, finish: &Finish<Self::Value>) {
        let _ = finish;
    }

    /// Called when the run is over. Its last values are read after this.
    fn finished(&self);

    /// Called when all viewers have received all events. From now on, signals of the system have their usual meaning in
    /// the interpreter. Called on the thread that called [`crate::serve`].
    fn released(&self);

    /// A value as `docs/protocol.md` encodes it.
    fn encode(&self, value: &Self::Value) -> serde_json::Value;

    /// Records the global variables that existed before the run began, by [`Driver::global`](crate::Driver::global).
    fn note_globals(&self) {}

    /// All global variables, encoded.
    fn encode_globals(&self) -> serde_json::Map<String, serde_json::Value>;

    /// A value from JSON as `docs/protocol.md` encodes it.
    fn value(&self, json: &serde_json::Value) -> Result<Self::Value, ValueError>;

    /// Lends a converter for literals of files, for a machine that changes during the run.
    fn with_literals(&self, make: &mut dyn FnMut(&mut dyn Literals<Self::Value>));

    /// The journal's form of a value. Called with the engine locked: runs no code of the user.
    fn keep<'v>(&self, value: &'v Self::Value) -> Keep<'v> {
        let reason = "this host keeps no values";
        if value.is_none() {
            Keep::Plain(Kept::None)
        } else {
            Keep::Plain(Kept::Text(reason.into()))
        }
    }

    /// The value that an event contains without a number.
    fn plain(&self, kept: &Kept) -> Result<Self::Value, ValueError> {
        Err(format!("this host cannot make {kept:?} again").into())
    }

    /// Restores a kept value; `values` is the folder of large ones.
    fn restore(&self, stored: &Stored, values: &Path) -> Result<Self::Value, ValueError> {
        let _ = values;
        Err(format!("this host cannot make a value of type {} again", stored.type_name).into())
    }

    /// Creates a placeholder for a value that cannot be restored; `why` names the value and the reason. The placeholder is
    /// passed on and kept like any other value, but no script ever receives it.
    fn lost(&self, why: &str) -> Self::Value;

    /// The reason, if the value is such a placeholder. Called with the engine locked: enters no interpreter.
    fn is_lost(&self, value: &Self::Value) -> Option<String>;

    /// Sets a global variable before anything runs: one of the launch, or one of a resumed run.
    fn restore_global(&self, name: &str, value: Self::Value) -> Result<(), ValueError> {
        let _ = (name, value);
        Err("this host keeps no global variables".into())
    }

    /// Restores what the state at `path` (ids joined by `/`) keeps from one of its runs to the next. Called before
    /// anything of a resumed run runs.
    fn restore_persistent(&self, path: &str, value: Self::Value) -> Result<(), ValueError> {
        let _ = (path, value);
        Err("this host keeps nothing from one run of a state to the next".into())
    }

    /// Evaluates the condition of a breakpoint on this thread. The error is the reason why that is impossible.
    fn check(&self, check: &Check<Self::Value>, place: &Arc<Place>) -> Result<bool, SmolStr> {
        let _ = (check, place);
        Err("this host cannot evaluate conditions".into())
    }

    /// Switches to another machine. States keep their numbers, and a script whose text changed is loaded again at its
    /// next entry. Called with the engine locked, before any script of the new machine begins: enters no interpreter.
    fn changed(&self, machine: &Machine, program: &Arc<Program<Self::Value>>) {
        let _ = (machine, program);
    }
}

/// An interpreter that can host the scripts of one machine.
pub trait Host {
    /// The scripts that this host runs, once the machine is known.
    type Scripts: Scripts;

    /// Converts literals of files to values.
    fn literals(&mut self) -> &mut dyn Literals<HostValue<Self>>;

    /// Converts JSON to a value.
    fn value(&mut self, json: &serde_json::Value) -> Result<HostValue<Self>, ValueError>;

    /// Receives the launch, before anything is loaded.
    fn launched(&mut self, _launch: &Launch) {}

    /// The machine to run, if the host supplies it; then it is not loaded from its folder. Asked once.
    fn built(&mut self) -> Option<Built> {
        None
    }

    /// The host's values for input ports of the root, by name. Those of the launch take precedence.
    fn inputs(&mut self) -> Vec<(SmolStr, HostValue<Self>)> {
        Vec::new()
    }

    /// Opens the machine that is going to run.
    fn open(self, opening: Opening<HostValue<Self>>) -> Self::Scripts;

    /// Called when the run is ready. Scripts query it through `driver`.
    fn opened(driver: &Arc<Driver<Self::Scripts>>);
}

/// A machine that a program has built in this process.
#[derive(Debug)]
pub struct Built {
    /// The machine to run.
    pub machine: Machine,
    /// Files of the machine, if it was loaded or saved before.
    pub saved: Option<Saved>,
    /// The libraries that the machine uses.
    pub libraries: Arc<Libraries>,
}

/// The values of a host.
pub type HostValue<H> = <<H as Host>::Scripts as Scripts>::Value;

/// Data for a host before the first script runs.
#[derive(Debug)]
pub struct Opening<D> {
    /// The machine of the run.
    pub machine: Machine,
    /// The machine in its compiled form.
    pub program: Arc<Program<D>>,
    /// Files of the machine's scripts.
    pub files: StateFiles,
    /// The reference's config, as far as a run uses it.
    pub config: Config,
    /// The journal's level of keeping. Without values, the host need not prepare them.
    pub keeping: Keeping,
    /// The folder of large values, if the run has a journal; created on first use.
    pub values: Option<PathBuf>,
}
