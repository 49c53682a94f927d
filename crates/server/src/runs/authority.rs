//! Control of runs by the users of a remote station, who use neither HTTP nor the WebSocket.

use super::commands::{move_holder, refused, take};
use super::control::GivenCommand;
use super::folder_files::RunRequest;
use super::resume::{EXPIRED, once};
use super::run::Run;
use super::start;
use super::start_requests::StartProgress;
use crate::access::of_command;
use crate::{Failure, ServerState};
use rafcon_protocol::Command;
use rafcon_protocol::api::{
    Control, ControlMove, ResumeRequest, Right, RobotAnswer, RunPhase, RunSummary, StartRequest,
};
use std::path::Path;
use std::sync::Arc;
use tokio::runtime::Handle;

/// Callback for the result of a request.
type Answered = Box<dyn FnOnce(RobotAnswer) + Send>;

/// Decides who may command the runs of a server, on any thread. The station vouches for the rights of its users.
#[derive(Debug, Clone)]
pub struct RunAuthority {
    server: Arc<ServerState>,
    runtime: Handle,
}

impl RunAuthority {
    /// The authority over the runs of this server. Call it within the server's runtime.
    pub fn new(server: &Arc<ServerState>) -> Self {
        Self { server: Arc::clone(server), runtime: Handle::current() }
    }

    /// Checks that a user who decided under this epoch of authority may command this run. The first such user takes control. `Err`
    /// contains the reason and a remedy.
    pub fn command(&self, run: &str, user: &str, id: &str, epoch: u64) -> Result<(), String> {
        let (_within, run) = (self.runtime.enter(), self.run(run)?);
        let given = GivenCommand { user, id, epoch: Some(epoch) };
        take(&self.server, &run, given).map_err(|failure| failure.to_string())
    }

    /// The run refused the command with this id. If its author took control by it, control is released.
    pub fn refused(&self, run: &str, id: &str) {
        let _within = self.runtime.enter();
        if let Ok(run) = self.run(run) {
            refused(&self.server, &run, id);
        }
    }

    /// The right that a command requires.
    pub fn right_of(command: &Command) -> Right {
        of_command(command)
    }

    /// Changes control of a run for a user. `Err` contains the reason.
    pub fn move_control(&self, run: &str, user: &str, wanted: &ControlMove) -> Result<(), String> {
        let (_within, run) = (self.runtime.enter(), self.run(run)?);
        if let ControlMove::HandOver { to } = wanted
            && !to.contains('@')
            && !self.server.people().users().may(to, Right::Command)
        {
            return Err(format!("{to} is nobody who may command runs on the robot"));
        }
        move_holder(&self.server, &run, user, wanted).map_err(|failure| failure.to_string())
    }

    /// True once the runs in the folder are known.
    pub fn is_ready(&self) -> bool {
        self.server.runs.are_known()
    }

    /// Starts to resume a crashed run, once for each id of a user. `answered` receives the result: `Expired` if nothing was done by the
    /// end of its validity.
    pub fn resume(&self, request: ResumeRequest, answered: Answered) -> Result<(), String> {
        let run = self.run(&request.run)?;
        if let Some(robot) = run.robot() {
            return Err(format!("it is a replica here, too: robot {robot} has the run"));
        }
        let server = Arc::clone(&self.server);
        self.carry_out(async move { once(&server, &run, &request).await }, answered);
        Ok(())
    }

    /// Fate of a request to resume a run.
    pub fn fate_of_resume(&self, run: &str, user: &str, id: &str) -> RobotAnswer {
        let Ok(found) = self.run(run) else { return RobotAnswer::Expired };
        let was_resumed = RunRequest::read(found.folder())
            .map_or(Some(false), |request| request.was_resumed(user, id, found.is_live()));
        match was_resumed {
            Some(true) => RobotAnswer::Done { run: run.to_owned() },
            Some(false) => RobotAnswer::Expired,
            None => unknown("the server may have died before the program ran, or after"),
        }
    }

    /// Starts a new run, once for each id of a user. `answered` receives the result: `Expired` if nothing was done by the end of its
    /// validity.
    pub fn start(&self, request: StartRequest, answered: Answered) -> Result<(), String> {
        let server = Arc::clone(&self.server);
        self.carry_out(async move { start::for_station(&server, request).await }, answered);
        Ok(())
    }

    /// Fate of a request to start a run.
    pub fn fate_of_start(&self, user: &str, id: &str) -> RobotAnswer {
        match self.server.runs.requests.progress(&RunRequest::start_key(user, id)) {
            StartProgress::Nothing => RobotAnswer::Expired,
            StartProgress::UnderWay => unknown("it is under way"),
            StartProgress::Begun(run) => RobotAnswer::Done { run },
            StartProgress::Open(folder) => self.fate_in(&folder),
        }
    }

    /// Fate of a start that an earlier server recorded in a folder.
    fn fate_in(&self, folder: &Path) -> RobotAnswer {
        let id = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match self.server.runs.known(&id).map(|run| run.summary().phase) {
            Some(RunPhase::Live | RunPhase::Finished { .. } | RunPhase::Crashed) => {
                RobotAnswer::Done { run: id }
            }
            Some(RunPhase::NotStarted { .. }) => RobotAnswer::Expired,
            _ => unknown("its run may begin"),
        }
    }

    fn carry_out(
        &self,
        request: impl Future<Output = Result<RunSummary, Failure>> + Send + 'static,
        answered: Answered,
    ) {
        self.runtime.spawn(async move {
            let answer = match request.await {
                Ok(run) => RobotAnswer::Done { run: run.id },
                Err(failure) if failure.code() == EXPIRED => RobotAnswer::Expired,
                Err(failure) => RobotAnswer::Refused { reason: failure.to_string() },
            };
            // Runs on a blocking thread, because the relay's queue may be full for a moment.
            let told = tokio::task::spawn_blocking(move || answered(answer));
            told.await.unwrap_or_default();
        });
    }

    /// The user is active, so they are not silent as the holder of control.
    pub fn present(&self, user: &str) {
        self.server.heard(user);
    }

    /// State of control of a run. `None` if the run is unknown.
    pub fn control(&self, run: &str) -> Option<Control> {
        Some(self.server.runs.known(run)?.control())
    }

    fn run(&self, id: &str) -> Result<Arc<Run>, String> {
        self.server.runs.known(id).ok_or_else(|| "the robot's server has no such run".to_owned())
    }
}

fn unknown(reason: &str) -> RobotAnswer {
    RobotAnswer::Unknown { reason: reason.to_owned() }
}
