//! Supervises a run: connects to its runner, reconnects after a broken link, and after the runner's death resumes the run by its
//! policy, or leaves the decision to a user.
//!
//! Knows the order of these steps. Does not know the requests.

use super::folder_files::RunRequest;
use super::launch::Launched;
use super::leftovers;
use super::link;
use super::resume;
use super::run::Run;
use super::summary::FolderSummary;
use crate::ServerState;
use crate::failure::reason;
use rafcon_protocol::OnCrash;
use rafcon_protocol::api::{RunPhase, RunSummary};
use rafcon_storage::journal::{has_begun, writer_of};
use rafcon_supervisor::{Exit, KeptRun, Next, RestartPolicy, clock, resume_launch};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// First interval before a reconnection. It doubles up to the longest.
const RECONNECT_MIN: Duration = Duration::from_millis(2);
/// The longest interval, see [`RECONNECT_MIN`].
const RECONNECT_MAX: Duration = Duration::from_secs(1);
/// Timeout for the exit status of the server's own process, once it has released its run.
const EXIT_STATUS_TIMEOUT: Duration = Duration::from_secs(1);

/// Reads a folder and publishes the result. `None` if it contains no run. A claimed run keeps the state that its supervisor has set.
pub(super) async fn look(server: &Arc<ServerState>, folder: PathBuf) -> Option<Arc<Run>> {
    let (here, there) = (Arc::clone(server), folder.clone());
    let look = move || super::summary::look(&there, &here.projects);
    let looked = tokio::task::spawn_blocking(look).await.ok().flatten();
    server.runs.found(server, &folder, looked)
}

/// Supervises the runner of a run, unless it is already claimed.
pub(super) fn follow(server: &Arc<ServerState>, run: &Arc<Run>) {
    if run.try_claim() {
        look_after(server, run);
    }
}

/// Supervises the runner of a claimed run.
fn look_after(server: &Arc<ServerState>, run: &Arc<Run>) {
    let (server, run) = (Arc::clone(server), Arc::clone(run));
    let life = RunSupervisor { server, run, lives: RestartPolicy::default(), control: None };
    tokio::spawn(life.go_on());
}

/// Supervises a runner that was just started, and waits until it accepts commands. `is_claimed` means that the caller has claimed
/// the run. The first connection counts as a viewer until then.
pub(super) async fn follow_ours(
    server: &Arc<ServerState>,
    run: &Arc<Run>,
    launched: Launched,
    is_claimed: bool,
) {
    let Launched { loaded, control, exit } = launched;
    if let Some(loaded) = loaded {
        run.set_loaded(loaded);
    }
    run.set_exit(exit);
    if is_claimed || run.try_claim() {
        look_after(server, run);
    }
    run.linked().await;
    drop(control);
}

/// Reads the folder of a run again, and supervises the run if it is live.
pub(super) async fn look_again(server: &Arc<ServerState>, run: &Run) {
    if let Some(run) = Box::pin(look(server, run.folder().to_path_buf())).await
        && run.summary().phase == RunPhase::Live
        && look_for_writer(&run).await
    {
        follow(server, &run);
    }
}

/// True if a process writes the run. A replica without a station has none, although its run may be active.
async fn look_for_writer(run: &Run) -> bool {
    let folder = run.folder().to_path_buf();
    let writer = tokio::task::spawn_blocking(move || writer_of(&folder)).await;
    matches!(writer, Ok(Ok(Some(_))))
}

/// Supervises the successive runners of one run.
struct RunSupervisor {
    server: Arc<ServerState>,
    run: Arc<Run>,
    lives: RestartPolicy,
    /// First connection to a runner that this server started, closed when the next one is open.
    control: Option<UnixStream>,
}

impl RunSupervisor {
    async fn go_on(mut self) {
        loop {
            self.until_it_is_dead().await;
            if !self.restart_if_due().await {
                break;
            }
        }
        // Another program may have resumed it in between.
        look_again(&self.server, &self.run).await;
    }

    /// Releases the claim, then publishes, so that a client that sees the state can resume the run.
    fn end(&self, summary: &RunSummary) -> bool {
        self.run.release();
        self.run.apply_summary(summary);
        false
    }

    /// Follows the runner until it dies.
    async fn until_it_is_dead(&mut self) {
        let mut pause = RECONNECT_MIN;
        loop {
            let held = self.control.take();
            let linked = {
                let run = Arc::clone(&self.run);
                let follow = link::follow(&run, || drop(held));
                follow.await.is_ok()
            };
            pause = if linked { RECONNECT_MIN } else { (pause * 2).min(RECONNECT_MAX) };
            if !look_for_writer(&self.run).await {
                return;
            }
            tokio::time::sleep(pause).await;
        }
    }

    /// Handles a dead runner. Returns `true` if another one follows; otherwise the claim is released.
    async fn restart_if_due(&mut self) -> bool {
        let exit = self.exit().await;
        let (server, folder) = (Arc::clone(&self.server), self.run.folder().to_path_buf());
        let look = move || {
            let looked = super::summary::look(&folder, &server.projects)?;
            let kept = KeptRun::of(&folder, None);
            let words = resume_launch(&folder, kept.policy, None);
            Some((looked, leftovers::death(&folder, exit), kept, words))
        };
        let Ok(Some((looked, mut death, kept, words))) = tokio::task::spawn_blocking(look).await
        else {
            self.run.release();
            return false;
        };
        let FolderSummary { mut summary, request } = looked;
        let ours =
            request.filter(|request| summary.phase == RunPhase::Crashed && request.may_go_on());
        let Some(request) = ours else {
            return self.end(&summary);
        };
        death.is_wanted |= self.run.take_stop_by_force();
        let now = Duration::from_millis(clock::since_1970_ms());
        match self.lives.next(now, &death, kept, words) {
            Next::Ask(_) => self.leave_for_decision(&summary, request).await,
            Next::Again(words) => {
                summary.phase = RunPhase::Starting;
                self.run.apply_summary(&summary);
                match resume::again(&self.server, &self.run, *words).await {
                    Ok(launched) => {
                        self.control = Some(launched.control);
                        self.run.set_exit(launched.exit);
                        true
                    }
                    // Another program has resumed it: an earlier server, or the command line.
                    Err(_late) if look_for_writer(&self.run).await => true,
                    // The new runner died before it resumed the run. The policy counts it.
                    Err(error) if error.is_death() => true,
                    Err(error) => {
                        let (id, why) = (self.run.id(), reason(&error));
                        (self.server.settings.tell)(&format!("run {id} is not resumed: {why}"));
                        summary.phase = RunPhase::Crashed;
                        self.leave_for_decision(&summary, request).await
                    }
                }
            }
        }
    }

    /// Leaves the decision about the run to a user.
    async fn leave_for_decision(&self, summary: &RunSummary, request: RunRequest) -> bool {
        resume::leave_alone(&self.server, &self.run, request).await;
        self.end(summary)
    }

    async fn exit(&self) -> Option<Exit> {
        let exit = self.run.take_exit()?;
        tokio::time::timeout(EXIT_STATUS_TIMEOUT, exit).await.ok()?.ok()
    }
}

/// Waits for a run that an earlier server was starting until it begins or fails. Supervises a run that has begun. `None` if its
/// folder no longer exists.
pub(super) async fn await_beginning(server: &Arc<ServerState>, folder: &Path) -> Option<Arc<Run>> {
    let mut pause = RECONNECT_MIN;
    loop {
        let run = look(server, folder.to_path_buf()).await?;
        match run.summary().phase {
            RunPhase::Starting => {}
            // A runner may die after it made its journal, but before its first event.
            RunPhase::Live if run.link().is_none() && !begins(folder).await => {}
            RunPhase::Live => {
                follow(server, &run);
                return Some(run);
            }
            _ => return Some(run),
        }
        tokio::time::sleep(pause).await;
        pause = (pause * 2).min(RECONNECT_MAX);
    }
}

/// True if the run in this folder has events.
async fn begins(folder: &Path) -> bool {
    let folder = folder.to_path_buf();
    tokio::task::spawn_blocking(move || has_begun(&folder)).await.unwrap_or_default()
}

/// True if a run that is found at the start of the server needs supervision: it is live, or its policy resumes it.
pub(super) fn needs_somebody(looked: &FolderSummary, policy: OnCrash) -> bool {
    let FolderSummary { summary, request } = looked;
    let may_go_on = || request.as_ref().is_some_and(RunRequest::may_go_on);
    let goes_on = summary.phase == RunPhase::Crashed && policy != OnCrash::Ask && may_go_on();
    summary.phase == RunPhase::Live || goes_on
}
