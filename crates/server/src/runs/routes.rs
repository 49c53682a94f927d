//! Routes for runs: start, state and commands. Knows requests and responses. The work is in other modules.

use super::{Run, at_robot, command_lists, commands, contacts, leftovers, resume, start};
use crate::access::Who;
use crate::extract::{Body, Path, Query};
use crate::gate::blocking;
use crate::{Failure, ServerState};
use axum::Json;
use axum::extract::State;
use rafcon_protocol::api::{
    CommandAnswer, Control, ControlMove, Moment, OutputEnd, Refusal, ResumeRun, RunNow, RunOutput,
    RunResults, RunSummary, StartAgain, StartRun, StartedRun, StateAt,
};
use rafcon_protocol::{Breakpoint, Envelope, Question, StateData, Values};
use rafcon_storage::journal::folder::EndValues;
use rafcon_supervisor::clock;
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this part.
pub(crate) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new()
        .routes(routes!(list, begin))
        .routes(routes!(now))
        .routes(routes!(resume))
        .routes(routes!(again))
        .routes(routes!(begin_at_robot))
        .routes(routes!(command))
        .routes(routes!(control, move_control))
        .routes(routes!(state))
        .routes(routes!(breakpoints))
        .routes(routes!(questions))
        .routes(routes!(globals))
        .routes(routes!(results))
        .routes(routes!(written))
        .merge(at_robot::routes())
        .merge(contacts::routes())
        .merge(command_lists::routes())
}

/// Lists all runs, newest first.
#[utoipa::path(get, path = "/api/v1/runs", tag = "runs", responses(
    (status = 200, description = "The newest first", body = [RunSummary])
))]
async fn list(State(server): State<Arc<ServerState>>) -> Json<Vec<RunSummary>> {
    Json(server.runs.list().await)
}

/// Starts a run.
///
/// The response is sent once the machine is loaded and the run begins. A repeated id of an author starts only one run.
/// Breakpoints with a condition need the right to edit: a condition is Python.
#[utoipa::path(post, path = "/api/v1/runs", tag = "runs", request_body = StartRun, responses(
    (status = 200, description = "The run", body = RunSummary),
    (status = 400, description = "Something is wrong with the request itself", body = Refusal),
    (status = 403, description = "The machine lies outside the projects, or a breakpoint has a condition and you may not edit", body = Refusal),
    (status = 404, description = "There is no such project or machine", body = Refusal),
    (status = 409, description = "The run that this id has started was deleted", body = Refusal),
    (status = 413, description = "The request is too large", body = Refusal),
    (status = 422, description = "The machine cannot be run", body = Refusal),
    (status = 429, description = "Too many runs are being started", body = Refusal),
    (status = 503, description = "There is no interpreter, extension or room", body = Refusal),
))]
async fn begin(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Body(asked): Body<StartRun>,
) -> Result<Json<RunSummary>, Failure> {
    start::start(&server, &who, asked).await.map(Json)
}

/// The current state of a run.
#[utoipa::path(get, path = "/api/v1/runs/{run}", tag = "runs",
    params(("run" = String, Path, description = "The run's id")),
    responses(
        (status = 200, description = "The latest truth", body = RunNow),
        (status = 404, description = "There is no such run", body = Refusal),
    )
)]
async fn now(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
) -> Result<Json<RunNow>, Failure> {
    let run = server.runs.get(&run).await?;
    let now = RunNow::clone(&run.now().borrow());
    Ok(Json(RunNow { now_ms: clock::since_1970_ms(), ..now }))
}

/// Resumes a run whose runner crashed, or restarts it from an entry of its history.
#[utoipa::path(post, path = "/api/v1/runs/{run}/resume", tag = "runs", request_body = ResumeRun,
    params(("run" = String, Path, description = "The run's id")),
    responses(
        (status = 200, description = "The run was resumed, now or earlier by this id", body = RunSummary),
        (status = 400, description = "Something is wrong with the request itself", body = Refusal),
        (status = 404, description = "There is no such run", body = Refusal),
        (status = 409, description = "It is active, has ended, or another user is in control", body = Refusal),
        (status = 413, description = "The request is too large", body = Refusal),
        (status = 422, description = "It cannot be resumed", body = Refusal),
        (status = 429, description = "Too many runs are being started", body = Refusal),
        (status = 503, description = "There is no interpreter, extension or room", body = Refusal),
    )
)]
async fn resume(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(run): Path<String>,
    Body(asked): Body<ResumeRun>,
) -> Result<Json<RunSummary>, Failure> {
    resume::resume(&server, &who, &run, asked).await.map(Json)
}

/// Starts another run of a run's machine as it is on disk now, with the inputs and settings of that run.
///
/// A station forwards the request to the robot, which checks the rights of the pairing. Repetitions under one id start no second run.
#[utoipa::path(post, path = "/api/v1/runs/{run}/again", tag = "runs", request_body = StartAgain,
    params(("run" = String, Path, description = "The id of the run before")),
    responses(
        (status = 200, description = "The run that was started, or was once by this id", body = StartedRun),
        (status = 400, description = "Something is wrong with the request itself", body = Refusal),
        (status = 403, description = "The run before had a breakpoint with a condition, and you may not edit", body = Refusal),
        (status = 404, description = "There is no such run", body = Refusal),
        (status = 409, description = "It was started without a server, so its inputs are unknown; or the robot refused, the request expired, or its fate is unknown", body = Refusal),
        (status = 413, description = "The request is too large", body = Refusal),
        (status = 422, description = "The machine cannot be run", body = Refusal),
        (status = 429, description = "Too many runs are being started", body = Refusal),
        (status = 503, description = "The robot has not answered yet, or there is no interpreter or room", body = Refusal),
    )
)]
async fn again(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(run): Path<String>,
    Body(asked): Body<StartAgain>,
) -> Result<Json<StartedRun>, Failure> {
    at_robot::start_again(&server, &who, &run, asked).await.map(Json)
}

/// Has a robot start a machine of its projects.
///
/// A station forwards the request to the robot, which checks the rights of the pairing. Repetitions under one id start no second run.
/// The events of the run arrive after the delay of the link.
#[utoipa::path(post, path = "/api/v1/robots/{robot}/runs", tag = "runs", request_body = StartRun,
    params(("robot" = String, Path, description = "The robot's name at this station")),
    responses(
        (status = 200, description = "The run that was started, or was once by this id", body = StartedRun),
        (status = 400, description = "Something is wrong with the request itself", body = Refusal),
        (status = 403, description = "A breakpoint has a condition, and you may not edit", body = Refusal),
        (status = 404, description = "This server receives no such robot", body = Refusal),
        (status = 409, description = "The robot refused it, it expired, or its fate is unknown", body = Refusal),
        (status = 413, description = "The request is too large", body = Refusal),
        (status = 429, description = "Too many requests wait for the robot", body = Refusal),
        (status = 503, description = "The robot has not answered yet", body = Refusal),
    )
)]
async fn begin_at_robot(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(robot): Path<String>,
    Body(asked): Body<StartRun>,
) -> Result<Json<StartedRun>, Failure> {
    at_robot::start(&server, &who, robot, asked).await.map(Json)
}

/// Sends a command to a run.
///
/// The author is the user of the request. An author's id is executed once: a repetition returns the first answer, and is
/// refused for another command.
#[utoipa::path(post, path = "/api/v1/runs/{run}/commands", tag = "runs", request_body = Envelope,
    params(("run" = String, Path, description = "The run's id")),
    responses(
        (status = 200, description = "Result of the command", body = CommandAnswer),
        (status = 400, description = "Something is wrong with the request itself", body = Refusal),
        (status = 403, description = "This command needs a right that you lack", body = Refusal),
        (status = 404, description = "There is no such run", body = Refusal),
        (status = 409, description = "The run is not active, or another user is in control", body = Refusal),
        (status = 413, description = "The request is too large", body = Refusal),
        (status = 429, description = "Too many commands are on their way", body = Refusal),
        (status = 503, description = "The runner cannot be reached: send the command again with its id", body = Refusal),
    )
)]
async fn command(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(run): Path<String>,
    Body(envelope): Body<Envelope>,
) -> Result<Json<CommandAnswer>, Failure> {
    commands::command(&server, &who, &run, envelope).await.map(Json)
}

/// State of control of a run.
#[utoipa::path(get, path = "/api/v1/runs/{run}/control", tag = "runs",
    params(("run" = String, Path, description = "The run's id")),
    responses(
        (status = 200, description = "The holder, and who asks for it", body = Control),
        (status = 404, description = "There is no such run", body = Refusal),
    )
)]
async fn control(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
) -> Result<Json<Control>, Failure> {
    let run = server.runs.get(&run).await?;
    let control = run.now().borrow().control.clone();
    Ok(Json(control))
}

/// Requests, hands over, releases or takes over control of a run.
#[utoipa::path(post, path = "/api/v1/runs/{run}/control", tag = "runs", request_body = ControlMove,
    params(("run" = String, Path, description = "The run's id")),
    responses(
        (status = 200, description = "Current control of the run", body = Control),
        (status = 400, description = "Something is wrong with the request itself", body = Refusal),
        (status = 404, description = "There is no such run", body = Refusal),
        (status = 409, description = "The run is not active, or your state of control does not allow this", body = Refusal),
        (status = 413, description = "The request is too large", body = Refusal),
    )
)]
async fn move_control(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(run): Path<String>,
    Body(wanted): Body<ControlMove>,
) -> Result<Json<Control>, Failure> {
    commands::control(&server, &who, &run, &wanted).await.map(Json)
}

/// Data of an active state.
#[utoipa::path(get, path = "/api/v1/runs/{run}/state", tag = "runs",
    params(("run" = String, Path, description = "The run's id"), StateAt),
    responses(
        (status = 200, description = "Its inputs, the defaults of its outputs, its scoped variables", body = StateData),
        (status = 400, description = "The query does not fit", body = Refusal),
        (status = 404, description = "There is no such run, or the state is not active", body = Refusal),
        (status = 409, description = "The run is not active", body = Refusal),
        (status = 429, description = "Too many ask what states of this run hold", body = Refusal),
        (status = 503, description = "The runner cannot be reached", body = Refusal),
    )
)]
async fn state(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
    Query(at): Query<StateAt>,
) -> Result<Json<StateData>, Failure> {
    commands::inspect(&server, &run, &at.path).await.map(Json)
}

/// The breakpoints of a run.
#[utoipa::path(get, path = "/api/v1/runs/{run}/breakpoints", tag = "runs",
    params(("run" = String, Path, description = "The run's id")),
    responses(
        (status = 200, description = "As they are, or were at the end", body = [Breakpoint]),
        (status = 404, description = "There is no such run, or it keeps no journal yet", body = Refusal),
        (status = 422, description = "Its journal is damaged, or too new", body = Refusal),
        (status = 503, description = "Its journal cannot be read", body = Refusal),
    )
)]
async fn breakpoints(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
) -> Result<Json<Vec<Breakpoint>>, Failure> {
    let run = server.runs.get(&run).await?;
    let now = Arc::clone(&run.now().borrow());
    match now.snapshot.as_ref().filter(|_| run.is_live()) {
        Some(snapshot) => Ok(Json(snapshot.breakpoints.clone())),
        None => Ok(Json(picture(&server, &run).await?.breakpoints)),
    }
}

/// Open questions of a run.
#[utoipa::path(get, path = "/api/v1/runs/{run}/questions", tag = "runs",
    params(("run" = String, Path, description = "The run's id")),
    responses(
        (status = 200, description = "Open questions; empty if the run is not active", body = [Question]),
        (status = 404, description = "There is no such run", body = Refusal),
    )
)]
async fn questions(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
) -> Result<Json<Vec<Question>>, Failure> {
    let run = server.runs.get(&run).await?;
    let now = Arc::clone(&run.now().borrow());
    let snapshot = now.snapshot.as_ref().filter(|_| run.is_live());
    Ok(Json(snapshot.map(|snapshot| snapshot.questions.clone()).unwrap_or_default()))
}

/// Global variables of a run, from its journal: at most 10 ms old while the run is active.
#[utoipa::path(get, path = "/api/v1/runs/{run}/globals", tag = "runs",
    params(("run" = String, Path, description = "The run's id")),
    responses(
        (status = 200, description = "Their values by name", body = Object),
        (status = 404, description = "There is no such run, or it keeps no journal yet", body = Refusal),
        (status = 422, description = "Its journal is damaged, or too new", body = Refusal),
        (status = 503, description = "Its journal cannot be read", body = Refusal),
    )
)]
async fn globals(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
) -> Result<Json<Values>, Failure> {
    let run = server.runs.get(&run).await?;
    Ok(Json(picture(&server, &run).await?.globals))
}

/// All values at the end of a run. Long values of a robot's run are shortened and marked at its station.
#[utoipa::path(get, path = "/api/v1/runs/{run}/results", tag = "runs",
    params(("run" = String, Path, description = "The run's id")),
    responses(
        (status = 200, description = "The values by name", body = RunResults),
        (status = 404, description = "There is no such run, or it has not ended", body = Refusal),
        (status = 422, description = "Its journal is damaged, or too new", body = Refusal),
        (status = 503, description = "Its journal cannot be read", body = Refusal),
    )
)]
async fn results(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
) -> Result<Json<RunResults>, Failure> {
    let run = server.runs.get(&run).await?;
    let readers = server.history.readers();
    let values = readers.read(run.folder().to_path_buf(), |reader| Ok(reader.results()?)).await?;
    let EndValues { outputs, globals, scoped_variables } = values.ok_or_else(|| {
        Failure::not_found("not_ended", "the run has not ended: its results come with its end")
    })?;
    Ok(Json(RunResults { outputs, globals, scoped_variables }))
}

/// The end of the output of the runner and its scripts that is not captured as script output.
#[utoipa::path(get, path = "/api/v1/runs/{run}/output", tag = "runs",
    params(("run" = String, Path, description = "The run's id"), OutputEnd),
    responses(
        (status = 200, description = "Nothing, if the run was started elsewhere", body = RunOutput),
        (status = 400, description = "The query does not fit", body = Refusal),
        (status = 404, description = "There is no such run", body = Refusal),
        (status = 503, description = "It cannot be read", body = Refusal),
    )
)]
async fn written(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
    Query(end): Query<OutputEnd>,
) -> Result<Json<RunOutput>, Failure> {
    let run = server.runs.get(&run).await?;
    let bytes = end.bytes.unwrap_or(leftovers::USUAL_BYTES);
    blocking(move || leftovers::tail(run.folder(), bytes).map(Json)).await
}

/// The state of a run after its last event.
async fn picture(server: &ServerState, run: &Run) -> Result<Moment, Failure> {
    let read = server.history.readers().read(run.folder().to_path_buf(), |reader| {
        let moment = reader.moment(u64::MAX)?;
        Ok(reader.picture(&moment)?)
    });
    read.await
}
