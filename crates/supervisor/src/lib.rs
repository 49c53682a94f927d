//! The runners of machines, as whoever starts them sees them: how one becomes a process, how a run that is going on is
//! joined, what a dead runner left, and whether another resumes the run. And the engines that plan for machines.
//!
//! Knows interpreter, extension, processes and the folders of runs. Knows nothing of HTTP, terminals, or what a run means to
//! whoever follows it: the command line and the server both do, each in its own way.
//!
//! ```no_run
//! use rafcon_supervisor::{Process, ProgramEnvironment, Runs, Start};
//!
//! fn start(surroundings: &ProgramEnvironment) -> Result<Process, Box<dyn std::error::Error>> {
//!     let folder = Runs::new(None, surroundings)?.make("pick")?;
//!     println!("its files will be in {}", folder.display());
//!     Ok(Start::find(None, surroundings)?.spawn(false)?)
//! }
//! ```

pub mod clock;
mod connection;
pub mod descriptors;
mod interpreter;
pub mod planning;
mod process;
pub mod remains;
mod restart_policy;
mod ros_bridge;
mod runs;

pub use connection::{BeginError, JoinError, begin, connect, connect_once_listening};
pub use interpreter::{
    Interpreter, NoExtension, NoInterpreter, ProgramEnvironment, find_extension,
};
pub use process::{Exit, Group, Process, Start, StartError, is_alive};
pub use remains::{KeptRun, kept_machine, machine_of, policy_of, resume_launch};
pub use restart_policy::{Next, RestartPolicy, RunnerDeath};
pub use ros_bridge::{RosBridge, RosBridgeSettings};
pub use runs::{FindError, MakeError, Runs, meant};
