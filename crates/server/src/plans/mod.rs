//! Plans for machines: domains from the skills of libraries, and planning by engines. Knows requests and their clients; the
//! supervisor knows plans and engines.

use crate::extract::Body;
use crate::gate::Gate;
use crate::{Failure, ServerState};
use axum::Json;
use axum::body::{Body as AnswerBody, Bytes};
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse as _, Response};
use futures_util::{StreamExt as _, stream};
use rafcon_protocol::api::{MakePlan, PlanDomain, PlanEvent, PlanPool, Refusal};
use rafcon_supervisor::Interpreter;
use rafcon_supervisor::planning::{Cancel, Planner, domain};
use std::convert::Infallible;
use std::sync::Arc;
use tokio::sync::{Semaphore, mpsc};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Maximum number of parallel engines: each may use a processor and gigabytes.
const ENGINES: usize = 2;
/// Maximum number of parallel reads of pools.
const POOLS: usize = 2;
/// Capacity of a client's queue, in lines. A full queue blocks the engine, and its time limit still runs.
const LINES: usize = 16;

/// Limits on engines and pools.
#[derive(Debug)]
pub(crate) struct Plans {
    engines: Arc<Semaphore>,
    pools: Gate,
}

impl Default for Plans {
    fn default() -> Self {
        Self { engines: Arc::new(Semaphore::new(ENGINES)), pools: Gate::of(POOLS) }
    }
}

/// The routes of this part.
pub(crate) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(make_plan)).routes(routes!(plan_domain))
}

/// The domain of a pool's skills: types, predicates, actions and findings.
#[utoipa::path(post, path = "/api/v1/plans/domain", tag = "plans", request_body = PlanPool, responses(
    (status = 200, description = "The domain; a pool that is not there is one of its findings", body = PlanDomain),
    (status = 400, description = "The body does not fit", body = Refusal),
    (status = 413, description = "The body is too large", body = Refusal),
    (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
))]
async fn plan_domain(
    State(server): State<Arc<ServerState>>,
    Body(pool): Body<PlanPool>,
) -> Result<Json<PlanDomain>, Failure> {
    let at = Arc::clone(&server);
    at.plans.pools.work(move || Ok(Json(domain(&pool, &server.projects.libraries())))).await
}

/// Plans with an engine. Each line of the response is an event, sent as it happens; the last one is never `found`. If the client
/// disconnects, the engine is stopped.
#[utoipa::path(post, path = "/api/v1/plans", tag = "plans", request_body = MakePlan, responses(
    (status = 200, description = "Lines of JSON: plans that are valid, with their machines, then how planning ended",
        content((PlanEvent = "application/jsonl"))),
    (status = 400, description = "The body does not fit", body = Refusal),
    (status = 413, description = "The body is too large", body = Refusal),
    (status = 422, description = "There is no Python", body = Refusal),
    (status = 429, description = "Too many engines are planning already", body = Refusal),
))]
async fn make_plan(
    State(server): State<Arc<ServerState>>,
    Body(request): Body<MakePlan>,
) -> Result<Response, Failure> {
    let turn = Arc::clone(&server.plans.engines).try_acquire_owned().map_err(|_all_taken| {
        let message = format!("{ENGINES} engines are planning already: try again when one is done");
        Failure::too_many("too_many_plans", message).retry_after(5)
    })?;
    let settings = &server.settings;
    let python = Interpreter::choose(settings.python.as_deref(), &settings.environment);
    let python = python.map_err(|error| Failure::unprocessable("no_python", error.to_string()))?;
    let (lines, received) = mpsc::channel(LINES);
    let cancel = Cancel::default();
    let wanted = Wanted { lines: received, cancel: cancel.clone() };
    tokio::task::spawn_blocking(move || {
        let _turn = turn;
        let libraries = server.projects.libraries();
        let environment = &server.settings.environment;
        let planner = Planner { libraries: &libraries, python: &python, environment };
        let tell = |event: &PlanEvent| {
            let Ok(mut line) = serde_json::to_vec(event) else { return };
            line.push(b'\n');
            // A client that has disconnected has already cancelled.
            lines.blocking_send(line.into()).unwrap_or_default();
        };
        let last = planner.plan(&request, &cancel, &mut |event| tell(&event));
        tell(&last);
    });
    let body = stream::unfold(wanted, |mut wanted| async move {
        let line = wanted.lines.recv().await?;
        Some((Ok::<_, Infallible>(line), wanted))
    })
    // A body may be polled again after its end.
    .fuse();
    Ok(([(CONTENT_TYPE, "application/jsonl")], AnswerBody::from_stream(body)).into_response())
}

/// The response in progress. Dropping it cancels the engine.
struct Wanted {
    lines: mpsc::Receiver<Bytes>,
    cancel: Cancel,
}

impl Drop for Wanted {
    fn drop(&mut self) {
        self.cancel.cancel();
    }
}
