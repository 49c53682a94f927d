//! Routes for the command list of a robot: read, replace and release. Knows requests, rights, control and the records of runs. The
//! station has the list and the link.

use crate::access::{Who, of_command};
use crate::extract::{Body, Path, Query};
use crate::gate::blocking;
use crate::settings::{CommandListFault, Robots};
use crate::{Failure, ServerState};
use axum::Json;
use axum::extract::State;
use rafcon_protocol::api::{LineRequest, ListChange, ListRequest, Refusal, Right, RunPhase};
use rafcon_protocol::{Answer, CommandList, ListFate, ListLine, ListedCommand, ReleaseList};
use rafcon_supervisor::clock;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this file.
pub(super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new()
        .routes(routes!(command_list, set_command_list))
        .routes(routes!(release_command_list))
}

/// The command list of a robot.
///
/// Each line has its times, its fault and, after a release, its fate. Faults of rights and control are those of the sender.
#[utoipa::path(get, path = "/api/v1/robots/{robot}/commands", tag = "runs",
    params(("robot" = String, Path, description = "The robot's name at this station")),
    responses(
        (status = 200, description = "The list", body = CommandList),
        (status = 404, description = "This server receives no such robot", body = Refusal),
        (status = 503, description = "The file of the list cannot be used, or the station does not answer", body = Refusal),
    )
)]
async fn command_list(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(robot): Path<String>,
) -> Result<Json<CommandList>, Failure> {
    let list = ask(&server, &robot, |robots, robot| robots.command_list(robot)).await?;
    Ok(Json(reviewed_list(&server, &who, &robot, list).await.0))
}

/// Replaces the command list of a robot.
///
/// The new list has a new revision and is not released. With `revision`, only a list of that revision is replaced. An invalid text
/// is refused. A list with faulty commands is stored, but cannot be released.
#[utoipa::path(put, path = "/api/v1/robots/{robot}/commands", tag = "runs", request_body = Vec<ListedCommand>,
    params(("robot" = String, Path, description = "The robot's name at this station"), ListChange),
    responses(
        (status = 200, description = "The list, as it is stored", body = CommandList),
        (status = 400, description = "It is no list of commands; the message names the line", body = Refusal),
        (status = 404, description = "This server receives no such robot", body = Refusal),
        (status = 409, description = "The list has another revision, and was not changed", body = Refusal),
        (status = 413, description = "The request is too large", body = Refusal),
        (status = 503, description = "The list cannot be stored, or the station does not answer", body = Refusal),
    )
)]
async fn set_command_list(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(robot): Path<String>,
    Query(ListChange { revision }): Query<ListChange>,
    Body(commands): Body<Value>,
) -> Result<Json<CommandList>, Failure> {
    let commands = ListedCommand::list_of_json(&commands)
        .map_err(|why| Failure::bad("bad_command_list", why.to_string()))?;
    let set = move |robots: &dyn Robots, robot: &str| {
        robots.set_command_list(robot, commands, revision.as_deref())
    };
    let list = ask(&server, &robot, set).await?;
    let about = format!("of {robot}, revision {}: {}", list.revision, list.lines.len());
    server.audit().note(&who.user, "command_list_set", &about);
    Ok(Json(reviewed_list(&server, &who, &robot, list).await.0))
}

/// Releases the command list of a robot.
///
/// Sends all commands or none: a fault in any line refuses the release, and the message names all faults. For a list that was
/// already released, it resends the commands with unknown fates under their old ids. The robot executes each at most once.
#[utoipa::path(post, path = "/api/v1/robots/{robot}/commands/release", tag = "runs", request_body = ReleaseList,
    params(("robot" = String, Path, description = "The robot's name at this station")),
    responses(
        (status = 200, description = "The released list, with the fate of each command", body = CommandList),
        (status = 400, description = "Something is wrong with the request itself", body = Refusal),
        (status = 404, description = "This server receives no such robot", body = Refusal),
        (status = 409, description = "The list was changed since it was reviewed, or has a fault; no command was sent", body = Refusal),
        (status = 413, description = "The request is too large", body = Refusal),
        (status = 503, description = "The release cannot be stored, or the station does not answer", body = Refusal),
    )
)]
async fn release_command_list(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(robot): Path<String>,
    Body(ReleaseList { revision }): Body<ReleaseList>,
) -> Result<Json<CommandList>, Failure> {
    let reviewed = ask(&server, &robot, |robots, robot| robots.command_list(robot)).await?;
    if reviewed.revision != revision {
        let why = "the list was changed since it was reviewed: nothing was sent; review it again";
        return Err(failed(&robot, CommandListFault::Changed(why.to_owned())));
    }
    let (reviewed, settled) = reviewed_list(&server, &who, &robot, reviewed).await;
    let line = |(line, is_settled): (ListLine, bool)| LineRequest { fault: line.fault, is_settled };
    let lines = reviewed.lines.into_iter().zip(settled).map(line).collect();
    let request = ListRequest { revision, user: who.user.clone(), lines };
    let release =
        move |robots: &dyn Robots, robot: &str| robots.release_command_list(robot, &request);
    let list = ask(&server, &robot, release).await?;
    let about = format!("of {robot}, revision {}: {}", list.revision, list.lines.len());
    server.audit().note(&who.user, "command_list_released", &about);
    Ok(Json(reviewed_list(&server, &who, &robot, list).await.0))
}

/// Runs a request for a robot's list on the station.
async fn ask(
    server: &ServerState,
    robot: &str,
    question: impl FnOnce(&dyn Robots, &str) -> Result<CommandList, CommandListFault> + Send + 'static,
) -> Result<CommandList, Failure> {
    let robots = server.robots(robot)?;
    let name = robot.to_owned();
    blocking(move || question(&*robots, &name).map_err(|why| failed(&name, why))).await
}

fn failed(robot: &str, why: CommandListFault) -> Failure {
    let message = |why: String| format!("robot {robot}: {why}");
    match why {
        CommandListFault::NotReceived(why) => Failure::not_found("no_such_robot", message(why)),
        CommandListFault::Unavailable(why) => {
            Failure::unavailable("command_list_unavailable", message(why))
        }
        CommandListFault::Changed(why) => Failure::conflict("command_list_changed", message(why)),
        CommandListFault::Faulty(why) => Failure::conflict("command_list_faulty", message(why)),
    }
}

/// Adds to the list the fates from the records of the runs, and the faults in the user's rights and control. Also returns, for each
/// line, whether a release would skip it.
async fn reviewed_list(
    server: &Arc<ServerState>,
    who: &Who,
    robot: &str,
    mut list: CommandList,
) -> (CommandList, Vec<bool>) {
    let mut settled: Vec<_> = list.lines.iter().map(is_answered).collect();
    if list.released.is_some() {
        let recorded = recorded_fates(server, &list).await;
        for ((line, is_settled), recorded) in list.lines.iter_mut().zip(&mut settled).zip(recorded)
        {
            *is_settled |= recorded.answer.is_some() || recorded.is_run_over;
            set_fate(line, recorded);
        }
    }
    // Users without the right to command see no faults in their own rights.
    if who.must(Right::Command).is_ok() {
        for (line, is_settled) in list.lines.iter_mut().zip(&settled) {
            if line.fault.is_none() && !is_settled && is_to_send(line) {
                line.fault = own_fault(server, who, robot, &line.listed).await;
            }
        }
    }
    (list, settled)
}

/// The record of a run about one command.
#[derive(Debug, Clone, Default)]
struct RecordedFate {
    answer: Option<Answer>,
    is_run_over: bool,
}

/// Fates of the commands of a released list, from the records of their runs.
async fn recorded_fates(server: &Arc<ServerState>, list: &CommandList) -> Vec<RecordedFate> {
    let mut by_run: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, line) in list.lines.iter().enumerate().filter(|(_, line)| !is_answered(line)) {
        by_run.entry(&line.listed.run).or_default().push(index);
    }
    let mut fates = vec![RecordedFate::default(); list.lines.len()];
    for (run, lines) in by_run {
        let Ok(run) = server.runs.get(run).await else { continue };
        let is_run_over = matches!(run.summary().phase, RunPhase::Finished { .. });
        let id = |line: &usize| CommandList::id(&list.revision, *line);
        let ids: Vec<_> = lines.iter().map(id).collect();
        let read = server.history.readers().read(run.folder().to_path_buf(), move |reader| {
            let moment = reader.moment(u64::MAX)?;
            Ok(ids.iter().map(|id| moment.whole().answer(id).cloned()).collect::<Vec<_>>())
        });
        // An unreadable record leaves the fates unknown.
        for (line, answer) in lines.into_iter().zip(read.await.unwrap_or_default()) {
            fates[line] = RecordedFate { answer, is_run_over };
        }
    }
    fates
}

/// Sets the fate of a released command that the station does not know.
fn set_fate(line: &mut ListLine, RecordedFate { answer, is_run_over }: RecordedFate) {
    if is_answered(line) {
        return;
    }
    if let Some(answer) = answer {
        (line.fate, line.fault) = (Some(ListFate::Answered { answer }), None);
    } else if line.fate.is_none() {
        let reason = if is_run_over {
            line.fault = None;
            "the run is over, and its record has no answer to the command"
        } else if is_over(line) {
            "it expired without a known answer; the robot may have carried it out, and the record of the run then shows it later"
        } else {
            "the station was started again since the release, and the robot may have the command; release the list again to send it: the robot \
             carries it out at most once"
        };
        let answer = Answer::Unknown { reason: reason.to_owned() };
        line.fate = Some(ListFate::Answered { answer });
    }
}

/// True if the fate of the command is known.
fn is_answered(line: &ListLine) -> bool {
    matches!(&line.fate, Some(ListFate::Answered { answer }) if is_known(answer))
}

fn is_known(answer: &Answer) -> bool {
    !matches!(answer, Answer::Unknown { .. })
}

fn is_over(line: &ListLine) -> bool {
    line.expires_ms.is_some_and(|expires_ms| expires_ms <= clock::since_1970_ms())
}

/// True if a release now would send the command.
fn is_to_send(line: &ListLine) -> bool {
    match &line.fate {
        None => true,
        Some(ListFate::Open { .. }) => false,
        Some(ListFate::Answered { answer }) => !is_known(answer) && !is_over(line),
    }
}

/// Fault of a command for this user: a run of another robot, a missing right, or another user in control.
async fn own_fault(
    server: &Arc<ServerState>,
    who: &Who,
    robot: &str,
    ListedCommand { run, command, .. }: &ListedCommand,
) -> Option<String> {
    if let Err(failure) = who.must(of_command(command)) {
        return Some(failure.to_string());
    }
    let run = server.runs.get(run).await.ok()?;
    if run.robot().as_deref() != Some(robot) {
        return Some(format!("the run is not one of {robot}: write an id of `rafcon runs`"));
    }
    let holder = run.now().borrow().control.holder.clone()?;
    let is_free = command.is_for_everybody() || holder == who.user;
    (!is_free).then(|| {
        format!("{holder} holds control of the run: request control, then release the list")
    })
}
