//! Finds the processes that an engine has started, also those that left its process group and whose parents have exited. They
//! inherit an environment variable whose value no other engine has.

use rustix::process::{Pid, Signal, kill_process};
use rustix::rand::{GetRandomFlags, getrandom};
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::process::Command;

/// Name of the environment variable of an engine and its descendants.
const VARIABLE: &str = "RAFCON_ENGINE";
/// Maximum number of rounds of a search: processes can start others while they are killed.
const ROUNDS_MAX: usize = 20;

/// The descendants of one engine.
#[derive(Debug)]
pub(super) struct Descendants {
    /// `NAME=VALUE`, as in the environment of the processes.
    entry: String,
}

impl Descendants {
    /// Marks all processes that `command` will start.
    ///
    /// # Errors
    /// Fails if the system provides no random number.
    pub(super) fn of(command: &mut Command) -> io::Result<Self> {
        let mut random = [0; 8];
        getrandom(&mut random, GetRandomFlags::empty())?;
        let value = format!("{:016x}", u64::from_ne_bytes(random));
        command.env(VARIABLE, &value);
        Ok(Self { entry: format!("{VARIABLE}={value}") })
    }

    /// Kills all living descendants. Misses a program that has cleared its environment.
    pub(super) fn kill(&self) {
        let mut killed = BTreeSet::new();
        for _ in 0..ROUNDS_MAX {
            let mut has_new = false;
            for pid in self.alive() {
                // It may have exited by itself.
                kill_process(pid, Signal::KILL).unwrap_or_default();
                has_new |= killed.insert(pid.as_raw_nonzero());
            }
            if !has_new {
                return;
            }
        }
    }

    /// Zombies have no environment, so they are not among them.
    fn alive(&self) -> impl Iterator<Item = Pid> {
        let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
        processes.filter_map(|process| {
            let pid = Pid::from_raw(process.file_name().to_str()?.parse().ok()?)?;
            let environment = fs::read(process.path().join("environ")).ok()?;
            let mut entries = environment.split(|byte| *byte == 0);
            entries.any(|entry| entry == self.entry.as_bytes()).then_some(pid)
        })
    }
}
