//! Resumes a run without a runner: on request, or by its policy.
//!
//! Knows requests and launches. Does not know the further course of the run.

use super::control::GivenCommand;
use super::folder_files::RunRequest;
use super::launch::{LaunchError, Launched, launch};
use super::run::Run;
use super::start::{cannot_write, not_launched, to_its_end, unless_expired};
use super::supervise;
use super::{at_robot, commands};
use crate::access::Who;
use crate::failure::reason;
use crate::gate::blocking;
use crate::{Failure, ServerState};
use rafcon_protocol::Launch;
use rafcon_protocol::api::{
    ControlMove, ResumeRequest, ResumeRun, RobotRequest, RunPhase, RunSummary,
};
use rafcon_supervisor::resume_launch;
use std::io;
use std::sync::Arc;

/// Resumes a run, or finds that this id already resumed it.
pub(crate) async fn resume(
    server: &Arc<ServerState>,
    who: &Who,
    run: &str,
    asked: ResumeRun,
) -> Result<RunSummary, Failure> {
    crate::extract::check_request_id(&asked.id)?;
    let run = server.runs.get(run).await?;
    if run.is_replica() {
        return by_robot(server, who, &run, asked).await;
    }
    let request = request(&run, who, asked);
    let server = Arc::clone(server);
    to_its_end(async move { once(&server, &run, &request).await }).await
}

fn request(run: &Run, who: &Who, asked: ResumeRun) -> ResumeRequest {
    let (run, user) = (run.id().to_owned(), who.user.clone());
    ResumeRequest { run, user, asked, expiry_ms: None }
}

/// Asks the robot of a replica to resume its run. The robot decides.
async fn by_robot(
    server: &ServerState,
    who: &Who,
    run: &Run,
    asked: ResumeRun,
) -> Result<RunSummary, Failure> {
    let robot = run.robot().unwrap_or_default();
    if let RunPhase::Finished { .. } = run.summary().phase {
        let message =
            format!("the run has come to its end: robot {robot} itself can begin it again");
        return Err(Failure::conflict("run_is_over", message));
    }
    // The id of a command begins with the name of a user.
    let id = format!("//resume/{}/{}/{}", who.user, run.id(), asked.id);
    let request = RobotRequest::Resume(request(run, who, ResumeRun { id, ..asked }));
    at_robot::carry_out(server, &robot, request).await?;
    Ok(run.summary())
}

/// The code of a request that expired before it was performed.
pub(super) const EXPIRED: &str = "expired";

/// Resumes a local run.
pub(super) async fn once(
    server: &Arc<ServerState>,
    run: &Arc<Run>,
    request: &ResumeRequest,
) -> Result<RunSummary, Failure> {
    // Serialized per run, so that concurrent requests do not start two runners.
    let id = format!("resume/{}", run.id());
    let slot = server.runs.requests.get(&id);
    let turn = slot.lock().await;
    let resumed = in_turn(server, run, request).await;
    drop(turn);
    server.runs.requests.forget(&id, &slot);
    resumed
}

async fn in_turn(
    server: &Arc<ServerState>,
    run: &Arc<Run>,
    ResumeRequest { user, asked, expiry_ms, .. }: &ResumeRequest,
) -> Result<RunSummary, Failure> {
    run.wait_settled().await;
    let folder = run.folder().to_path_buf();
    let before = blocking(move || Ok(RunRequest::read(&folder))).await?;
    let was_resumed = |request: &RunRequest| request.was_resumed(user, &asked.id, run.is_live());
    let is_done = before.as_ref().is_some_and(|request| was_resumed(request) == Some(true));
    if is_done {
        return Ok(run.summary());
    }
    may_be_resumed(&run.summary(), asked)?;
    // Control of a crashed run cannot be moved. It passes to the user if its holder is silent.
    let given = GivenCommand { user, id: &asked.id, epoch: None };
    commands::take(server, run, given).or_else(|denied| {
        let taken = commands::move_holder(server, run, user, &ControlMove::TakeOver);
        taken.map_err(|_still_heard| denied)
    })?;
    let turn = server.runs.turn().await?;
    unless_expired(*expiry_ms)?;
    if !run.try_claim() {
        return Err(still_live());
    }
    run.set_phase(RunPhase::Starting);
    let (here, there) = (Arc::clone(server), Arc::clone(run));
    let (author, asked) = (user.clone(), asked.clone());
    let begin = move || {
        let _turn = turn;
        begun(&here, &there, &author, &asked, before)
    };
    match blocking(begin).await {
        Ok(launched) => {
            run.set_phase(RunPhase::Live);
            server.audit().note(user, "run_resumed", run.id());
            supervise::follow_ours(server, run, launched, true).await;
            Ok(run.summary())
        }
        Err(failure) => {
            run.release();
            supervise::look_again(server, run).await;
            Err(failure)
        }
    }
}

fn still_live() -> Failure {
    Failure::conflict("run_is_live", "the run is active: command it instead")
}

fn may_be_resumed(run: &RunSummary, asked: &ResumeRun) -> Result<(), Failure> {
    let refused = |code, message: &str| Err(Failure::conflict(code, message));
    match &run.phase {
        RunPhase::Crashed => Ok(()),
        RunPhase::Finished { .. } if asked.from.is_some() => Ok(()),
        RunPhase::Finished { .. } => refused(
            "run_is_over",
            "the run has come to its end: start another, or name an entry of its history to begin from (`from`)",
        ),
        RunPhase::Live | RunPhase::Starting => Err(still_live()),
        RunPhase::NotStarted { reason }
        | RunPhase::Diverged { reason }
        | RunPhase::Unreadable { reason } => {
            refused("run_is_unreadable", &format!("there is nothing to resume: {reason}"))
        }
    }
}

/// Records the request and starts a runner. If that fails, it restores the earlier record.
fn begun(
    server: &ServerState,
    run: &Run,
    author: &str,
    asked: &ResumeRun,
    before: Option<RunRequest>,
) -> Result<Launched, Failure> {
    let folder = run.folder();
    let request = before.clone().unwrap_or_default().resuming(author, &asked.id);
    request.write(folder).map_err(|error| cannot_write(folder, &error))?;
    let words = resume_launch(folder, asked.policy, asked.from);
    match launch(&server.settings, folder, words) {
        Ok(launched) => {
            if let Err(error) = request.resumed().write(folder) {
                (server.settings.tell)(&format!("run {} was resumed: {error}", run.id()));
            }
            Ok(launched)
        }
        Err(error) => {
            let put_back = before.map_or_else(|| RunRequest::remove(folder), |it| it.write(folder));
            if let Err(error) = put_back {
                (server.settings.tell)(&format!("run {} was not resumed: {error}", run.id()));
            }
            Err(not_launched(&error))
        }
    }
}

/// Starts another runner that resumes the run by its policy.
pub(super) async fn again(
    server: &Arc<ServerState>,
    run: &Arc<Run>,
    words: Launch,
) -> Result<Launched, LaunchError> {
    let (server, run) = (Arc::clone(server), Arc::clone(run));
    let begin = move || launch(&server.settings, run.folder(), words);
    let begun = tokio::task::spawn_blocking(begin).await;
    begun.unwrap_or_else(|stopped| Err(LaunchError::Thread(io::Error::other(stopped))))
}

/// Ends automatic resumption of this run, also for later servers.
pub(super) async fn leave_alone(server: &Arc<ServerState>, run: &Arc<Run>, request: RunRequest) {
    let (server, run) = (Arc::clone(server), Arc::clone(run));
    let request = RunRequest { is_left_alone: true, ..request };
    let written = tokio::task::spawn_blocking(move || {
        if let Err(error) = request.write(run.folder()) {
            let (id, why) = (run.id(), reason(&error));
            (server.settings.tell)(&format!("it cannot be noted that run {id} waits: {why}"));
        }
    });
    written.await.unwrap_or_default();
}
