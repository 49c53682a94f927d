//! What becomes of a run whose runner is followed: linked while it lives, linked again when only the link broke, and when the
//! runner is dead, resumed by its policy or left for someone to decide.
//!
//! Knows the order of things. Does not know who asks for them.

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

/// After a link broke, the runner is looked for again after this time, then after twice as much, and so on up to the longest.
const RECONNECT_MIN: Duration = Duration::from_millis(2);
/// See [`RECONNECT_MIN`].
const RECONNECT_MAX: Duration = Duration::from_secs(1);
/// How long the exit status of a process of our own is waited for, once it holds its run no more.
const EXIT_STATUS_TIMEOUT: Duration = Duration::from_secs(1);

/// Looks into a folder and lets everyone know what is there; nothing if there is no run. A run that someone follows already is
/// known better than it can be found.
pub(super) async fn look(server: &Arc<ServerState>, folder: PathBuf) -> Option<Arc<Run>> {
    let (here, there) = (Arc::clone(server), folder.clone());
    let look = move || super::summary::look(&there, &here.projects);
    let looked = tokio::task::spawn_blocking(look).await.ok().flatten();
    server.runs.found(server, &folder, looked)
}

/// Looks after the runner of a run from now on, if no one does yet.
pub(super) fn follow(server: &Arc<ServerState>, run: &Arc<Run>) {
    if run.try_claim() {
        look_after(server, run);
    }
}

/// Looks after the runner of a run that is in our hand.
fn look_after(server: &Arc<ServerState>, run: &Arc<Run>) {
    let (server, run) = (Arc::clone(server), Arc::clone(run));
    let life = RunSupervisor { server, run, lives: RestartPolicy::default(), control: None };
    tokio::spawn(life.go_on());
}

/// Looks after a runner that was just started, of a run that is in our hand already if `is_claimed`, and waits until it can be
/// commanded: until then it knows that someone looks on.
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

/// What was known about a run may be true no more: looks, and follows it if it lives.
pub(super) async fn look_again(server: &Arc<ServerState>, run: &Run) {
    if let Some(run) = Box::pin(look(server, run.folder().to_path_buf())).await
        && run.summary().phase == RunPhase::Live
        && look_for_writer(&run).await
    {
        follow(server, &run);
    }
}

/// True if a process writes the run. A replica without a station has none, although its run may continue.
async fn look_for_writer(run: &Run) -> bool {
    let folder = run.folder().to_path_buf();
    let writer = tokio::task::spawn_blocking(move || writer_of(&folder)).await;
    matches!(writer, Ok(Ok(Some(_))))
}

/// The runners of one run, one after the other.
struct RunSupervisor {
    server: Arc<ServerState>,
    run: Arc<Run>,
    lives: RestartPolicy,
    /// Our first connection to a runner that we started: closed when the next one stands.
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
        // Someone else may have taken it up in between.
        look_again(&self.server, &self.run).await;
    }

    /// No one looks after the run from now on; only then it is told how it stands, so that whoever knows can resume it.
    fn end(&self, summary: &RunSummary) -> bool {
        self.run.release();
        self.run.apply_summary(summary);
        false
    }

    /// Follows the runner for as long as it lives.
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

    /// The runner is dead: whether another follows. If not, the run is let go.
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
                    // Someone else has taken it up meanwhile: a server before this one, or the command line.
                    Err(_late) if look_for_writer(&self.run).await => true,
                    // It died before it had taken the run up: one more death.
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

    /// Someone has to decide what becomes of the run.
    async fn leave_for_decision(&self, summary: &RunSummary, request: RunRequest) -> bool {
        resume::leave_alone(&self.server, &self.run, request).await;
        self.end(summary)
    }

    async fn exit(&self) -> Option<Exit> {
        let exit = self.run.take_exit()?;
        tokio::time::timeout(EXIT_STATUS_TIMEOUT, exit).await.ok()?.ok()
    }
}

/// Waits until a run begins, or is known not to, that a server before this one was starting when it ended; follows one that
/// has begun. Nothing if its folder is gone.
pub(super) async fn await_beginning(server: &Arc<ServerState>, folder: &Path) -> Option<Arc<Run>> {
    let mut pause = RECONNECT_MIN;
    loop {
        let run = look(server, folder.to_path_buf()).await?;
        match run.summary().phase {
            RunPhase::Starting => {}
            // A runner that has made its journal may die before anything happens.
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

/// Whether anything has happened in the run of this folder.
async fn begins(folder: &Path) -> bool {
    let folder = folder.to_path_buf();
    tokio::task::spawn_blocking(move || has_begun(&folder)).await.unwrap_or_default()
}

/// Whether a run that is found when the server begins is to be looked after: it lives, or it would continue by itself.
pub(super) fn needs_somebody(looked: &FolderSummary, policy: OnCrash) -> bool {
    let FolderSummary { summary, request } = looked;
    let may_go_on = || request.as_ref().is_some_and(RunRequest::may_go_on);
    let goes_on = summary.phase == RunPhase::Crashed && policy != OnCrash::Ask && may_go_on();
    summary.phase == RunPhase::Live || goes_on
}
