//! All routes as one, and their description.

use crate::access::{self, guarded};
use crate::{Failure, House, history, page, projects, runs};
use axum::{Json, Router};
use rafcon_protocol::api::Health;
use std::sync::Arc;
use utoipa::OpenApi as _;
use utoipa::openapi::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The head of the description.
#[derive(Debug, utoipa::OpenApi)]
#[openapi(info(
    title = "RAFCON",
    description = "Projects, open machines, runs and people. See docs/api.md for what the words mean and for the WebSocket."
))]
struct Description;

/// Every route; each part of the server brings its own.
fn all() -> OpenApiRouter<Arc<House>> {
    OpenApiRouter::with_openapi(Description::openapi())
        .routes(routes!(health))
        .routes(routes!(description))
        .merge(page::routes())
        .merge(access::routes())
        .merge(projects::routes())
        .merge(runs::routes())
        .merge(history::routes())
}

/// What answers requests.
pub fn router(house: Arc<House>) -> Router {
    let (router, _description) = all().split_for_parts();
    guarded(router.fallback(nowhere), &house).with_state(house)
}

/// The description of every route, as it is served under `/api/v1/openapi.json`.
pub fn openapi() -> OpenApi {
    all().into_openapi()
}

/// Whether the server is there.
#[utoipa::path(get, path = "/api/v1/health", tag = "house", responses((status = 200, body = Health)))]
async fn health() -> Json<Health> {
    Json(Health { program: "rafcon".to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() })
}

/// This description.
#[utoipa::path(get, path = "/api/v1/openapi.json", tag = "house", responses((status = 200, body = Object)))]
async fn description() -> Json<OpenApi> {
    Json(openapi())
}

async fn nowhere() -> Failure {
    Failure::not_found(
        "no_such_route",
        "there is nothing here: /api/v1/openapi.json lists every route",
    )
}
