//! Starting a runner and ending it by force.
//!
//! The runner leads a process group of its own, so that neither Ctrl-C nor a terminal that hangs up reaches it. It
//! inherits one end of a socket pair and nothing else of ours. Its standard input is ours if that is a file or a pipe; a
//! terminal stays with us, for a background group that reads from it would be stopped by the kernel.

use crate::Interpreter;
use rustix::io::FdFlags;
use rustix::process::{Pid, Signal};
use std::io::{self, IsTerminal as _};
use std::os::fd::AsRawFd as _;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};

const BOOTSTRAP: &str = include_str!("bootstrap.py");

/// What is needed to start a runner.
#[derive(Debug, Clone, Copy)]
pub struct Start<'a> {
    /// Which Python.
    pub interpreter: &'a Interpreter,
    /// The extension's file.
    pub extension: &'a Path,
}

/// A runner that was started.
#[derive(Debug)]
pub struct Process {
    /// The process; its standard output and error are pipes.
    pub child: Child,
    /// Our end of the control socket.
    pub control: UnixStream,
}

/// The process group of a runner.
#[derive(Debug, Clone, Copy)]
pub struct Group(Pid);

/// Why a runner was not started.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// There is no control socket.
    #[error("cannot make a pair of sockets")]
    Sockets(#[source] io::Error),
    /// The control socket stays with us.
    #[error("cannot let the runner inherit its socket")]
    Inherit(#[source] io::Error),
    /// The interpreter cannot be started.
    #[error("cannot start the Python interpreter `{interpreter}`: {}", interpreter.way_out())]
    Interpreter {
        /// Which one.
        interpreter: Interpreter,
        /// Why not.
        source: io::Error,
    },
}

impl Start<'_> {
    /// Starts it.
    pub fn spawn(&self) -> Result<Process, StartError> {
        let (control, theirs) = UnixStream::pair().map_err(StartError::Sockets)?;
        let mut command = Command::new(&self.interpreter.program);
        command
            .args(["-c", BOOTSTRAP])
            .env("RAFCON_EXTENSION_FILE", self.extension)
            .env("RAFCON_CONTROL_FD", theirs.as_raw_fd().to_string())
            .stdin(if io::stdin().is_terminal() { Stdio::null() } else { Stdio::inherit() })
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .process_group(0);
        rustix::io::fcntl_setfd(&theirs, FdFlags::empty())
            .map_err(|error| StartError::Inherit(error.into()))?;
        let child = command.spawn().map_err(|source| StartError::Interpreter {
            interpreter: self.interpreter.clone(),
            source,
        })?;
        Ok(Process { child, control })
    }
}

impl Process {
    /// The group that [`Group::kill`] ends.
    pub fn group(&self) -> Group {
        Group(Pid::from_child(&self.child))
    }
}

impl Group {
    /// Ends every process of the group at once. A group that is gone is what was wanted.
    pub fn kill(self) {
        rustix::process::kill_process_group(self.0, Signal::KILL).unwrap_or_default();
    }
}
