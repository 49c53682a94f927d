//! Runs: their list, start, state and control.
//!
//! Each run is a folder. An active run has a separate process, which outlives the server and is reached over the socket in that
//! folder. Knows HTTP only for its own routes. Does not know the effect of commands in a runner.

mod at_robot;
mod authority;
mod command_lists;
mod commands;
mod contacts;
mod control;
mod event_group;
mod folder_files;
mod launch;
mod leftovers;
mod link;
mod pace;
mod pulse;
mod resume;
mod ring;
mod routes;
mod run;
mod start;
mod start_requests;
mod summary;
mod supervise;
mod talk;
mod watch;
mod watched;

pub use authority::RunAuthority;
pub(crate) use commands::command;
pub(crate) use event_group::EventGroup;
pub(crate) use ring::EventsPage;
pub(crate) use routes::routes;
pub(crate) use run::Run;
pub(crate) use watched::{WatchedNow, Watcher, frame as watched_frame};

use crate::change_counters::ChangeCounters;
use crate::{Failure, ServerState, Settings};
use folder_files::RunRequest;
use rafcon_locks::Mutex;
use rafcon_protocol::api::{RunPhase, RunSummary};
use rafcon_storage::journal::folder::check_run_id;
use rafcon_supervisor::{MakeError, Runs as Folder, clock, policy_of};
use start_requests::{StartRequestState, StartRequests};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use summary::FolderSummary;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, watch as tokio_watch};
use tokio::task::spawn_blocking;
use tokio::time::timeout;

/// Maximum number of parallel starts: each holds a thread until its machine is loaded.
const LAUNCHES: usize = 4;
/// Timeout for a slot to start.
const TURN_TIMEOUT: Duration = Duration::from_secs(30);

/// Timeout for measuring the runs on disk.
const DISK_TIMEOUT: Duration = Duration::from_millis(300);

/// Active and finished runs.
#[derive(Debug)]
pub(crate) struct Runs {
    folder: Folder,
    all: Mutex<BTreeMap<String, Arc<Run>>>,
    requests: StartRequests,
    launches: Arc<Semaphore>,
    /// Held while the runs on disk are measured.
    measuring: Arc<Semaphore>,
    /// `true` once the folder was read.
    known: tokio_watch::Sender<bool>,
    watch: Mutex<Option<watch::RunFolderWatch>>,
    news: tokio_watch::Sender<u64>,
}

impl Runs {
    /// The runs in the folder of the settings, before it is read.
    pub(crate) fn new(settings: &Settings, news: &ChangeCounters) -> Result<Self, MakeError> {
        Ok(Self {
            folder: Folder::new(Some(&settings.runs), &settings.environment)?,
            all: Mutex::default(),
            requests: StartRequests::default(),
            launches: Arc::new(Semaphore::new(LAUNCHES)),
            measuring: Arc::new(Semaphore::new(1)),
            known: tokio_watch::Sender::new(false),
            watch: Mutex::default(),
            news: news.counter_of_runs(),
        })
    }

    /// Folder that contains the runs' folders.
    pub(crate) fn folder(&self) -> &Folder {
        &self.folder
    }

    /// Summaries of all runs, newest first.
    pub(crate) async fn list(&self) -> Vec<RunSummary> {
        self.wait_until_known().await;
        let runs: Vec<_> = self.all.lock().values().rev().cloned().collect();
        let plain = || runs.iter().map(|run| run.summary()).collect();
        // A disk that hangs delays nobody's list, and blocks at most one thread.
        let Ok(turn) = Arc::clone(&self.measuring).try_acquire_owned() else { return plain() };
        let measured = runs.clone();
        let measure = spawn_blocking(move || {
            let _held = turn;
            measured.iter().map(|run| run.measured()).collect()
        });
        timeout(DISK_TIMEOUT, measure).await.ok().and_then(Result::ok).unwrap_or_else(plain)
    }

    /// Active runs, and those that changed since the server started; newest first.
    pub(crate) async fn lively(&self) -> Vec<RunSummary> {
        self.wait_until_known().await;
        let runs: Vec<_> = self.all.lock().values().rev().cloned().collect();
        runs.iter().filter(|run| run.is_lively()).map(|run| run.summary()).collect()
    }

    /// The run with this id.
    pub(crate) async fn get(&self, id: &str) -> Result<Arc<Run>, Failure> {
        if let Some(run) = self.known(id) {
            return Ok(run);
        }
        check_run_id(id).map_err(|bad| Failure::not_found("no_such_run", bad.to_string()))?;
        self.wait_until_known().await;
        self.known(id).ok_or_else(|| {
            let message = format!("there is no run `{id}`: GET /api/v1/runs lists them");
            Failure::not_found("no_such_run", message)
        })
    }

    /// Notes activity of a user, who is then not silent as the holder of control.
    pub(crate) fn heard(&self, user: &str) {
        let now_ms = clock::since_1970_ms();
        let runs: Vec<_> = self.all.lock().values().filter(|run| run.is_live()).cloned().collect();
        for run in runs {
            run.heard(user, now_ms);
        }
    }

    /// The folders of the known runs.
    fn folders(&self) -> Vec<PathBuf> {
        self.all.lock().values().map(|run| run.folder().to_path_buf()).collect()
    }

    pub(crate) fn known(&self, id: &str) -> Option<Arc<Run>> {
        self.all.lock().get(id).cloned()
    }

    /// True once the folder has been read.
    pub(crate) fn are_known(&self) -> bool {
        *self.known.borrow()
    }

    async fn wait_until_known(&self) {
        let mut known = self.known.subscribe();
        // The sender lives as long as this function.
        drop(known.wait_for(|known| *known).await);
    }

    /// Waits for a slot to start a runner.
    async fn turn(&self) -> Result<OwnedSemaphorePermit, Failure> {
        let turn = timeout(TURN_TIMEOUT, Arc::clone(&self.launches).acquire_owned()).await;
        turn.ok().and_then(Result::ok).ok_or_else(|| {
            let message = "too many runs are being started: wait until some of them have begun";
            Failure::too_many("too_many_starts", message).retry_after(TURN_TIMEOUT.as_secs())
        })
    }

    /// Applies the content of a run's folder. `None` removes a folder that is not a run, or no longer.
    fn found(
        &self,
        server: &ServerState,
        folder: &Path,
        looked: Option<FolderSummary>,
    ) -> Option<Arc<Run>> {
        let Some(looked) = looked else {
            self.forget_folder(folder);
            server.history.forget(folder);
            return None;
        };
        let mut all = self.all.lock();
        if let Some(run) = all.get(&looked.summary.id) {
            let run = Arc::clone(run);
            drop(all);
            if !run.is_claimed() {
                run.apply_summary(&looked.summary);
            }
            return Some(run);
        }
        let run = Arc::new(Run::new(server, folder.to_path_buf(), &looked.summary));
        if *self.known.borrow() {
            run.mark_changed();
        }
        all.insert(looked.summary.id.clone(), Arc::clone(&run));
        drop(all);
        // The folder may have been deleted since it was read.
        if !folder.is_dir() {
            self.forget_folder(folder);
            return None;
        }
        if let Some(key) = looked.request.and_then(|request| request.key()) {
            let is_open =
                matches!(looked.summary.phase, RunPhase::Starting | RunPhase::NotStarted { .. });
            self.requests.note(
                &key,
                if is_open {
                    StartRequestState::Open(folder.to_path_buf())
                } else {
                    StartRequestState::Begun(looked.summary.id.clone())
                },
            );
        }
        self.news.send_modify(|revision| *revision += 1);
        Some(run)
    }

    /// Removes a run whose folder was deleted.
    pub(crate) fn forget_folder(&self, folder: &Path) {
        let id = folder.file_name().unwrap_or_default().to_string_lossy();
        let gone = self.all.lock().remove(&*id);
        if let Some(run) = gone {
            // Notifies its remaining viewers.
            run.set_phase(RunPhase::Unreadable { reason: "its folder is missing".to_owned() });
        }
    }
}

/// Finds the existing runs and watches for new ones. Call once, within the runtime.
pub(crate) fn begin(server: &Arc<ServerState>) {
    let server = Arc::clone(server);
    tokio::spawn(async move {
        let noticed = watch::begin(&server);
        look_through(&server).await;
        server.runs.known.send_replace(true);
        watch::serve(&server, noticed).await;
    });
}

/// Reads all folders. The first read decides the fate of runs that crashed while the server was down.
async fn look_through(server: &Arc<ServerState>) {
    let here = Arc::clone(server);
    let all = spawn_blocking(move || {
        let folders = watch::folders(here.runs.folder.folder());
        let look = |folder: PathBuf| {
            let looked = summary::look(&folder, &here.projects)?;
            let policy = policy_of(&folder);
            Some((folder, looked, policy))
        };
        folders.into_iter().filter_map(look).collect::<Vec<_>>()
    });
    for (folder, looked, policy) in all.await.unwrap_or_default() {
        let phase = looked.summary.phase.clone();
        if matches!(phase, RunPhase::NotStarted { .. }) && RunRequest::is_forgotten(&folder) {
            watch::remove(server, folder).await;
            continue;
        }
        let is_to_follow = supervise::needs_somebody(&looked, policy);
        let Some(run) = server.runs.found(server, &folder, Some(looked)) else { continue };
        if is_to_follow {
            supervise::follow(server, &run);
        } else if phase == RunPhase::Starting {
            let server = Arc::clone(server);
            tokio::spawn(async move { supervise::await_beginning(&server, &folder).await });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{LAUNCHES, Runs};
    use crate::Settings;
    use crate::change_counters::ChangeCounters;

    #[tokio::test(start_paused = true)]
    async fn a_start_waits_for_others_and_is_refused_if_they_take_too_long() {
        let place = tempfile::tempdir().unwrap();
        let settings = Settings::new(place.path().join("state"), place.path().join("runs"));
        let runs = Runs::new(&settings, &ChangeCounters::default()).unwrap();
        let mut held = Vec::new();
        for _ in 0..LAUNCHES {
            held.push(runs.turn().await.unwrap());
        }
        assert_eq!(runs.turn().await.unwrap_err().code(), "too_many_starts");
        held.pop();
        assert!(runs.turn().await.is_ok());
    }
}
