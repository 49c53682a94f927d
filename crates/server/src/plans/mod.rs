//! Plans for machines: what the skills of libraries add up to, and engines that are asked for plans. Knows requests and who waits
//! for them; what plans are and how engines run knows the supervisor.

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

/// How many engines plan at a time: each may take a processor and gigabytes.
const ENGINES: usize = 2;
/// How many pools are read at a time.
const POOLS: usize = 2;
/// How many plans may wait for a client that reads slowly; the engine waits with them, and its time runs.
const LINES: usize = 16;

/// What plans.
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

/// What the skills of a pool add up to: types, predicates, actions, and what is wrong with them.
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

/// Asks an engine for plans. Each line of the answer is an event, told when it happens; the last is never `found`. A client that
/// goes away ends the engine.
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
    let python = Interpreter::choose(settings.python.as_deref(), &settings.surroundings);
    let python = python.map_err(|error| Failure::unprocessable("no_python", error.to_string()))?;
    let (lines, received) = mpsc::channel(LINES);
    let cancel = Cancel::default();
    let wanted = Wanted { lines: received, cancel: cancel.clone() };
    tokio::task::spawn_blocking(move || {
        let _turn = turn;
        let libraries = server.projects.libraries();
        let surroundings = &server.settings.surroundings;
        let planner = Planner { libraries: &libraries, python: &python, surroundings };
        let tell = |event: &PlanEvent| {
            let Ok(mut line) = serde_json::to_vec(event) else { return };
            line.push(b'\n');
            // A client that is gone has cancelled already.
            lines.blocking_send(line.into()).unwrap_or_default();
        };
        let last = planner.plan(&request, &cancel, &mut |event| tell(&event));
        tell(&last);
    });
    let body = stream::unfold(wanted, |mut wanted| async move {
        let line = wanted.lines.recv().await?;
        Some((Ok::<_, Infallible>(line), wanted))
    })
    // A body may be asked again after its end.
    .fuse();
    Ok(([(CONTENT_TYPE, "application/jsonl")], AnswerBody::from_stream(body)).into_response())
}

/// The answer as it is sent; when it is dropped, nobody wants it any more.
struct Wanted {
    lines: mpsc::Receiver<Bytes>,
    cancel: Cancel,
}

impl Drop for Wanted {
    fn drop(&mut self) {
        self.cancel.cancel();
    }
}
