//! Routes for drafts that were set aside. Knows requests and responses.

use crate::extract::Path;
use crate::{Failure, ServerState};
use axum::Json;
use axum::extract::State;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse as _, Response};
use rafcon_protocol::api::{Refusal, SetAsideDraft};
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this part.
pub(in super::super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(set_aside)).routes(routes!(export, discard))
}

/// Unsaved edits of an open machine that could not be applied after a restart of the server.
#[utoipa::path(get, path = "/api/v1/machines/{machine}/set_aside", tag = "machines",
    params(("machine" = String, Path, description = "The machine's id")),
    responses(
        (status = 200, description = "Each draft with its edits, the oldest first", body = [SetAsideDraft]),
        (status = 404, description = "The machine is not open", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
    )
)]
async fn set_aside(
    State(server): State<Arc<ServerState>>,
    Path(machine): Path<String>,
) -> Result<Json<Vec<SetAsideDraft>>, Failure> {
    let at = Arc::clone(&server);
    at.documents.looks.work(move || server.documents.set_aside(&machine).map(Json)).await
}

/// A draft that was set aside, as a file: its edits, and the machines that they begin with.
#[utoipa::path(get, path = "/api/v1/machines/{machine}/set_aside/{draft}", tag = "machines",
    params(
        ("machine" = String, Path, description = "The machine's id"),
        ("draft" = String, Path, description = "The draft's id"),
    ),
    responses(
        (status = 200, description = "All of it", body = serde_json::Value),
        (status = 404, description = "The machine is not open, or there is no such draft", body = Refusal),
        (status = 422, description = "It cannot be read", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
    )
)]
async fn export(
    State(server): State<Arc<ServerState>>,
    Path((machine, draft)): Path<(String, String)>,
) -> Result<Response, Failure> {
    let at = Arc::clone(&server);
    let read = move || server.documents.export_set_aside(&machine, &draft);
    let text = at.documents.looks.work(read).await?;
    let file = "attachment; filename=\"edits.json\"";
    Ok(([(CONTENT_TYPE, "application/json"), (CONTENT_DISPOSITION, file)], text).into_response())
}

/// Removes a draft that was set aside.
#[utoipa::path(delete, path = "/api/v1/machines/{machine}/set_aside/{draft}", tag = "machines",
    params(
        ("machine" = String, Path, description = "The machine's id"),
        ("draft" = String, Path, description = "The draft's id"),
    ),
    responses(
        (status = 200, description = "The draft was removed"),
        (status = 404, description = "The machine is not open, or there is no such draft", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
        (status = 503, description = "It cannot be removed", body = Refusal),
    )
)]
async fn discard(
    State(server): State<Arc<ServerState>>,
    Path((machine, draft)): Path<(String, String)>,
) -> Result<(), Failure> {
    let at = Arc::clone(&server);
    at.documents
        .saves
        .work(move || server.documents.discard_set_aside(&server, &machine, &draft))
        .await
}
