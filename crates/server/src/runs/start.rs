//! Starts a run: validates the request, records it, and starts it once, even if it is repeated.
//!
//! Knows requests and folders of runs. Does not know the further course of a run.

use super::folder_files::RunRequest;
use super::launch::{LaunchError, Launched, launch};
use super::resume::EXPIRED;
use super::run::Run;
use super::start_requests::StartRequestState;
use super::supervise;
use crate::access::{Who, of_start};
use crate::failure::reason;
use crate::gate::blocking;
use crate::{Failure, Reason, ServerState};
use rafcon_protocol::api::{Right, RunPhase, RunSummary, StartOf, StartRequest, StartRun};
use rafcon_protocol::{Keeping, Launch};
use rafcon_supervisor::{KeptRun, Next, RestartPolicy, RunnerDeath, clock};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::{sleep, timeout};

/// Timeout of a wait for the runner of an earlier server.
const PREVIOUS_RUNNER_TIMEOUT: Duration = Duration::from_secs(40);
/// Interval of checks of a start by an earlier server.
const RETRY_INTERVAL: Duration = Duration::from_secs(1);
/// The code of a request that is still in progress.
const NOT_FINISHED: &str = "not_finished";

/// Starts the run, or finds the one that this id started. Continues even if the client disconnects.
pub(crate) async fn start(
    server: &Arc<ServerState>,
    who: &Who,
    asked: StartRun,
) -> Result<RunSummary, Failure> {
    check(&asked)?;
    who.must(of_start(&asked))?;
    let (server, author) = (Arc::clone(server), who.user.clone());
    to_its_end(async move { once(&server, &author, asked, None).await }).await
}

/// Starts the machine of a local run again, with the inputs and settings of the run.
pub(super) async fn start_again_here(
    server: &Arc<ServerState>,
    who: &Who,
    run: Arc<Run>,
    id: String,
) -> Result<RunSummary, Failure> {
    let asked = blocking(move || as_started(&run, id)).await?;
    start(server, who, asked).await
}

/// Starts a run for a user of a station, or finds the run of an earlier request with this id.
pub(super) async fn for_station(
    server: &Arc<ServerState>,
    StartRequest { id, user, of, expiry_ms, no_edit }: StartRequest,
) -> Result<RunSummary, Failure> {
    let may_edit = !matches!(of, StartOf::Again(_, false));
    let here = Arc::clone(server);
    let asked = blocking(move || resolved(&here, of, id)).await?;
    must_be_kept(&asked)?;
    if of_start(&asked) == Right::Edit {
        let why =
            "the run before had a breakpoint with a condition: an engineer may start it again";
        let why = no_edit.or_else(|| (!may_edit).then(|| why.to_owned()));
        why.map_or(Ok(()), |why| Err(Failure::forbidden("not_your_right", why)))?;
    }
    loop {
        match once(server, &user, asked.clone(), expiry_ms).await {
            // An earlier server started it, and its runner is not ready.
            Err(failure) if failure.code() == NOT_FINISHED => sleep(RETRY_INTERVAL).await,
            done => return done,
        }
    }
}

/// The request of a station as a local one, under this id.
fn resolved(server: &ServerState, of: StartOf, id: String) -> Result<StartRun, Failure> {
    match of {
        StartOf::Machine(asked) => Ok(StartRun { id, ..*asked }),
        StartOf::Again(run, _) => {
            let known = server.runs.known(&run).filter(|run| !run.is_replica());
            let run = known.ok_or_else(|| {
                let message = "the robot has no such run: name its machine instead";
                Failure::not_found("no_such_run", message)
            })?;
            as_started(&run, id)
        }
    }
}

/// Inputs and settings of a run, under this id. Refuses a run that was started without the server, because its inputs are unknown.
fn as_started(run: &Run, id: String) -> Result<StartRun, Failure> {
    let before = RunRequest::read(run.folder()).and_then(|request| request.start);
    before.map(|before| StartRun { id, ..before }).ok_or_else(|| {
        let instead = run.summary().machine.map_or_else(
            || "its machine where it lies".to_owned(),
            |file| format!("the machine {}/{}", file.project, file.path),
        );
        let message = format!(
            "the run was started without the server, which does not know its inputs: start {instead}"
        );
        Failure::conflict("unknown_inputs", message)
    })
}

/// Runs a request to its end, even if the client disconnects.
pub(super) async fn to_its_end(
    request: impl Future<Output = Result<RunSummary, Failure>> + Send + 'static,
) -> Result<RunSummary, Failure> {
    tokio::spawn(request).await.unwrap_or_else(|_stopped| {
        let message = "the server could not finish this request: send it again with its id";
        Err(Failure::unavailable(NOT_FINISHED, message))
    })
}

/// Checks a request without its context.
pub(super) fn check(asked: &StartRun) -> Result<(), Failure> {
    crate::extract::check_request_id(&asked.id)?;
    must_be_kept(asked)
}

/// Refuses a run without a journal, because nobody could follow it.
pub(super) fn must_be_kept(asked: &StartRun) -> Result<(), Failure> {
    if asked.keeping == Keeping::Off {
        let message = "a run under a server is kept, or nobody could follow it: ask for `full` or `status`, or use \
                       `rafcon run --keep off`";
        return Err(Failure::bad("keeping_off", message));
    }
    Ok(())
}

/// A start that waits for its slot.
struct PendingStart<'r> {
    author: &'r str,
    asked: StartRun,
    /// End of its validity in ms since 1970.
    expiry_ms: Option<u64>,
}

/// Starts the run, or finds the one that this author started with this id. Starts none after `expiry_ms`.
pub(super) async fn once(
    server: &Arc<ServerState>,
    author: &str,
    asked: StartRun,
    expiry_ms: Option<u64>,
) -> Result<RunSummary, Failure> {
    let request = PendingStart { author, asked, expiry_ms };
    let PendingStart { asked, .. } = &request;
    server.runs.wait_until_known().await;
    let id = RunRequest::start_key(author, &asked.id);
    let slot = server.runs.requests.get(&id);
    let mut known = slot.lock().await;
    let folder = match &*known {
        Some(asked) => {
            let folder = asked.folder(server).await?;
            match settled(server, &folder).await? {
                Some(run) if is_open(&run) => Some(folder),
                Some(run) => {
                    *known = Some(StartRequestState::Begun(run.id().to_owned()));
                    return Ok(run.summary());
                }
                None => None,
            }
        }
        None => None,
    };
    match begin(server, &request, folder).await {
        Ok(run) => {
            *known = Some(StartRequestState::Begun(run.id().to_owned()));
            server.audit().note(author, "run_started", run.id());
            Ok(run.summary())
        }
        Err(failure) => {
            *known = None;
            drop(known);
            server.runs.requests.forget(&id, &slot);
            Err(failure)
        }
    }
}

impl StartRequestState {
    /// The folder of its run.
    async fn folder(&self, server: &ServerState) -> Result<PathBuf, Failure> {
        match self {
            Self::Open(folder) => Ok(folder.clone()),
            Self::Begun(run) => {
                let known = server.runs.get(run).await.map_err(|_gone| run_deleted(run))?;
                Ok(known.folder().to_path_buf())
            }
        }
    }
}

/// The run in this folder, which an earlier server was starting. Waits until it has begun or failed.
async fn settled(server: &Arc<ServerState>, folder: &Path) -> Result<Option<Arc<Run>>, Failure> {
    let run = timeout(PREVIOUS_RUNNER_TIMEOUT, supervise::await_beginning(server, folder))
        .await
        .map_err(|_late| {
            let message =
                "the run of this request is still being started: send it again with its id";
            Failure::unavailable(NOT_FINISHED, message)
        })?;
    if let Some(run) = run.as_ref().filter(|run| run.is_live()) {
        run.linked().await;
    }
    Ok(run)
}

fn is_open(run: &Run) -> bool {
    matches!(run.summary().phase, RunPhase::NotStarted { .. })
}

fn run_deleted(run: &str) -> Failure {
    let message =
        format!("this request has started the run {run}, which was deleted: choose another id");
    Failure::conflict("run_is_gone", message)
}

/// Starts the run, in the folder of an earlier attempt if one exists.
async fn begin(
    server: &Arc<ServerState>,
    start: &PendingStart<'_>,
    folder: Option<PathBuf>,
) -> Result<Arc<Run>, Failure> {
    let asked = start.asked.clone();
    let request = RunRequest::to_start(start.author, asked.clone());
    let turn = server.runs.turn().await?;
    unless_expired(start.expiry_ms)?;
    let here = Arc::clone(server);
    let made = move || {
        let _turn = turn;
        made(&here, &asked, &request, folder)
    };
    let (folder, launched) = blocking(made).await?;
    let found = supervise::look(server, folder.clone()).await;
    let run = found.ok_or_else(|| not_kept(&folder))?;
    supervise::follow_ours(server, &run, launched, false).await;
    let here = Arc::clone(server);
    // Deletes old runs in the background, to make room.
    drop(tokio::task::spawn_blocking(move || {
        if let Err(error) = here.runs.folder().give_up_old_ones() {
            (here.settings.tell)(&format!("old runs cannot be deleted: {}", reason(&error)));
        }
    }));
    Ok(run)
}

/// Refuses a request that expired before its slot was free.
pub(super) fn unless_expired(expiry_ms: Option<u64>) -> Result<(), Failure> {
    if expiry_ms.is_some_and(|expiry_ms| clock::since_1970_ms() > expiry_ms) {
        let message = "the request expired before its turn: nothing was done";
        return Err(Failure::conflict(EXPIRED, message));
    }
    Ok(())
}

fn not_kept(folder: &Path) -> Failure {
    let message = format!("the folder of the started run is missing: {}", folder.display());
    Failure::conflict("run_is_gone", message)
}

/// Makes the folder, records the request so that another server can repeat it, and starts the runner. If the run does not
/// begin, the folder is removed.
fn made(
    server: &ServerState,
    asked: &StartRun,
    request: &RunRequest,
    folder: Option<PathBuf>,
) -> Result<(PathBuf, Launched), Failure> {
    let machine = server.projects.machine(&asked.machine)?;
    let name = machine.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder = folder.map_or_else(|| server.runs.folder().make(&name), Ok);
    let folder = folder.map_err(|error| no_room(&reason(&error)))?;
    let begun =
        request.write(&folder).map_err(|error| cannot_write(&folder, &error)).and_then(|()| {
            launched(server, asked, &folder, words(server, machine, asked, &folder))
                .map_err(|error| not_launched(&error))
        });
    match begun {
        Ok(launched) => Ok((folder, launched)),
        Err(failure) => {
            if let Err(error) = fs::remove_dir_all(&folder) {
                (server.settings.tell)(&format!("cannot remove {}: {error}", folder.display()));
            }
            Err(failure)
        }
    }
}

/// Starts the runner. If it dies before its first message, the policy may start another one.
fn launched(
    server: &ServerState,
    asked: &StartRun,
    folder: &Path,
    mut words: Launch,
) -> Result<Launched, LaunchError> {
    let mut lives = RestartPolicy::default();
    let kept = KeptRun { policy: asked.on_crash.unwrap_or_default(), has_begun: false };
    loop {
        let error = match launch(&server.settings, folder, words.clone()) {
            Err(error) if error.is_death() => error,
            other => return other,
        };
        let (now, reason) = (Duration::from_millis(clock::since_1970_ms()), error.to_string());
        let death = RunnerDeath { reason, ..RunnerDeath::default() };
        match lives.next(now, &death, kept, words) {
            Next::Again(again) => words = *again,
            Next::Ask(_) => return Err(error),
        }
    }
}

/// The refusal if a request cannot be recorded.
pub(super) fn cannot_write(folder: &Path, error: &io::Error) -> Failure {
    no_room(&format!("cannot write into {}: {error}", folder.display()))
}

fn no_room(why: &str) -> Failure {
    Failure::unavailable("no_folder", why)
}

/// Configuration for a runner.
fn words(server: &ServerState, machine: PathBuf, asked: &StartRun, folder: &Path) -> Launch {
    Launch {
        machine,
        start_from: asked.start_from.clone(),
        afterwards: asked.afterwards,
        inputs: asked.inputs.clone().into_iter().collect(),
        globals: asked.globals.clone().into_iter().collect(),
        libraries: server.settings.libraries.clone(),
        config: server.settings.config.clone(),
        every_event: false,
        run_folder: Some(folder.to_path_buf()),
        keeping: asked.keeping,
        strict: asked.strict,
        size_max: asked.size_max,
        hold: asked.hold,
        breakpoints: asked.breakpoints.clone(),
        on_crash: asked.on_crash,
        resume: None,
        crash: None,
        listen: true,
        homes: Some(server.projects.readable()),
    }
}

/// The refusal if no run began.
pub(super) fn not_launched(error: &LaunchError) -> Failure {
    let (why, code) = match error {
        LaunchError::Load(_) => (Reason::Unprocessable, "load_failed"),
        LaunchError::Ended { .. }
        | LaunchError::Lost
        | LaunchError::Silent(_)
        | LaunchError::Begin(_) => (Reason::Unprocessable, "not_started"),
        LaunchError::Start(_)
        | LaunchError::Thread(_)
        | LaunchError::Frame(_)
        | LaunchError::Version(_) => (Reason::Unavailable, "no_runner"),
    };
    Failure::new(why, code, reason(error))
}
