//! `DELETE …` and `POST …/prune`: deletes runs, never active ones. Knows folders of runs.

use super::folder;
use crate::extract::{Body, Path};
use crate::gate::blocking;
use crate::{Failure, ServerState};
use axum::Json;
use axum::extract::State;
use rafcon_protocol::api::{Pruned, Refusal, Retention};
use rafcon_storage::journal;
use rafcon_supervisor::clock;
use std::path::Path as FilePath;
use std::sync::Arc;
use std::time::Duration;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

const DAY: u64 = 86_400;

/// The routes of this file.
pub(super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(delete)).routes(routes!(prune))
}

/// Deletes a run that is not active.
#[utoipa::path(delete, path = "/api/v1/runs/{run}", tag = "history",
    params(("run" = String, Path, description = "The run's id")),
    responses(
        (status = 200, description = "The run was deleted", body = Pruned),
        (status = 400, description = "The address makes no sense", body = Refusal),
        (status = 404, description = "There is no such run", body = Refusal),
        (status = 409, description = "The run is active", body = Refusal),
        (status = 503, description = "The run cannot be deleted now", body = Refusal),
    )
)]
async fn delete(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
) -> Result<Json<Pruned>, Failure> {
    if server.runs.get(&run).await?.is_live() {
        let message = format!("the run {run} is active: stop it first");
        return Err(Failure::conflict("run_goes_on", message));
    }
    let folder = folder(&server, &run).await?;
    blocking(move || {
        server.history.forget(&folder);
        let removed = journal::remove(&folder)?;
        gone(&server, &folder);
        let removed = removed.ok_or_else(|| {
            let message = format!("somebody else has deleted the run {run}");
            Failure::not_found("no_such_run", message)
        })?;
        Ok(Json(Pruned { id: removed.id, bytes: removed.bytes }))
    })
    .await
}

/// Deletes old runs.
///
/// An omitted limit means unlimited. The 10 newest runs and all active runs are never deleted.
#[utoipa::path(post, path = "/api/v1/runs/prune", tag = "history", request_body = Retention,
    responses(
        (status = 200, description = "The deleted runs", body = [Pruned]),
        (status = 400, description = "The body makes no sense", body = Refusal),
        (status = 413, description = "The body is too large", body = Refusal),
        (status = 503, description = "A run cannot be deleted now", body = Refusal),
    )
)]
async fn prune(
    State(server): State<Arc<ServerState>>,
    Body(wanted): Body<Retention>,
) -> Result<Json<Vec<Pruned>>, Failure> {
    blocking(move || {
        let all = &server.settings.runs;
        let pruned = retention(wanted).prune(all, clock::since_1970_ms())?;
        let told = |it: journal::Pruned| {
            let folder = all.join(&it.id);
            server.history.forget(&folder);
            gone(&server, &folder);
            Pruned { id: it.id, bytes: it.bytes }
        };
        Ok(Json(pruned.into_iter().map(told).collect()))
    })
    .await
}

fn gone(server: &ServerState, folder: &FilePath) {
    server.runs.forget_folder(folder);
}

fn retention(wanted: Retention) -> journal::Retention {
    let count = wanted.count.and_then(|count| usize::try_from(count).ok());
    journal::Retention {
        count: count.unwrap_or(usize::MAX),
        age: wanted.days.map(|days| Duration::from_secs(u64::from(days) * DAY)),
        bytes: wanted.bytes.unwrap_or(u64::MAX),
        ..journal::Retention::default()
    }
}
