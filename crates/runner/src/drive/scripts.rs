//! The port through which a run reaches whatever runs its scripts. Knows values as handles; knows nothing of an interpreter.

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
/// A branch's thread is inside [`Scripts::inhabit`] for its whole life. Whatever drops a value may do so while the engine is
/// locked, so a value's own clean-up must wait until [`Scripts::settle`].
pub trait Scripts: Debug + Send + Sync + 'static {
    /// A handle to a value.
    type Value: Datum + Debug + Send + Sync + 'static;

    /// Runs one script on this thread, to its end.
    fn run(&self, job: Job<Self::Value>, place: &Arc<Place>) -> ScriptResult<Self::Value>;

    /// The answer of a script that could not be run at all, with the reason as its error.
    fn failure(&self, reason: &str) -> ScriptResult<Self::Value>;

    /// Enters the interpreter for as long as `life` runs.
    fn inhabit(&self, life: &mut (dyn FnMut() + Send));

    /// Leaves the interpreter to others while `wait` runs; used for everything that may block.
    fn park(&self, wait: &mut (dyn FnMut() + Send));

    /// Called with no lock held after the engine was used on this thread: a chance to clean up dropped values.
    fn settle(&self);

    /// The run's global variables.
    fn globals(&self) -> &dyn Globals<Self::Value>;

    /// How the run ended, with the values themselves. Called before [`Scripts::finished`].
    fn ended(&self, finish: &Finish<Self::Value>) {
        let _ = finish;
    }

    /// The run is over; its last values are read after this.
    fn finished(&self);

    /// The run is told; signals of the system mean what they mean to any program of the interpreter. Called on the thread
    /// that called [`crate::serve`].
    fn released(&self);

    /// A value as `docs/protocol.md` encodes it.
    fn encode(&self, value: &Self::Value) -> serde_json::Value;

    /// Notes down the global variables that were there before the run began, by [`Driver::global`](crate::Driver::global).
    fn note_globals(&self) {}

    /// All global variables, encoded.
    fn encode_globals(&self) -> serde_json::Map<String, serde_json::Value>;

    /// A value from JSON as `docs/protocol.md` encodes it.
    fn value(&self, json: &serde_json::Value) -> Result<Self::Value, ValueError>;

    /// Lends what makes values of what files hold, for a machine that changes while it runs.
    fn with_literals(&self, make: &mut dyn FnMut(&mut dyn Literals<Self::Value>));

    /// How the journal keeps a value. Called with the engine locked: runs no code of the user.
    fn keep<'v>(&self, value: &'v Self::Value) -> Keep<'v> {
        let reason = "this host keeps no values";
        if value.is_none() {
            Keep::Plain(Kept::None)
        } else {
            Keep::Plain(Kept::Text(reason.into()))
        }
    }

    /// The value that an event names without a number.
    fn plain(&self, kept: &Kept) -> Result<Self::Value, ValueError> {
        Err(format!("this host cannot make {kept:?} again").into())
    }

    /// A value that was kept; `values` is the folder of large ones.
    fn restore(&self, stored: &Stored, values: &Path) -> Result<Self::Value, ValueError> {
        let _ = values;
        Err(format!("this host cannot make a value of type {} again", stored.type_name).into())
    }

    /// Stands for a value that cannot be made again; `why` says which, and why. It is passed on like any other, it is kept as
    /// what it is, and no script ever gets it.
    fn lost(&self, why: &str) -> Self::Value;

    /// The reason, if this is such a stand-in. Called with the engine locked: enters no interpreter.
    fn is_lost(&self, value: &Self::Value) -> Option<String>;

    /// Sets a global variable before anything runs: one of the launch, or one of a run that is resumed.
    fn restore_global(&self, name: &str, value: Self::Value) -> Result<(), ValueError> {
        let _ = (name, value);
        Err("this host keeps no global variables".into())
    }

    /// Puts back what the state at `path` (ids joined by `/`) keeps from one of its runs to the next, before anything of a
    /// run that is resumed runs.
    fn restore_persistent(&self, path: &str, value: Self::Value) -> Result<(), ValueError> {
        let _ = (path, value);
        Err("this host keeps nothing from one run of a state to the next".into())
    }

    /// Evaluates the condition of a breakpoint on this thread; the error says why it cannot.
    fn check(&self, check: &Check<Self::Value>, place: &Arc<Place>) -> Result<bool, SmolStr> {
        let _ = (check, place);
        Err("this host cannot evaluate conditions".into())
    }

    /// The run goes by another machine from now on. States keep their numbers; a script whose text changed is read again at
    /// its next entry. Called with the engine locked, before any script of the new machine begins: enters no interpreter.
    fn changed(&self, machine: &Machine, program: &Arc<Program<Self::Value>>) {
        let _ = (machine, program);
    }
}

/// An interpreter that can host the scripts of one machine.
pub trait Host {
    /// What it becomes once the machine is known.
    type Scripts: Scripts;

    /// Makes values from what files hold.
    fn literals(&mut self) -> &mut dyn Literals<HostValue<Self>>;

    /// Makes a value from JSON.
    fn value(&mut self, json: &serde_json::Value) -> Result<HostValue<Self>, ValueError>;

    /// Learns what it is going to run, before anything is loaded.
    fn launched(&mut self, _launch: &Launch) {}

    /// The machine to run, if the host has it already: it is not read from its folder then. Asked once.
    fn built(&mut self) -> Option<Built> {
        None
    }

    /// Values of input ports of the root that the host has, by name; they come before those of the launch.
    fn inputs(&mut self) -> Vec<(SmolStr, HostValue<Self>)> {
        Vec::new()
    }

    /// Opens the machine that is going to run.
    fn open(self, opening: Opening<HostValue<Self>>) -> Self::Scripts;

    /// The run is ready: scripts that ask about it ask `driver`.
    fn opened(driver: &Arc<Driver<Self::Scripts>>);
}

/// A machine that a program has built in this process.
#[derive(Debug)]
pub struct Built {
    /// The machine.
    pub machine: Machine,
    /// Where it was read or written last, if it was.
    pub saved: Option<Saved>,
    /// Where the libraries lie that it uses.
    pub libraries: Arc<Libraries>,
}

/// The values of a host.
pub type HostValue<H> = <<H as Host>::Scripts as Scripts>::Value;

/// What a host gets to know before the first script runs.
#[derive(Debug)]
pub struct Opening<D> {
    /// The machine.
    pub machine: Machine,
    /// The same, compiled.
    pub program: Arc<Program<D>>,
    /// Where its scripts lie.
    pub files: StateFiles,
    /// The reference's config, as far as it concerns a run.
    pub config: Config,
    /// How much the journal keeps: without values, none need be made ready for it.
    pub keeping: Keeping,
    /// The folder of large values, if there is a journal; made when first needed.
    pub values: Option<PathBuf>,
}
