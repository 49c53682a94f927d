//! Runners of machines, for the programs that start them: starting a process, joining an active run, leftovers of a dead
//! runner, and the decision to resume a run. Also the engines that plan for machines.
//!
//! Knows interpreter, extension, processes and the folders of runs. Does not know HTTP, terminals, or the viewers of a run: the
//! command line and the server add these.
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
pub mod crash_artifacts;
pub mod descriptors;
mod interpreter;
pub mod planning;
mod process;
mod restart_policy;
mod ros_bridge;
mod runs;

pub use connection::{BeginError, JoinError, begin, connect, connect_once_listening};
pub use crash_artifacts::{KeptRun, kept_machine, machine_of, policy_of, resume_launch};
pub use interpreter::{
    Interpreter, NoExtension, NoInterpreter, ProgramEnvironment, find_extension,
};
pub use process::{Exit, Group, Process, Start, StartError, is_alive};
pub use restart_policy::{Next, RestartPolicy, RunnerDeath};
pub use ros_bridge::{RosBridge, RosBridgeSettings};
pub use runs::{FindError, MakeError, Runs, meant};
