//! The runners of machines, as whoever starts them sees them: how one becomes a process, how a run that is going on is
//! joined, what a dead runner left, and whether another takes the run up.
//!
//! Knows interpreter, extension, processes and the folders of runs. Must never know HTTP, terminals, or what a run means to
//! whoever follows it: the command line and the server both do, each in its own way.
//!
//! ```no_run
//! use rafcon_supervisor::{Interpreter, Process, Runs, Start, ProgramEnvironment, extension};
//!
//! fn start(surroundings: &ProgramEnvironment) -> Result<Process, Box<dyn std::error::Error>> {
//!     let interpreter = Interpreter::choose(None, surroundings)?;
//!     let extension = extension::find(surroundings)?;
//!     let folder = Runs::new(None, surroundings)?.make("pick")?;
//!     println!("its files will be in {}", folder.display());
//!     Ok(Start { interpreter: &interpreter, extension: &extension }.spawn()?)
//! }
//! ```

pub mod clock;
mod connection;
mod exit;
pub mod extension;
mod interpreter;
mod process;
mod program_environment;
pub mod remains;
mod restart_policy;
mod resume;
mod runs;

pub use connection::{BeginError, JoinError, begin, connect};
pub use exit::Exit;
pub use extension::NoExtension;
pub use interpreter::{Interpreter, NoInterpreter};
pub use process::{Group, Process, Start, StartError, is_alive};
pub use program_environment::ProgramEnvironment;
pub use restart_policy::{Next, RestartPolicy, RunnerDeath};
pub use resume::{machine_of, policy_of, resume_launch};
pub use runs::{FindError, MakeError, Runs, meant};
