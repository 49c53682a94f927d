//! Routes for the planned contacts with a robot of this station. Knows requests and rights. The station stores the plan.

use crate::access::Who;
use crate::extract::{Body, Path};
use crate::gate::blocking;
use crate::settings::ContactsFault;
use crate::{Failure, ServerState};
use axum::Json;
use axum::extract::State;
use rafcon_protocol::api::Refusal;
use rafcon_protocol::{BadContacts, ContactPlan, ContactWindow};
use rafcon_supervisor::clock;
use serde_json::Value;
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this file.
pub(super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(contacts, set_contacts))
}

/// The planned contacts with a robot.
#[utoipa::path(get, path = "/api/v1/robots/{robot}/contacts", tag = "runs",
    params(("robot" = String, Path, description = "The robot's name at this station")),
    responses(
        (status = 200, description = "The contact windows, in their order", body = [ContactWindow]),
        (status = 404, description = "This server receives no such robot", body = Refusal),
        (status = 503, description = "The file of the contacts cannot be read", body = Refusal),
    )
)]
async fn contacts(
    State(server): State<Arc<ServerState>>,
    Path(robot): Path<String>,
) -> Result<Json<Vec<ContactWindow>>, Failure> {
    let plan = server.robots(&robot)?.contacts(&robot).map_err(|why| failed(&robot, why))?;
    Ok(Json(plan.windows()))
}

/// Replaces the planned contacts with a robot.
///
/// The windows are in the order of their times and do not overlap. An empty list removes the plan. A list that is refused changes
/// nothing. The plan sets expected times and lifetimes of commands; the station sends outside of contacts, too.
#[utoipa::path(put, path = "/api/v1/robots/{robot}/contacts", tag = "runs", request_body = Vec<ContactWindow>,
    params(("robot" = String, Path, description = "The robot's name at this station")),
    responses(
        (status = 200, description = "The contact windows, as they are stored", body = [ContactWindow]),
        (status = 400, description = "The list is no plan; the message names the window", body = Refusal),
        (status = 404, description = "This server receives no such robot", body = Refusal),
        (status = 413, description = "The request is too large", body = Refusal),
        (status = 503, description = "The contacts cannot be stored; the plan before counts", body = Refusal),
    )
)]
async fn set_contacts(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(robot): Path<String>,
    Body(windows): Body<Value>,
) -> Result<Json<Vec<ContactWindow>>, Failure> {
    let robots = server.robots(&robot)?;
    let plan = ContactPlan::of_json(&windows).map_err(bad)?;
    plan.check_future(clock::since_1970_ms()).map_err(bad)?;
    let stored = plan.windows();
    let name = robot.clone();
    blocking(move || robots.set_contacts(&name, plan).map_err(|why| failed(&name, why))).await?;
    server.audit().note(&who.user, "contacts_set", &format!("of {robot}: {}", stored.len()));
    Ok(Json(stored))
}

#[expect(clippy::needless_pass_by_value, reason = "it maps the error of a result")]
fn bad(why: BadContacts) -> Failure {
    Failure::bad("bad_contacts", why.to_string())
}

fn failed(robot: &str, why: ContactsFault) -> Failure {
    match why {
        ContactsFault::NotReceived(why) => {
            Failure::not_found("no_such_robot", format!("robot {robot}: {why}"))
        }
        ContactsFault::Storage(why) => {
            Failure::unavailable("contacts_unavailable", format!("robot {robot}: {why}"))
        }
    }
}
