//! Routes for open machines. Knows requests and responses. The work runs on other threads than those of the connections.

use super::operation::{EditRequest, Operation};
use super::revision_log::RevisionsPage;
use crate::access::Who;
use crate::extract::{Body, Path, Query};
use crate::gate::blocking;
use crate::{Failure, ServerState};
use axum::Json;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse as _, Response};
use rafcon_protocol::api::{
    CloseMachine, CopyStates, Done, EditMachine, JumpMachine, MachineAt, MachineDocument,
    MachineProblem, MachineStatus, MachineSteps, MachineSummary, NewMachine, Refusal,
    ReloadMachine, RevisionPage, RevisionsFrom, Right, SaveMachine, SaveState, SavedState, Undo,
};
use rafcon_protocol::document::Selection;
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this part.
pub(crate) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new()
        .merge(super::versions::routes())
        .merge(super::set_aside::routes())
        .routes(routes!(machines, make))
        .routes(routes!(open))
        .routes(routes!(machine))
        .routes(routes!(document))
        .routes(routes!(revisions))
        .routes(routes!(machine_problems))
        .routes(routes!(copy))
        .routes(routes!(edit))
        .routes(routes!(undo))
        .routes(routes!(redo))
        .routes(routes!(steps))
        .routes(routes!(jump))
        .routes(routes!(save))
        .routes(routes!(save_state))
        .routes(routes!(reload))
        .routes(routes!(close))
}

/// Lists all open machines.
#[utoipa::path(get, path = "/api/v1/machines", tag = "machines", responses(
    (status = 200, description = "Each in one line", body = [MachineSummary])
))]
async fn machines(State(server): State<Arc<ServerState>>) -> Json<Vec<MachineSummary>> {
    Json(server.documents.summaries())
}

/// Makes a new machine and opens it.
#[utoipa::path(post, path = "/api/v1/machines", tag = "machines", request_body = NewMachine, responses(
    (status = 200, description = "It is open", body = MachineSummary),
    (status = 400, description = "The path or the name is none", body = Refusal),
    (status = 403, description = "The path leads out of the project", body = Refusal),
    (status = 404, description = "There is no such project", body = Refusal),
    (status = 409, description = "The folder exists", body = Refusal),
    (status = 422, description = "It cannot be opened", body = Refusal),
    (status = 429, description = "Too many machines are open, or too many are being written", body = Refusal),
    (status = 503, description = "It cannot be written", body = Refusal),
))]
async fn make(
    State(server): State<Arc<ServerState>>,
    Body(new): Body<NewMachine>,
) -> Result<Json<MachineSummary>, Failure> {
    let at = Arc::clone(&server);
    at.documents.saves.work(move || server.documents.make(&server, &new).map(Json)).await
}

/// Opens the machine in a folder. A machine that is already open is not loaded again.
#[utoipa::path(post, path = "/api/v1/machines/open", tag = "machines", request_body = MachineAt, responses(
    (status = 200, description = "It is open", body = MachineSummary),
    (status = 400, description = "The path is none", body = Refusal),
    (status = 403, description = "The path, or a link in the machine, leads out of the project", body = Refusal),
    (status = 404, description = "There is no such machine", body = Refusal),
    (status = 422, description = "The folder holds no machine that can be read, or its draft cannot", body = Refusal),
    (status = 429, description = "Too many machines are open, or too many are being opened", body = Refusal),
))]
async fn open(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Body(MachineAt { file }): Body<MachineAt>,
) -> Result<Json<MachineSummary>, Failure> {
    let (at, may_edit) = (Arc::clone(&server), who.role.grants(Right::Edit));
    at.documents.loads.work(move || server.documents.open(&server, &file, may_edit).map(Json)).await
}

/// The status of an open machine.
#[utoipa::path(get, path = "/api/v1/machines/{machine}", tag = "machines",
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "Status of the machine", body = MachineStatus),
        (status = 404, description = "It is not open", body = Refusal),
    )
)]
async fn machine(
    State(server): State<Arc<ServerState>>,
    Path(machine): Path<String>,
) -> Result<Json<MachineStatus>, Failure> {
    let status = server.documents.session(&machine)?.status()?;
    let status = status.borrow().clone();
    Ok(Json(status))
}

/// The complete document of an open machine.
#[utoipa::path(get, path = "/api/v1/machines/{machine}/document", tag = "machines",
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "The machine and its revision", body = MachineDocument),
        (status = 404, description = "It is not open", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
    )
)]
async fn document(
    State(server): State<Arc<ServerState>>,
    Path(machine): Path<String>,
) -> Result<Response, Failure> {
    let session = server.documents.session(&machine)?;
    Ok(json(server.documents.looks.work(move || session.document()).await?))
}

/// Lists the revisions of an open machine from one on, a page at a time.
#[utoipa::path(get, path = "/api/v1/machines/{machine}/revisions", tag = "machines",
    params(("machine" = String, Path, description = "The machine's id"), RevisionsFrom),
    responses(
        (status = 200, description = "The next revisions", body = RevisionPage),
        (status = 400, description = "The query does not fit", body = Refusal),
        (status = 404, description = "It is not open", body = Refusal),
    )
)]
async fn revisions(
    State(server): State<Arc<ServerState>>,
    Path(machine): Path<String>,
    Query(RevisionsFrom { from }): Query<RevisionsFrom>,
) -> Result<Response, Failure> {
    let session = server.documents.session(&machine)?;
    let (is_reset, next, texts) = match session.since(from) {
        RevisionsPage::Reset(now) => (true, now + 1, String::new()),
        RevisionsPage::Revisions(told) => (false, from + told.len() as u64, told.join(",")),
    };
    let text = format!(r#"{{"is_reset":{is_reset},"next":{next},"revisions":[{texts}]}}"#);
    Ok(json(text.into()))
}

/// Lists the problems of an open machine.
#[utoipa::path(get, path = "/api/v1/machines/{machine}/problems", tag = "machines",
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "Rules that it breaks, scripts that do not fit, faults of its files when they were read last, and libraries that have changed", body = [MachineProblem]),
        (status = 404, description = "It is not open", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
    )
)]
async fn machine_problems(
    State(server): State<Arc<ServerState>>,
    Path(machine): Path<String>,
) -> Result<Json<Vec<MachineProblem>>, Failure> {
    let session = server.documents.session(&machine)?;
    let at = Arc::clone(&server);
    at.documents.looks.work(move || session.problems(&server).map(Json)).await
}

/// Copies states of an open machine, for the edit `paste`.
#[utoipa::path(post, path = "/api/v1/machines/{machine}/copy", tag = "machines", request_body = CopyStates,
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "The states, with what is between them", body = Selection),
        (status = 400, description = "The body does not fit", body = Refusal),
        (status = 404, description = "It is not open, or there is no such container", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
    )
)]
async fn copy(
    State(server): State<Arc<ServerState>>,
    Path(machine): Path<String>,
    Body(wish): Body<CopyStates>,
) -> Result<Json<Selection>, Failure> {
    let at = Arc::clone(&server);
    at.documents.looks.work(move || server.documents.copy(&machine, &wish).map(Json)).await
}

/// Edits an open machine.
#[utoipa::path(post, path = "/api/v1/machines/{machine}/edits", tag = "machines", request_body = EditMachine,
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "It was made", body = Done),
        (status = 400, description = "It cannot be read", body = Refusal),
        (status = 404, description = "The machine is not open", body = Refusal),
        (status = 409, description = "The edited element does not exist, or a new id is taken", body = Refusal),
        (status = 413, description = "The body is too large", body = Refusal),
        (status = 422, description = "It would break a rule of the machine", body = Refusal),
        (status = 503, description = "It cannot be written down, so that it was not made", body = Refusal),
    )
)]
async fn edit(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(machine): Path<String>,
    Body(edit): Body<EditMachine>,
) -> Result<Json<Done>, Failure> {
    let id = edit.id.clone();
    change(server, who, machine, id, Operation::edit(edit)).await
}

/// Undoes the author's own last step.
#[utoipa::path(post, path = "/api/v1/machines/{machine}/undo", tag = "machines", request_body = Undo,
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "It was taken back", body = Done),
        (status = 400, description = "The body does not fit", body = Refusal),
        (status = 404, description = "The machine is not open", body = Refusal),
        (status = 409, description = "There is none, or somebody else built on it", body = Refusal),
        (status = 503, description = "It cannot be written down, so that it was not done", body = Refusal),
    )
)]
async fn undo(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(machine): Path<String>,
    Body(undo): Body<Undo>,
) -> Result<Json<Done>, Failure> {
    change(server, who, machine, undo.id, Operation::Undo).await
}

/// Redoes the author's own step that was undone last.
#[utoipa::path(post, path = "/api/v1/machines/{machine}/redo", tag = "machines", request_body = Undo,
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "It was made again", body = Done),
        (status = 400, description = "The body does not fit", body = Refusal),
        (status = 404, description = "The machine is not open", body = Refusal),
        (status = 409, description = "There is none, or somebody else built on it", body = Refusal),
        (status = 503, description = "It cannot be written down, so that it was not done", body = Refusal),
    )
)]
async fn redo(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(machine): Path<String>,
    Body(redo): Body<Undo>,
) -> Result<Json<Done>, Failure> {
    change(server, who, machine, redo.id, Operation::Redo).await
}

/// The tree of steps of an open machine since it was loaded, without their changes.
#[utoipa::path(get, path = "/api/v1/machines/{machine}/steps", tag = "machines",
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "The steps that are known", body = MachineSteps),
        (status = 404, description = "It is not open", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
    )
)]
async fn steps(
    State(server): State<Arc<ServerState>>,
    Path(machine): Path<String>,
) -> Result<Json<MachineSteps>, Failure> {
    let session = server.documents.session(&machine)?;
    server.documents.looks.work(move || Ok(Json(session.steps()))).await
}

/// Resets an open machine to another revision, as a new step that its author can undo.
#[utoipa::path(post, path = "/api/v1/machines/{machine}/jump", tag = "machines", request_body = JumpMachine,
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "The machine is what it was then", body = Done),
        (status = 400, description = "The body does not fit", body = Refusal),
        (status = 404, description = "The machine is not open", body = Refusal),
        (status = 409, description = "It takes steps of others away (`others_edits`), is not kept (`not_kept`), or changes nothing", body = Refusal),
        (status = 503, description = "It cannot be written down, so that it was not done", body = Refusal),
    )
)]
async fn jump(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(machine): Path<String>,
    Body(JumpMachine { id, revision, over_others }): Body<JumpMachine>,
) -> Result<Json<Done>, Failure> {
    change(server, who, machine, id, Operation::Jump { revision, over_others }).await
}

/// Saves an open machine.
#[utoipa::path(post, path = "/api/v1/machines/{machine}/save", tag = "machines", request_body = SaveMachine,
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "This revision lies on disk", body = Done),
        (status = 400, description = "The path is none", body = Refusal),
        (status = 403, description = "The path leads out of the project", body = Refusal),
        (status = 404, description = "The machine is not open, or there is no such project", body = Refusal),
        (status = 409, description = "Another program changed the files, or something is in the way", body = Refusal),
        (status = 422, description = "The files there cannot be read", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
        (status = 503, description = "It cannot be written", body = Refusal),
    )
)]
async fn save(
    State(server): State<Arc<ServerState>>,
    Path(machine): Path<String>,
    Body(wish): Body<SaveMachine>,
) -> Result<Json<Done>, Failure> {
    let at = Arc::clone(&server);
    at.documents.saves.work(move || server.documents.save(&server, &machine, &wish).map(done)).await
}

/// Saves a state of an open machine as a separate machine: a library, if it is below a library root.
#[utoipa::path(post, path = "/api/v1/machines/{machine}/save_state", tag = "machines", request_body = SaveState,
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "It lies there", body = SavedState),
        (status = 400, description = "The path is none", body = Refusal),
        (status = 403, description = "The path leads out of the project", body = Refusal),
        (status = 404, description = "The machine is not open, has no such state, or there is no such project", body = Refusal),
        (status = 409, description = "Something is in the way", body = Refusal),
        (status = 422, description = "No machine can be made of the state", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
        (status = 503, description = "It cannot be written", body = Refusal),
    )
)]
async fn save_state(
    State(server): State<Arc<ServerState>>,
    Path(machine): Path<String>,
    Body(wish): Body<SaveState>,
) -> Result<Json<SavedState>, Failure> {
    let at = Arc::clone(&server);
    let save = move || server.documents.save_state(&server, &machine, &wish).map(Json);
    at.documents.saves.work(save).await
}

/// Reloads the files of an open machine.
#[utoipa::path(post, path = "/api/v1/machines/{machine}/reload", tag = "machines", request_body = ReloadMachine,
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "The machine is what lies on disk", body = Done),
        (status = 400, description = "The body does not fit", body = Refusal),
        (status = 404, description = "The machine is not open", body = Refusal),
        (status = 409, description = "There are no files any more", body = Refusal),
        (status = 422, description = "They cannot be read", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
        (status = 503, description = "It cannot be written down, so that it was not done", body = Refusal),
    )
)]
async fn reload(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(machine): Path<String>,
    Body(wish): Body<ReloadMachine>,
) -> Result<Json<Done>, Failure> {
    let at = Arc::clone(&server);
    let request = EditRequest { author: who.user, id: wish.id };
    let read = move || server.documents.reload(&server, &machine, request).map(done);
    at.documents.saves.work(read).await
}

/// Closes an open machine for everyone.
#[utoipa::path(post, path = "/api/v1/machines/{machine}/close", tag = "machines", request_body = CloseMachine,
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "It is closed"),
        (status = 400, description = "The body does not fit", body = Refusal),
        (status = 404, description = "The machine is not open", body = Refusal),
        (status = 409, description = "It has edits that do not lie on disk", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
        (status = 503, description = "Its draft cannot be removed", body = Refusal),
    )
)]
async fn close(
    State(server): State<Arc<ServerState>>,
    Path(machine): Path<String>,
    Body(wish): Body<CloseMachine>,
) -> Result<(), Failure> {
    let at = Arc::clone(&server);
    at.documents.saves.work(move || server.documents.close(&server, &machine, &wish)).await
}

/// Performs an operation on an open machine.
async fn change(
    server: Arc<ServerState>,
    who: Who,
    machine: String,
    id: String,
    operation: Operation,
) -> Result<Json<Done>, Failure> {
    let request = EditRequest { author: who.user, id };
    let work = move || server.documents.change(&server, &machine, request, operation).map(done);
    blocking(work).await
}

fn done(revision: u64) -> Json<Done> {
    Json(Done { revision })
}

fn json(text: Bytes) -> Response {
    ([(CONTENT_TYPE, "application/json")], text).into_response()
}
