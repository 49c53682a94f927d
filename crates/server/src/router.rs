//! Combines all routes and their description.

use crate::access::{self, guarded};
use crate::{Failure, ServerState, description, history, page, projects, runs, socket};
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use axum::{Json, Router};
use rafcon_protocol::api::{Health, ServerStatus};
use std::sync::{Arc, LazyLock};
use utoipa::openapi::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of all parts of the server.
fn all() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::with_openapi(description::head())
        .routes(routes!(health))
        .routes(routes!(openapi_json))
        .routes(routes!(status))
        .merge(page::routes())
        .merge(access::routes())
        .merge(projects::routes())
        .merge(crate::documents::routes())
        .merge(crate::python::routes())
        .merge(crate::plans::routes())
        .merge(runs::routes())
        .merge(history::routes())
        .merge(socket::routes())
}

/// The service that handles all requests.
pub fn router(server: Arc<ServerState>) -> Router {
    let (router, _description) = all().split_for_parts();
    guarded(router.fallback(nowhere), &server).with_state(server)
}

/// The description of all routes, as served at `/api/v1/openapi.json`.
pub fn openapi() -> OpenApi {
    description::complete(all().into_openapi())
}

/// Program and version of a server that runs.
#[utoipa::path(get, path = "/api/v1/health", tag = "server", responses(
    (status = 200, description = "It is", body = Health)
))]
async fn health() -> Json<Health> {
    Json(Health { program: "rafcon".to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() })
}

/// Returns this description of all routes.
#[utoipa::path(get, path = "/api/v1/openapi.json", tag = "server", responses(
    (status = 200, description = "An OpenAPI document", body = Object)
))]
async fn openapi_json() -> impl IntoResponse {
    static TEXT: LazyLock<String> = LazyLock::new(|| openapi().to_json().unwrap_or_default());
    ([(CONTENT_TYPE, "application/json")], TEXT.as_str())
}

/// State of the files, of open machines, and of runs that are active or changed since the start.
#[utoipa::path(get, path = "/api/v1/status", tag = "server", responses(
    (status = 200, description = "The latest truth", body = ServerStatus)
))]
async fn status(State(server): State<Arc<ServerState>>) -> Json<ServerStatus> {
    Json(server.status().await)
}

async fn nowhere() -> Failure {
    Failure::not_found(
        "no_such_route",
        "there is nothing here: /api/v1/openapi.json lists every route",
    )
}
