//! A server, a run that it started, and how both are killed. Knows processes; must never know what clients are told.

use crate::harness::Place;
use crate::served::{Door, Served};
use rafcon_storage::journal::writer_of;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::json;
use std::fmt;
use std::fs::OpenOptions;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// What is killed, with `kill -9`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Victim {
    Server,
    Runner,
    Both,
}

/// One run under one server after the other.
pub(super) struct Site<'p> {
    place: &'p Place,
    /// The run's id.
    pub(super) run: String,
    now: Mutex<Now>,
}

#[derive(Debug)]
struct Now {
    served: Served,
    /// How many servers there were before this one.
    generation: u32,
    /// When runners were killed, in ms since 1970.
    deaths: Vec<u64>,
}

impl<'p> Site<'p> {
    /// A server that has started a run of the machine in `project/machine`, which goes on by itself when its runner dies.
    pub(super) fn new(place: &'p Place, policy: &str) -> Self {
        let served = serve(place);
        let door = served.door();
        let projects = door.ask("GET", "/api/v1/projects", None).unwrap();
        let machine = json!({ "project": projects[0]["id"], "path": "machine" });
        let start = json!({ "id": "torture", "machine": machine, "on_crash": policy });
        let run = door.ask("POST", "/api/v1/runs", Some(&start)).unwrap();
        let run = run["id"].as_str().unwrap().to_owned();
        let now = Now { served, generation: 0, deaths: Vec::new() };
        Self { place, run, now: Mutex::new(now) }
    }

    /// Where the server is now, and how many were there before it.
    pub(super) fn door(&self) -> (Door, u32) {
        let now = self.now();
        (now.served.door().clone(), now.generation)
    }

    /// Kills, and starts a server again if there is none left. Whether there was anything to kill.
    pub(super) fn kill(&self, victim: Victim) -> bool {
        let mut now = self.now();
        let has_runner = self.is_alive();
        if victim != Victim::Server && !has_runner {
            return false;
        }
        if victim == Victim::Both {
            now.served.kill();
        }
        if victim != Victim::Server {
            now.deaths.push(now_ms());
            self.kill_runner();
        }
        if victim != Victim::Runner {
            now.served.kill();
            now.served = serve(self.place);
            now.generation += 1;
        }
        true
    }

    /// When runners were killed, in ms since 1970.
    pub(super) fn deaths(&self) -> Vec<u64> {
        self.now().deaths.clone()
    }

    fn now(&self) -> MutexGuard<'_, Now> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn folder(&self) -> PathBuf {
        self.place.path("runs").join(&self.run)
    }

    fn is_alive(&self) -> bool {
        writer_of(&self.folder()).unwrap().is_some()
    }

    fn kill_runner(&self) {
        let writer = writer_of(&self.folder()).ok().flatten();
        let runner = writer.and_then(|pid| Pid::from_raw(pid.cast_signed()));
        if let Some(runner) = runner {
            // It may have ended by itself in the meantime.
            kill_process(runner, Signal::KILL).unwrap_or_default();
        }
    }
}

impl fmt::Debug for Site<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let about =
            self.now().served.door().ask("GET", &format!("/api/v1/runs/{}", self.run), None);
        f.debug_struct("Site").field("run", &about).field("has_runner", &self.is_alive()).finish()
    }
}

impl Drop for Site<'_> {
    fn drop(&mut self) {
        self.now().served.kill();
        self.kill_runner();
    }
}

fn serve(place: &Place) -> Served {
    let words = "serve project --bind 127.0.0.1:0 --state state --runs runs --keep-token";
    let mut command = place.command(words);
    let errors = OpenOptions::new().create(true).append(true).open(place.path("said"));
    command.stderr(errors.unwrap());
    Served::start(command).unwrap()
}

/// Time of day, in ms since 1970 UTC.
#[expect(clippy::disallowed_methods, reason = "an expiry is a time of day")]
pub(super) fn now_ms() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap();
    u64::try_from(since.as_millis()).unwrap()
}
