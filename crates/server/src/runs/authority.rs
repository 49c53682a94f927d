//! Control of runs for those who come neither over HTTP nor over a socket: the users of a station far away.

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

/// Takes the answer to a request.
type Answered = Box<dyn FnOnce(RobotAnswer) + Send>;

/// Decides who commands the runs of a server, on any thread. The station vouches for what its users may do.
#[derive(Debug, Clone)]
pub struct RunAuthority {
    server: Arc<ServerState>,
    runtime: Handle,
}

impl RunAuthority {
    /// The authority over the runs of this server. To be called within its runtime.
    pub fn new(server: &Arc<ServerState>) -> Self {
        Self { server: Arc::clone(server), runtime: Handle::current() }
    }

    /// Whether a user may command this run now, having decided under this epoch of authority: the first who does takes control. Else
    /// why not, and the way out.
    pub fn command(&self, run: &str, user: &str, id: &str, epoch: u64) -> Result<(), String> {
        let (_within, run) = (self.runtime.enter(), self.run(run)?);
        let given = GivenCommand { user, id, epoch: Some(epoch) };
        take(&self.server, &run, given).map_err(|failure| failure.to_string())
    }

    /// The run refused the command with this id: if its author took control by it, nobody has it.
    pub fn refused(&self, run: &str, id: &str) {
        let _within = self.runtime.enter();
        if let Ok(run) = self.run(run) {
            refused(&self.server, &run, id);
        }
    }

    /// Right that a command needs.
    pub fn right_of(command: &Command) -> Right {
        of_command(command)
    }

    /// Moves control of a run as a user wants, or says why not.
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

    /// Begins to resume a run whose runner died, once for each id of a user. `answered` is called with the result: `Expired` if nothing
    /// was done by the end of its validity.
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

    /// Begins to start a run, once for each id of a user. `answered` is called with the result: `Expired` if nothing was done by the
    /// end of its validity.
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

    /// Fate of a start that an earlier server wrote into a folder.
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
            // The relay's queue may be full for a moment.
            let told = tokio::task::spawn_blocking(move || answered(answer));
            told.await.unwrap_or_default();
        });
    }

    /// A user is there: who holds control is not silent.
    pub fn present(&self, user: &str) {
        self.server.heard(user);
    }

    /// Who holds control of a run; none if the run is not known.
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
