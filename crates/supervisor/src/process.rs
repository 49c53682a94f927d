//! The process of a runner: its start, its forced end, and a description of its exit.
//!
//! The runner leads its own process group, so that neither Ctrl-C nor a closed terminal affects it. It inherits only one end of a
//! socket pair.
//!
//! If the caller has a terminal, the runner inherits a standard input that is a file or a pipe, but not the terminal: the kernel would
//! stop a background group that reads from it. It writes to pipes, which the runner itself reads and logs during the run. The
//! caller reads them after the end of the control connection. A *detached* runner depends on nothing that ends with the caller: it has no
//! input, and writes to a file that is locked while any of its processes can write to it.

use crate::{
    Interpreter, NoExtension, NoInterpreter, ProgramEnvironment, descriptors, find_extension,
};
use parking_lot::Mutex;
use rustix::io::FdFlags;
use rustix::process::{Pid, Signal};
use std::fmt;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, IsTerminal as _};
use std::os::fd::AsRawFd as _;
use std::os::unix::fs::OpenOptionsExt as _;
use std::os::unix::net::UnixStream;
use std::os::unix::process::{CommandExt as _, ExitStatusExt as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};

const BOOTSTRAP: &str = include_str!("bootstrap.py");
/// Exit status of a runner that ended itself because a script ignored its grace period.
const CUT_OFF: i32 = 86;
/// Exit status of a runner that ended itself because its engine failed.
const BROKEN: i32 = 87;
/// Exit status of a runner that ended itself because its engine did not react to a stop.
const UNREACHED: i32 = 88;

/// Held while a socket can be inherited. A runner that starts at that moment would keep it open, and the end of the socket's owner
/// would go unnoticed.
pub(crate) static INHERITING: Mutex<()> = Mutex::new(());

/// Interpreter and extension for a runner.
#[derive(Debug, Clone)]
pub struct Start {
    /// The interpreter of the runner.
    pub interpreter: Interpreter,
    /// Path of the extension.
    pub extension: PathBuf,
}

/// A runner that was started.
#[derive(Debug)]
pub struct Process {
    /// The process. Its standard output and error are pipes, unless it is detached.
    pub child: Child,
    /// The caller's end of the control socket.
    pub control: UnixStream,
}

/// The process group of a runner.
#[derive(Debug, Clone, Copy)]
pub struct Group(Pid);

/// The runner was not started.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// No interpreter was found.
    #[error(transparent)]
    NoInterpreter(#[from] NoInterpreter),
    /// The extension was not found.
    #[error(transparent)]
    NoExtension(#[from] NoExtension),
    /// The control socket cannot be created.
    #[error("cannot create a pair of sockets")]
    Sockets(#[source] io::Error),
    /// The control socket cannot be made inheritable.
    #[error("cannot pass the socket to the runner")]
    Inherit(#[source] io::Error),
    /// The file for its output cannot be opened.
    #[error("cannot open {} for the output of the runner: its folder must exist and belong to you", file.display())]
    Output {
        /// Path of the file.
        file: PathBuf,
        /// The error of the system call.
        source: io::Error,
    },
    /// The interpreter cannot be started.
    #[error("cannot start the Python interpreter `{interpreter}`: {}", interpreter.way_out())]
    Interpreter {
        /// The interpreter that was selected.
        interpreter: Interpreter,
        /// The error of the system call.
        source: io::Error,
    },
}

impl Start {
    /// Finds interpreter and extension. `named` selects an interpreter.
    pub fn find(
        named: Option<&Path>,
        environment: &ProgramEnvironment,
    ) -> Result<Self, StartError> {
        let interpreter = Interpreter::choose(named, environment)?;
        Ok(Self { interpreter, extension: find_extension(environment)? })
    }

    /// Starts a runner for a caller with a terminal. `has_keys` means that its user can answer questions.
    pub fn spawn(&self, has_keys: bool) -> Result<Process, StartError> {
        let stdin = if io::stdin().is_terminal() { Stdio::null() } else { Stdio::inherit() };
        self.start([stdin, Stdio::piped(), Stdio::piped()], has_keys)
    }

    /// Starts a runner that outlives the caller. Appends its output to this file, which is readable for its owner only.
    pub fn spawn_detached(&self, output: &Path) -> Result<Process, StartError> {
        let failed = |source| StartError::Output { file: output.to_path_buf(), source };
        let stdout = open(output).map_err(failed)?;
        stdout.lock_shared().map_err(failed)?;
        let stderr = stdout.try_clone().map_err(failed)?;
        self.start([Stdio::null(), stdout.into(), stderr.into()], false)
    }

    fn start(
        &self,
        [stdin, stdout, stderr]: [Stdio; 3],
        has_keys: bool,
    ) -> Result<Process, StartError> {
        let _inheriting = INHERITING.lock();
        let (control, theirs) = UnixStream::pair().map_err(StartError::Sockets)?;
        let mut command = Command::new(&self.interpreter.program);
        command
            .args(["-c", BOOTSTRAP])
            .env("RAFCON_EXTENSION_FILE", &self.extension)
            .env("RAFCON_CONTROL_FD", theirs.as_raw_fd().to_string())
            .env("RAFCON_READS_OUTPUT", "1")
            .env("RAFCON_HAS_KEYS", if has_keys { "1" } else { "" })
            .stdin(stdin)
            .stdout(stdout)
            .stderr(stderr)
            .process_group(0);
        rustix::io::fcntl_setfd(&theirs, FdFlags::empty())
            .map_err(|error| StartError::Inherit(error.into()))?;
        let child = command.spawn().map_err(|source| StartError::Interpreter {
            interpreter: self.interpreter.clone(),
            source,
        })?;
        // The runner may have exited already.
        descriptors::restore(&child).unwrap_or_default();
        Ok(Process { child, control })
    }
}

fn open(output: &Path) -> io::Result<File> {
    OpenOptions::new().append(true).create(true).mode(0o600).open(output)
}

/// True if a detached runner with this output file lives, or a process that it started. It need not have written anything, and its
/// starter may have exited.
pub fn is_alive(output: &Path) -> bool {
    let Ok(file) = File::open(output) else { return false };
    matches!(file.try_lock(), Err(TryLockError::WouldBlock))
}

impl Process {
    /// The process group of this runner, which [`Group::kill`] ends.
    pub fn group(&self) -> Group {
        Group(Pid::from_child(&self.child))
    }
}

impl Group {
    /// Kills all processes of the group. Ignores a group that no longer exists.
    pub fn kill(self) {
        rustix::process::kill_process_group(self.0, Signal::KILL).unwrap_or_default();
    }
}

/// The exit of a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exit(pub ExitStatus);

impl Exit {
    /// True if the runner ended itself because a script did not end in its grace period.
    pub fn is_cut_off(self) -> bool {
        self.0.code() == Some(CUT_OFF)
    }

    /// True if the runner ended itself to stop the run.
    pub fn is_stopped(self) -> bool {
        self.0.code() == Some(UNREACHED)
    }
}

impl fmt::Display for Exit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.0.signal(), self.0.code()) {
            (Some(signal), _) => {
                let name = signal_hook::low_level::signal_name(signal).unwrap_or("unknown signal");
                write!(f, "killed by signal {signal} ({name})")
            }
            (None, Some(BROKEN)) => f.write_str("RAFCON's engine failed; please report this"),
            (None, Some(UNREACHED)) => f.write_str(
                "the engine did not react to a stop in time, and the process ended itself",
            ),
            (None, Some(code)) => write!(f, "exit status {code}"),
            (None, None) => f.write_str("ended"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Exit;
    use std::os::unix::process::ExitStatusExt as _;
    use std::process::ExitStatus;

    #[test]
    fn an_exit_is_told_in_words() {
        let told = |raw| {
            let exit = Exit(ExitStatus::from_raw(raw));
            (exit.to_string(), exit.is_cut_off())
        };
        assert_eq!(told(0), ("exit status 0".to_owned(), false));
        assert_eq!(told(86 << 8), ("exit status 86".to_owned(), true));
        let engine_failed = "RAFCON's engine failed; please report this";
        assert_eq!(told(87 << 8), (engine_failed.to_owned(), false));
        assert_eq!(told(11), ("killed by signal 11 (SIGSEGV)".to_owned(), false));
    }
}
