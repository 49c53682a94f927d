//! Requests of a station's users to a robot, which starts and resumes its own runs and reports the fate of each request.

use super::commands::COMMAND_TIMEOUT;
use super::resume::EXPIRED;
use super::start::{check, start_again_here};
use crate::access::{Who, of_start};
use crate::extract::Path;
use crate::settings::{MachinesFault, NotTaken};
use crate::{Failure, ServerState};
use axum::Json;
use axum::extract::State;
use rafcon_protocol::api::{
    Refusal, Right, RobotAnswer, RobotMachines, RobotRequest, StartAgain, StartOf, StartRequest,
    StartRun, StartedRun,
};
use std::sync::Arc;
use tokio::sync::oneshot;
use tokio::time::timeout;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Sends a user's request to a robot and waits for its result. Returns the id of the run.
pub(super) async fn carry_out(
    server: &ServerState,
    robot: &str,
    request: RobotRequest,
) -> Result<String, Failure> {
    let (answer, answered) = oneshot::channel();
    // After a timeout the receiver is dropped. A repeated request gets the result.
    let answered_by_robot = Box::new(move |it| answer.send(it).unwrap_or_default());
    let is_start = matches!(request, RobotRequest::Start(_));
    let not_taken = |why| match why {
        // Users name the robot of a start. A resume uses the robot of the run.
        NotTaken::NotReceived(why) if is_start => {
            Failure::not_found("no_such_robot", format!("robot {robot}: {why}"))
        }
        NotTaken::NotReceived(why) => {
            Failure::unavailable("robot_not_received", format!("robot {robot}: {why}"))
        }
        NotTaken::Full(why) => Failure::too_many("too_many_requests", why),
    };
    let robots =
        server.settings.robots.as_ref().ok_or_else(|| {
            not_taken(NotTaken::NotReceived("this server is no station".to_owned()))
        })?;
    let (user, action, of) = match &request {
        RobotRequest::Resume(it) => (it.user.clone(), "resume_asked", format!("{} of ", it.run)),
        RobotRequest::Start(it) => (it.user.clone(), "start_asked", String::new()),
    };
    robots.request(robot, request, answered_by_robot).map_err(not_taken)?;
    server.audit().note(&user, action, &format!("{of}{robot}"));
    match timeout(COMMAND_TIMEOUT, answered).await {
        Ok(Ok(RobotAnswer::Done { run })) => Ok(run),
        Ok(Ok(RobotAnswer::Refused { reason })) => {
            Err(Failure::conflict("refused_by_robot", format!("{robot}: {reason}")))
        }
        Ok(Ok(RobotAnswer::Expired)) => {
            let message = format!(
                "robot {robot} did not receive the request in time and did nothing: repeat it with another id"
            );
            Err(Failure::conflict(EXPIRED, message))
        }
        Ok(Ok(RobotAnswer::Unknown { reason })) => Err(Failure::conflict("fate_unknown", reason)),
        Ok(Err(_)) | Err(_) => {
            let message = format!(
                "robot {robot} has not answered yet; the station repeats the request until it expires: send it again with its id"
            );
            Err(Failure::unavailable("not_finished", message))
        }
    }
}

/// The routes of this file.
pub(super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(robots)).routes(routes!(machines))
}

/// Names of the robots that this server receives as their station. Empty at any other server.
#[utoipa::path(get, path = "/api/v1/robots", tag = "runs",
    responses((status = 200, description = "The names, in their order", body = [String]))
)]
async fn robots(State(server): State<Arc<ServerState>>) -> Json<Vec<String>> {
    let robots = server.settings.robots.as_ref();
    Json(robots.map(|robots| robots.names()).unwrap_or_default())
}

/// The machines in the projects of a robot, which it can start.
///
/// The robot sends the list after each change, so it is as old as the signal of the robot.
#[utoipa::path(get, path = "/api/v1/robots/{robot}/machines", tag = "runs",
    params(("robot" = String, Path, description = "The robot's name at this station")),
    responses(
        (status = 200, description = "The list that arrived last", body = RobotMachines),
        (status = 404, description = "This server receives no such robot", body = Refusal),
        (status = 503, description = "No list has arrived yet", body = Refusal),
    )
)]
async fn machines(
    State(server): State<Arc<ServerState>>,
    Path(robot): Path<String>,
) -> Result<Json<RobotMachines>, Failure> {
    let failed = |why| match why {
        MachinesFault::NotReceived(why) => {
            Failure::not_found("no_such_robot", format!("robot {robot}: {why}"))
        }
        MachinesFault::NotArrived(why) => {
            Failure::unavailable("machines_unknown", format!("robot {robot}: {why}"))
        }
    };
    server.robots(&robot)?.machines(&robot).map(Json).map_err(failed)
}

/// Asks a robot to start a machine of its projects.
pub(super) async fn start(
    server: &ServerState,
    who: &Who,
    robot: String,
    asked: StartRun,
) -> Result<StartedRun, Failure> {
    check(&asked)?;
    who.must(of_start(&asked))?;
    let id = asked.id.clone();
    let start = request(who, &id, StartOf::Machine(Box::new(asked)));
    by_robot(server, robot, start).await
}

/// Starts the machine of a run again, on the computer of that run.
pub(super) async fn start_again(
    server: &Arc<ServerState>,
    who: &Who,
    run: &str,
    StartAgain { id }: StartAgain,
) -> Result<StartedRun, Failure> {
    crate::extract::check_request_id(&id)?;
    let run = server.runs.get(run).await?;
    if let Some(robot) = run.robot() {
        let may_edit = who.must(Right::Edit).is_ok();
        let start = request(who, &id, StartOf::Again(run.id().to_owned(), may_edit));
        return by_robot(server, robot, start).await;
    }
    let started = start_again_here(server, who, run, id).await?;
    Ok(StartedRun { run: started.id, robot: None })
}

fn request(who: &Who, id: &str, of: StartOf) -> StartRequest {
    // The id of a command begins with the name of a user.
    let id = format!("//start/{}/{id}", who.user);
    StartRequest { id, user: who.user.clone(), of, expiry_ms: None, no_edit: None }
}

async fn by_robot(
    server: &ServerState,
    robot: String,
    start: StartRequest,
) -> Result<StartedRun, Failure> {
    let run = carry_out(server, &robot, RobotRequest::Start(start)).await?;
    Ok(StartedRun { run, robot: Some(robot) })
}
