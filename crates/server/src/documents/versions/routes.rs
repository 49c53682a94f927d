//! Routes for other versions of an open machine. Knows requests and responses.

use crate::extract::Path;
use crate::{Failure, ServerState};
use axum::Json;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse as _, Response};
use rafcon_protocol::api::{MachineVersions, Refusal};
use rafcon_protocol::document::Document;
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this part.
pub(in super::super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(saved)).routes(routes!(versions)).routes(routes!(version))
}

/// An open machine as it is on disk.
#[utoipa::path(get, path = "/api/v1/machines/{machine}/saved", tag = "machines",
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "The machine", body = Document),
        (status = 403, description = "A link in it leads out of the project", body = Refusal),
        (status = 404, description = "It is not open", body = Refusal),
        (status = 409, description = "There are no files any more", body = Refusal),
        (status = 422, description = "They cannot be read", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
    )
)]
async fn saved(
    State(server): State<Arc<ServerState>>,
    Path(machine): Path<String>,
) -> Result<Response, Failure> {
    let at = Arc::clone(&server);
    Ok(json(at.documents.loads.work(move || super::saved(&server, &machine)).await?))
}

/// Git commits that changed the folder of an open machine.
#[utoipa::path(get, path = "/api/v1/machines/{machine}/versions", tag = "machines",
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "The newest first; empty outside a git repository", body = MachineVersions),
        (status = 404, description = "It is not open", body = Refusal),
        (status = 422, description = "Git cannot read the history", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
    )
)]
async fn versions(
    State(server): State<Arc<ServerState>>,
    Path(machine): Path<String>,
) -> Result<Json<MachineVersions>, Failure> {
    let at = Arc::clone(&server);
    let ask =
        move || tokio::runtime::Handle::current().block_on(super::versions(&server, &machine));
    Ok(Json(at.documents.versions.work(ask).await?))
}

/// An open machine at a git commit, with current libraries.
#[utoipa::path(get, path = "/api/v1/machines/{machine}/versions/{commit}", tag = "machines",
    params(
        ("machine" = String, Path, description = "The machine's id"),
        ("commit" = String, Path, description = "The commit's whole hash"),
    ),
    responses(
        (status = 200, description = "The machine", body = Document),
        (status = 400, description = "This is no hash", body = Refusal),
        (status = 404, description = "It is not open, or not in this commit", body = Refusal),
        (status = 422, description = "It cannot be read, or is too large", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
        (status = 503, description = "There is no room for its files", body = Refusal),
    )
)]
async fn version(
    State(server): State<Arc<ServerState>>,
    Path((machine, commit)): Path<(String, String)>,
) -> Result<Response, Failure> {
    let at = Arc::clone(&server);
    let read = move || super::version(&server, &machine, &commit);
    Ok(json(at.documents.versions.work(read).await?))
}

fn json(document: Vec<u8>) -> Response {
    ([(CONTENT_TYPE, "application/json")], document).into_response()
}
