//! Large values that are on a robot but not at its station: their cost and their transfer. Knows journals; does not know the link.

use super::moments::value;
use super::{Json, folder, read};
use crate::extract::{Body, Path};
use crate::settings::{Robots, RunValue};
use crate::{Failure, ServerState};
use axum::extract::State;
use rafcon_protocol::api::{FetchValue, KeptAs, KeptValue, Refusal};
use rafcon_storage::journal::{Reader, ValueNumber, is_content_here};
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this file.
pub(super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(fetch, cancel))
}

/// Availability of a value that is stored in a separate file of a run.
pub(super) fn kept_in_file(
    reader: &Reader,
    robots: Option<&dyn Robots>,
    number: ValueNumber,
    hash: &str,
    bytes: u64,
) -> KeptAs {
    let about = reader.about();
    let Some(robot) = &about.robot else { return KeptAs::Pickle { bytes } };
    if is_content_here(reader.folder(), hash, bytes) {
        return KeptAs::Pickle { bytes };
    }
    let cost = robots.and_then(|robots| robots.cost(robot, bytes));
    let (link_bytes, takes_ms) = cost.unzip();
    let value = RunValue { run: &about.id, number: number.0 };
    let fetch = robots.and_then(|robots| robots.progress(value));
    KeptAs::OnRobot { bytes, link_bytes, takes_ms: takes_ms.flatten(), fetch }
}

/// Fetches a large value from its robot.
///
/// The transfer uses the link only while nothing else needs it, and continues after blackouts and restarts. `GET` of the value
/// shows its progress. A value that needs more than `budget` bytes is not sent. A repeated request sets a new budget.
#[utoipa::path(post, path = "/api/v1/runs/{run}/values/{value}/fetch", tag = "history", request_body = FetchValue,
    params(
        ("run" = String, Path, description = "The run's id"),
        ("value" = u64, Path, description = "The value's number"),
    ),
    responses(
        (status = 200, description = "It is on its way, or here", body = KeptValue),
        (status = 400, description = "Something is wrong with the request itself", body = Refusal),
        (status = 404, description = "There is no such run or value", body = Refusal),
        (status = 409, description = "It is nothing that could be fetched, or this server does not receive the robot", body = Refusal),
        (status = 413, description = "The request is too large", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn fetch(
    State(server): State<Arc<ServerState>>,
    Path((run, number)): Path<(String, u64)>,
    Body(wanted): Body<FetchValue>,
) -> Result<Json, Failure> {
    let robots = server.settings.robots.clone();
    read(&server, &run, move |reader| {
        let number = ValueNumber(number);
        let before = kept(reader, robots.as_deref(), number)?;
        let (robot, id) = (reader.about().robot.clone(), reader.about().id.clone());
        match (&before.kept, robot, &robots) {
            (KeptAs::OnRobot { bytes, .. }, Some(robot), Some(robots)) => {
                let budget = wanted.budget.unwrap_or(bytes.saturating_add(bytes / 4 + 4_096));
                let value = RunValue { run: &id, number: number.0 };
                if !robots.fetch(&robot, value, *bytes, budget) {
                    return Err(not_received(&robot));
                }
            }
            (KeptAs::OnRobot { .. }, Some(robot), None) => return Err(not_received(&robot)),
            (KeptAs::Pickle { .. } | KeptAs::View, Some(_), _) => {}
            _ => return Err(nothing_to_fetch(number)),
        }
        Json::of(&kept(reader, robots.as_deref(), number)?)
    })
    .await
}

/// Cancels the transfer of a large value and drops its received part.
#[utoipa::path(delete, path = "/api/v1/runs/{run}/values/{value}/fetch", tag = "history",
    params(
        ("run" = String, Path, description = "The run's id"),
        ("value" = u64, Path, description = "The value's number"),
    ),
    responses(
        (status = 200, description = "It is not on its way any more", body = KeptValue),
        (status = 400, description = "This is no number", body = Refusal),
        (status = 404, description = "There is no such run or value", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn cancel(
    State(server): State<Arc<ServerState>>,
    Path((run, number)): Path<(String, u64)>,
) -> Result<Json, Failure> {
    folder(&server, &run).await?;
    let robots = server.settings.robots.clone();
    read(&server, &run, move |reader| {
        let about = reader.about();
        if let (Some(robot), Some(robots)) = (&about.robot, &robots) {
            robots.cancel(robot, RunValue { run: &about.id, number });
        }
        Json::of(&kept(reader, robots.as_deref(), ValueNumber(number))?)
    })
    .await
}

/// A stored value of a run.
pub(super) fn kept(
    reader: &Reader,
    robots: Option<&dyn Robots>,
    number: ValueNumber,
) -> Result<KeptValue, Failure> {
    let stored = reader.value(number)?.ok_or_else(|| {
        let message = format!("the run keeps no value {}, or does not any more", number.0);
        Failure::not_found("no_such_value", message)
    })?;
    Ok(value(reader, robots, number, stored))
}

fn not_received(robot: &str) -> Failure {
    let message = format!(
        "this server does not receive robot `{robot}`: fetch the value at its station, `rafcon station`"
    );
    Failure::conflict("not_received_here", message)
}

fn nothing_to_fetch(number: ValueNumber) -> Failure {
    let message = format!("value {} is nothing that a robot has and this server lacks", number.0);
    Failure::conflict("nothing_to_fetch", message)
}
