//! A server with a project, and the runs that it is asked for; all of it is gone when the figure is taken.

use crate::served::{Door, Line, Served};
use anyhow::{Context as _, Result, ensure};
use rafcon_protocol::Event;
use rafcon_protocol::api::HistoryEntry;
use rafcon_protocol::socket::{ToClient, ToServer, Topic};
use rafcon_storage::journal::writer_of;
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// The number of every subscription to a history.
pub(crate) const HISTORY: u32 = 1;

/// A server in a folder of its own.
#[derive(Debug)]
pub(crate) struct BenchServer {
    folder: TempDir,
    served: Served,
    project: String,
}

impl BenchServer {
    pub(crate) fn new() -> Result<Self> {
        let folder = tempfile::tempdir()?;
        fs::create_dir(folder.path().join("project"))?;
        let words = "serve project --bind 127.0.0.1:0 --state state --runs runs";
        let mut serve = rafcon();
        serve.args(words.split_whitespace()).current_dir(folder.path());
        serve.env("HOME", folder.path()).env_remove("RAFCON_LIBRARY_PATH");
        let served = Served::start(serve)?;
        let projects = served.door().ask("GET", "/api/v1/projects", None)?;
        let project = projects[0]["id"].as_str().context("there is no project")?.to_owned();
        Ok(Self { folder, served, project })
    }

    pub(crate) fn door(&self) -> &Door {
        self.served.door()
    }

    /// The server's process.
    pub(crate) fn pid(&self) -> u32 {
        self.served.pid()
    }

    /// A place beside the project.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Puts a machine into the project.
    pub(crate) fn machine(&self, name: &str, text: &str) -> Result<()> {
        let machine = notation::parse(text).context("a machine of the bench")?;
        save(&machine, &self.path("project").join(name), None, Naming::default())?;
        Ok(())
    }

    /// Puts a generated mission of so many states there.
    pub(crate) fn mission(&self, name: &str, states: usize) -> Result<()> {
        let mut new = rafcon();
        new.arg("new").arg(self.path("project").join(name));
        new.args(["--template", "mission", "--states", &states.to_string()]);
        ensure!(new.stdout(Stdio::null()).status()?.success(), "rafcon new failed");
        Ok(())
    }

    /// A machine of the project, as requests name it.
    pub(crate) fn file(&self, name: &str) -> Value {
        json!({ "project": self.project, "path": name })
    }

    /// Starts a run; gives its id.
    pub(crate) fn start(&self, machine: &str) -> Result<String> {
        let start = json!({ "id": machine, "machine": self.file(machine) });
        let run = self.door().ask("POST", "/api/v1/runs", Some(&start))?;
        Ok(run["id"].as_str().context("a run without an id")?.to_owned())
    }

    /// A WebSocket that follows the history of a run, without values.
    pub(crate) fn follow(&self, run: &str) -> Result<Line> {
        let mut line = self.door().line()?;
        let topic = Topic::RunHistory { run: run.to_owned(), from: 1, values: false };
        line.say(&ToServer::Subscribe { subscription: HISTORY, topic })?;
        Ok(line)
    }
}

impl Drop for BenchServer {
    fn drop(&mut self) {
        let runs = fs::read_dir(self.path("runs")).into_iter().flatten().flatten();
        for run in runs {
            let writer = writer_of(&run.path()).ok().flatten();
            if let Some(pid) = writer.and_then(|pid| Pid::from_raw(pid.cast_signed())) {
                kill_process(pid, Signal::KILL).unwrap_or_default();
            }
        }
    }
}

fn rafcon() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rafcon"));
    // Users let Python keep compiled modules.
    command.env_remove("PYTHONDONTWRITEBYTECODE");
    command
}

/// Shows every event of a history until `see` gives something; with it come the frames of other kinds.
pub(crate) fn until<T>(
    line: &mut Line,
    mut see: impl FnMut(&mut Line, Heard<'_>) -> Result<Option<T>>,
) -> Result<T> {
    loop {
        match line.hear()? {
            ToClient::Events { events, .. } => {
                for event in &events {
                    if let Some(seen) = see(line, Heard::Event(event))? {
                        return Ok(seen);
                    }
                }
            }
            frame => {
                if let Some(seen) = see(line, Heard::Other(&frame))? {
                    return Ok(seen);
                }
            }
        }
    }
}

/// What a client hears.
#[derive(Debug)]
pub(crate) enum Heard<'f> {
    /// An event of the history.
    Event(&'f HistoryEntry),
    /// Another frame.
    Other(&'f ToClient),
}

/// The times that a machine left in a global variable, if the run is over.
pub(crate) fn noted(event: &Event, variable: &str) -> Result<Option<Vec<f64>>> {
    let Event::Finished { globals, .. } = event else { return Ok(None) };
    let times = globals.get(variable).and_then(Value::as_array).context("nothing was noted")?;
    let times = times.iter().map(|ns| Some(crate::clock::noted_ms(integer(ns)?)));
    Ok(Some(times.collect::<Option<_>>().context("a time that is none")?))
}

/// An integer of any size up to 64 bits, as `docs/protocol.md` encodes it.
fn integer(value: &Value) -> Option<i64> {
    value.as_i64().or_else(|| value.get("__int__")?.as_str()?.parse().ok())
}

/// Whether the run has come to its end.
pub(crate) fn is_over(heard: &Heard<'_>) -> bool {
    matches!(heard, Heard::Event(HistoryEntry { event: Event::Finished { .. }, .. }))
}
