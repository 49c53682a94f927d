//! Commands of runs: authorization, delivery to the runner, and replies. Knows rights, control and links, but not the effect of a command.

use super::control::GivenCommand;
use super::folder_files::key;
use super::link::{Link, NotSent};
use super::run::Run;
use super::talk::{self, LinkError};
use crate::access::{Who, of_command};
use crate::failure::reason;
use crate::gate::blocking;
use crate::{Failure, ServerState};
use rafcon_protocol::api::{CommandAnswer, Control, ControlMove, Right, RunPhase};
use rafcon_protocol::{Answer, Command, Envelope, StateData};
use rafcon_storage::journal::writer_of;
use rafcon_supervisor::clock;
use rustix::process::{Pid, Signal, kill_process};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::{sleep, timeout};

/// Timeout of a command. A runner with a failing disk may take long.
pub(super) const COMMAND_TIMEOUT: Duration = Duration::from_secs(30);

/// Timeout of a stop; then the process of the run is killed. A runner whose engine does not stop ends itself a little before.
const STOP_TIMEOUT: Duration = Duration::from_secs(15);

/// Interval after which a stop is resent if its link was lost.
const RETRY_INTERVAL: Duration = Duration::from_millis(100);

/// Gives a command to a run for a user.
pub(crate) async fn command(
    server: &Arc<ServerState>,
    who: &Who,
    run: &str,
    envelope: Envelope,
) -> Result<CommandAnswer, Failure> {
    who.must(of_command(&envelope.command))?;
    crate::extract::check_request_id(&envelope.id)?;
    if let Command::Control { .. } = envelope.command {
        let message = "control is requested, handed over and released at POST …/control";
        return Err(Failure::bad("use_control", message));
    }
    let run = server.runs.get(run).await?;
    let id = envelope.id.clone();
    let known = key(&who.user, &id);
    if !is_commanded(&run) {
        return answered_before(server, &run, id, known).await;
    }
    // The robot decides who commands a remote run.
    if !envelope.command.is_for_everybody() && !run.is_replica() {
        take(server, &run, GivenCommand { user: &who.user, id: &known, epoch: envelope.epoch })?;
    }
    let known_id = known.clone();
    let envelope = Envelope { id: known, author: who.user.clone(), ..envelope };
    let answer = if envelope.command == Command::Stop {
        stop(server, who, &run, envelope).await?
    } else {
        send(&run, envelope).await?
    };
    if let Answer::Refused { .. } = answer {
        refused(server, &run, &known_id);
    }
    Ok(CommandAnswer { id, answer })
}

/// True if the run has a runner that can be commanded. With a link it has one, unless it has finished.
fn is_commanded(run: &Run) -> bool {
    let is_finished = matches!(run.summary().phase, RunPhase::Finished { .. });
    run.is_live() || (run.link().is_some() && !is_finished)
}

/// Gives control to the first user who commands, and denies users other than the holder.
pub(super) fn take(
    server: &ServerState,
    run: &Arc<Run>,
    given: GivenCommand<'_>,
) -> Result<(), Failure> {
    let now_ms = clock::since_1970_ms();
    with_control(server, run, given.user, |holding| holding.command(given, now_ms, run.silence()))
}

/// The run refused a command, so the command gives nobody control.
pub(super) fn refused(server: &ServerState, run: &Arc<Run>, id: &str) {
    let now_ms = clock::since_1970_ms();
    let user = id.split_once('/').map_or(id, |(user, _)| user);
    let freed = with_control(server, run, user, |holding| {
        holding.refused(id, now_ms);
        Ok(())
    });
    freed.unwrap_or_default();
}

/// Changes control of a run for a user.
pub(crate) async fn control(
    server: &Arc<ServerState>,
    who: &Who,
    run: &str,
    wanted: &ControlMove,
) -> Result<Control, Failure> {
    let run = server.runs.get(run).await?;
    if !run.is_live() {
        let message = "the run is not active and accepts no commands: resume it, or start another";
        return Err(Failure::conflict("run_is_not_live", message));
    }
    match wanted {
        ControlMove::HandOver { to } => may_command(server, to).await?,
        ControlMove::Override => who.must(Right::Administer)?,
        _ => {}
    }
    if run.is_replica() {
        ask_robot(&run, who, wanted).await?;
    } else {
        move_holder(server, &run, &who.user, wanted)?;
    }
    let control = run.now().borrow().control.clone();
    Ok(control)
}

/// Changes control of a local run.
pub(super) fn move_holder(
    server: &ServerState,
    run: &Arc<Run>,
    user: &str,
    wanted: &ControlMove,
) -> Result<(), Failure> {
    let now_ms = clock::since_1970_ms();
    with_control(server, run, user, |holding| holding.apply(user, wanted, now_ms, run.silence()))?;
    if *wanted == ControlMove::Override {
        server.audit().note(user, "control_override", &format!("of {}", run.id()));
    }
    Ok(())
}

/// Requests a change of control from the robot of a replica, and waits for the reply.
async fn ask_robot(run: &Run, who: &Who, wanted: &ControlMove) -> Result<(), Failure> {
    let link = run.linked().await.ok_or_else(link_lost)?;
    let id = format!("{}/control-{}-{}", who.user, clock::since_1970_ms(), run.next_note());
    let asked = link.move_control(id, &who.user, wanted.clone()).map_err(not_sent)?;
    match timeout(COMMAND_TIMEOUT, asked).await {
        Ok(Ok(Answer::Applied)) => Ok(()),
        Ok(Ok(Answer::Refused { reason })) => Err(Failure::conflict("not_in_control", reason)),
        Ok(Ok(Answer::Expired | Answer::Unknown { .. })) | Err(_) => Err(robot_late()),
        Ok(Err(_lost)) => Err(link_lost()),
    }
}

/// Control can be handed over only to a user who may command.
async fn may_command(server: &Arc<ServerState>, user: &str) -> Result<(), Failure> {
    // A user of the remote side is checked there.
    if user.contains('@') {
        return Ok(());
    }
    let (here, name) = (Arc::clone(server), user.to_owned());
    if blocking(move || Ok(here.people().users().may(&name, Right::Command))).await? {
        return Ok(());
    }
    let message = format!(
        "{user} is nobody who may command runs: hand control over to an operator, engineer or admin"
    );
    Err(Failure::conflict("not_in_control", message))
}

/// Changes the state of control. A change is stored; a new holder is also sent to the runner for the journal.
fn with_control(
    server: &ServerState,
    run: &Arc<Run>,
    user: &str,
    act: impl FnOnce(&mut super::control::Holding) -> Result<(), super::control::Denied>,
) -> Result<(), Failure> {
    let (before, done, after) = run.with_holding(|holding| {
        let before = holding.clone();
        let done = act(holding);
        (before, done, holding.clone())
    });
    done.map_err(|denied| Failure::conflict("not_in_control", denied.to_string()))?;
    if before != after {
        keep_holder(run);
    }
    if before.holder() != after.holder() {
        let holder = after.holder().unwrap_or("nobody");
        let epoch = after.epoch();
        server.audit().note(
            user,
            "control",
            &format!("of {} to {holder}, epoch {epoch}", run.id()),
        );
        note(run, user, after.holder(), epoch);
    }
    Ok(())
}

/// Stores the state of control in the background.
fn keep_holder(run: &Arc<Run>) {
    let run = Arc::clone(run);
    drop(tokio::task::spawn_blocking(move || run.keep_holding()));
}

/// Sends a note of the new control to the runner of a live run, for its journal.
fn note(run: &Run, user: &str, holder: Option<&str>, epoch: u64) {
    if !run.is_live() {
        return;
    }
    let (now_ms, number) = (clock::since_1970_ms(), run.next_note());
    let command = Command::Control { holder: holder.map(str::to_owned) };
    let id = format!("control-{now_ms}-{number}");
    run.send_note(Envelope { epoch: Some(epoch), ..Envelope::new(id, user, command) });
}

/// Stops a run. If the runner does not respond in time, its process is killed.
async fn stop(
    server: &ServerState,
    who: &Who,
    run: &Arc<Run>,
    envelope: Envelope,
) -> Result<Answer, Failure> {
    match timeout(STOP_TIMEOUT, until_answered(run, envelope)).await {
        // The runner has ended itself, because its engine did not stop.
        Ok(Err(failure)) if failure.code() == LINK_LOST && !run.is_live() => {
            return Ok(Answer::Applied);
        }
        Ok(answer) => return answer,
        // The process is on the robot. The local writer is the station.
        Err(_over) if run.is_replica() => return Err(robot_late()),
        Err(_over) => {}
    }
    let (folder, ended) = (run.folder().to_path_buf(), Arc::clone(run));
    let end = move || {
        let process = writer_of(&folder).ok().flatten().and_then(pid);
        process.is_some_and(|process| {
            ended.stop_by_force();
            kill_process(process, Signal::KILL).is_ok()
        })
    };
    if !tokio::task::spawn_blocking(end).await.unwrap_or_default() {
        return Err(late());
    }
    server.audit().note(&who.user, "kill", &format!("of {}: it did not take a stop", run.id()));
    Ok(Answer::Applied)
}

/// Resends a command while its link is lost and the run is live.
async fn until_answered(run: &Run, envelope: Envelope) -> Result<Answer, Failure> {
    loop {
        match send(run, envelope.clone()).await {
            Err(failure) if failure.code() == LINK_LOST && run.is_live() => {
                sleep(RETRY_INTERVAL).await;
            }
            answer => return answer,
        }
    }
}

fn pid(process: u32) -> Option<Pid> {
    Pid::from_raw(i32::try_from(process).ok()?)
}

async fn send(run: &Run, envelope: Envelope) -> Result<Answer, Failure> {
    let link = run.linked().await.ok_or_else(link_lost)?;
    let ends = matches!(envelope.command, Command::Kill);
    let sent = timeout(COMMAND_TIMEOUT, sent(run, &link, envelope));
    match sent.await {
        Ok(Ok(answer)) => Ok(answer),
        // A killed runner cannot reply.
        Ok(Err(failure)) if ends && failure.code() == LINK_LOST => Ok(Answer::Applied),
        Ok(Err(failure)) => Err(failure),
        Err(_over) => Err(late()),
    }
}

/// Sends a command. Urgent commands use a separate connection if others are pending.
async fn sent(run: &Run, link: &Link, envelope: Envelope) -> Result<Answer, Failure> {
    let is_urgent = envelope.command.is_for_everybody() || envelope.command == Command::Kill;
    if is_urgent && link.is_busy() {
        let answer = talk::command(run.folder().to_path_buf(), envelope).await;
        return answer.map_err(|error| not_spoken_with(&error));
    }
    let answered = link.send(&envelope).map_err(not_sent)?;
    answered.await.map_err(|_lost| link_lost())
}

fn not_sent(why: NotSent) -> Failure {
    match why {
        NotSent::Gone => link_lost(),
        NotSent::Busy => {
            let message =
                "too many commands are on their way to this run: wait until some are answered";
            Failure::too_many("too_many_commands", message)
        }
    }
}

/// The remote robot has not replied.
fn robot_late() -> Failure {
    let message = "the robot has not answered yet; the station repeats the request until it expires: send it again with its id";
    Failure::unavailable("no_answer", message)
}

const LINK_LOST: &str = "link_lost";

fn link_lost() -> Failure {
    let message = "the connection to the runner is down: send the request again with its id, it is carried out once at most";
    Failure::unavailable(LINK_LOST, message)
}

fn late() -> Failure {
    let message = format!(
        "the runner did not answer within {} s: send the request again with its id, it is carried out once at most",
        COMMAND_TIMEOUT.as_secs()
    );
    Failure::unavailable("no_answer", message)
}

fn not_spoken_with(error: &LinkError) -> Failure {
    let message = format!("{}: send the request again with its id", reason(error));
    Failure::unavailable(LINK_LOST, message)
}

/// The reply to a command from before the run ended. Without one, the command is too late.
async fn answered_before(
    server: &ServerState,
    run: &Run,
    id: String,
    known: String,
) -> Result<CommandAnswer, Failure> {
    let folder = run.folder().to_path_buf();
    let phase = run.summary().phase;
    let read = server
        .history
        .readers()
        .read(folder, move |reader| Ok(reader.moment(u64::MAX)?.whole().answer(&known).cloned()));
    // An unreadable journal leaves the fate unknown.
    let answer = read.await.ok().flatten();
    answer.map(|answer| CommandAnswer { id, answer }).ok_or_else(|| not_live(&phase))
}

/// Reason why a run cannot be commanded.
pub(super) fn not_live(phase: &RunPhase) -> Failure {
    let message = match phase {
        RunPhase::Crashed => "the runner of this run is dead: resume the run (POST …/resume)",
        _ => "the run has ended: see its history",
    };
    Failure::conflict("run_is_not_live", message)
}

/// Data of an active state of a run.
pub(crate) async fn inspect(
    server: &Arc<ServerState>,
    run: &str,
    path: &str,
) -> Result<StateData, Failure> {
    let run = server.runs.get(run).await?;
    if !run.is_live() {
        return Err(not_live(&run.summary().phase));
    }
    // Held until the connection is closed.
    let _permit = run.inspection_permit().ok_or_else(|| {
        let message =
            "too many requests for the data of this run's states: wait until some are answered";
        Failure::too_many("too_many_questions", message).retry_after(1)
    })?;
    let asked = timeout(COMMAND_TIMEOUT, talk::inspect(run.folder().to_path_buf(), path)).await;
    let data = asked.map_err(|_over| late())?.map_err(|error| not_spoken_with(&error))?;
    data.ok_or_else(|| {
        let message =
            format!("the state {path} is not active: the run's status lists those that are");
        Failure::not_found("not_active", message)
    })
}
