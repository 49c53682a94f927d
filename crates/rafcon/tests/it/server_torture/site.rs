//! A server, a run that it started, and how both are killed. Knows processes, but not what clients are told.

use crate::harness::Place;
use crate::served::{Door, Served};
use crate::torture::{Dice, TREMBLES, tremble};
use rafcon_storage::journal::{Reader, has_begun, writer_of};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};
use std::fs::{self, OpenOptions};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;
use std::{fmt, thread};

/// So often a runner is looked for that is started.
const LOOKS: u32 = 20_000;

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
    early: Early,
}

/// How many were killed while a runner began.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Early {
    /// Before the run had begun.
    pub(super) starting: u64,
    /// Before it was resumed.
    pub(super) resuming: u64,
    /// A moment too late for that.
    pub(super) late: u64,
}

impl<'p> Site<'p> {
    /// A server that has started a run of the machine in `project/machine`, which continues by itself when its runner dies. While
    /// it is started these are killed, one after the other, and the same is asked again.
    pub(super) fn new(place: &'p Place, policy: &str, victims: &[Victim], dice: &mut Dice) -> Self {
        let served = serve(place);
        let projects = served.door().ask("GET", "/api/v1/projects", None).unwrap();
        let machine = json!({ "project": projects[0]["id"], "path": "machine" });
        let start = json!({ "id": "torture", "machine": machine, "on_crash": policy });
        let mut now = Now { served, generation: 0, deaths: Vec::new(), early: Early::default() };
        let mut known = None;
        for victim in victims {
            known = now.start(place, &start, Some((*victim, dice.roll(TREMBLES)))).or(known);
        }
        let run = loop {
            if let Some(run) = now.start(place, &start, None) {
                break run;
            }
        };
        assert_eq!(known.unwrap_or_else(|| run.clone()), run, "the same request, another run");
        assert_eq!(runs(place), [run.as_str()], "one request, several runs");
        Self { place, run, now: Mutex::new(now) }
    }

    /// How many were killed while a runner began.
    pub(super) fn early(&self) -> Early {
        self.now().early
    }

    /// Where the server is now, and how many were there before it.
    pub(super) fn door(&self) -> (Door, u32) {
        let now = self.now();
        (now.served.door().clone(), now.generation)
    }

    /// Kills, and starts a server again if there is none left; then the runner that resumes the run, after trembling so often.
    /// Whether there was anything to kill.
    pub(super) fn kill(&self, victim: Victim, again: Option<u64>) -> bool {
        let mut now = self.now();
        let has_runner = self.is_alive();
        if victim != Victim::Server && !has_runner {
            return false;
        }
        if victim == Victim::Both {
            now.served.kill();
        }
        let mut killed = None;
        if victim != Victim::Server {
            now.deaths.push(now_ms());
            killed = self.kill_runner();
        }
        if victim != Victim::Runner {
            now.served.kill();
            now.served = serve(self.place);
            now.generation += 1;
        }
        if let Some(times) = again.filter(|_| victim != Victim::Server) {
            let before = events(&self.folder());
            if let Some(runner) = (0..LOOKS).find_map(|_| now.runner(killed)) {
                tremble(times);
                let is_early = events(&self.folder()) == before;
                now.deaths.push(now_ms());
                kill_process(runner, Signal::KILL).unwrap_or_default();
                now.early.count(|early| &mut early.resuming, is_early);
            }
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

    /// Which one, if there was any.
    fn kill_runner(&self) -> Option<Pid> {
        let writer = writer_of(&self.folder()).ok().flatten();
        let runner = writer.and_then(|pid| Pid::from_raw(pid.cast_signed()))?;
        // It may have ended by itself in the meantime.
        kill_process(runner, Signal::KILL).unwrap_or_default();
        Some(runner)
    }
}

impl Early {
    fn count(&mut self, place: impl FnOnce(&mut Self) -> &mut u64, is_early: bool) {
        *if is_early { place(self) } else { &mut self.late } += 1;
    }
}

impl Now {
    /// Asks for the run, and kills meanwhile; the run's id if there is an answer.
    fn start(
        &mut self,
        place: &Place,
        start: &Value,
        kill: Option<(Victim, u64)>,
    ) -> Option<String> {
        let door = self.served.door().clone();
        let asked = thread::scope(|scope| {
            let asked = scope.spawn(|| door.answer("POST", "/api/v1/runs", Some(start)));
            if let Some((victim, times)) = kill {
                tremble(times);
                self.kill_early(place, victim);
            }
            asked.join().unwrap()
        });
        if kill.is_some_and(|(victim, _)| victim != Victim::Runner) {
            self.served = serve(place);
            self.generation += 1;
        }
        // Whoever gets no answer asks again.
        let (status, text) = asked.ok()?;
        assert_eq!(status, 200, "{text}");
        let run: Value = serde_json::from_str(&text).unwrap();
        Some(run["id"].as_str().unwrap().to_owned())
    }

    fn kill_early(&mut self, place: &Place, victim: Victim) {
        let folder = runs(place).first().map(|run| place.path("runs").join(run));
        let is_early = !folder.as_deref().is_some_and(has_begun);
        if victim == Victim::Server {
            self.served.kill();
        } else if let Some(runner) = self.runner(None) {
            if victim == Victim::Both {
                self.served.kill();
            }
            if !is_early {
                self.deaths.push(now_ms());
            }
            kill_process(runner, Signal::KILL).unwrap_or_default();
        } else if victim == Victim::Both {
            self.served.kill();
        } else {
            return;
        }
        self.early.count(|early| &mut early.starting, is_early);
    }

    /// The runner that this server has started last, if it is not this one.
    fn runner(&self, known: Option<Pid>) -> Option<Pid> {
        let tasks = fs::read_dir(format!("/proc/{}/task", self.served.pid())).ok()?;
        let children = tasks.flatten().filter_map(|task| {
            let children = fs::read_to_string(task.path().join("children")).ok()?;
            children.split_whitespace().filter_map(|pid| pid.parse::<i32>().ok()).max()
        });
        children.max().and_then(Pid::from_raw).filter(|pid| Some(*pid) != known)
    }
}

/// The folders of runs that were asked for. A server that dies before it has written that down leaves an empty one.
fn runs(place: &Place) -> Vec<String> {
    let entries = fs::read_dir(place.path("runs")).into_iter().flatten().flatten();
    let entries = entries.filter(|entry| entry.path().join("request.json").exists());
    entries.map(|entry| entry.file_name().into_string().unwrap()).collect()
}

/// How many events the run in this folder has.
fn events(folder: &Path) -> u64 {
    Reader::open(folder).and_then(|reader| reader.last_sequence()).unwrap_or_default()
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
pub(crate) fn now_ms() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap();
    u64::try_from(since.as_millis()).unwrap()
}
