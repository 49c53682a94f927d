//! Requests of a station: checked against the rights of the pairing, and given to runners and server.

use super::RobotRelay;
use crate::pairing::Pairing;
use crate::request_words;
use crate::words::{StationRequest, at_robot, author_at_robot};
use rafcon_link::{CommandState, ReceivedCommand, SessionTime, StreamId};
use rafcon_protocol::api::{
    ControlMove, ResumeRequest, ResumeRun, Right, RobotAnswer, StartRequest,
};
use rafcon_protocol::{Envelope, Expiry};
use rafcon_supervisor::clock;
use std::sync::Arc;

impl RobotRelay<'_> {
    /// Carries out the commands whose time has come.
    pub(super) fn carry_out_due(&mut self) {
        let now = self.clock.now();
        while let Some(command) = self.session.poll_command(now) {
            self.command(now, command);
        }
    }

    /// Gives commands again to runs that had only just begun.
    pub(super) fn give_early(&mut self) {
        let now = self.clock.now();
        for command in self.early.take(now.as_millis()) {
            self.command(now, command);
        }
    }

    /// Carries out the request of a station's user, if the user has the right.
    pub(super) fn command(&mut self, now: SessionTime, command: ReceivedCommand) {
        let read = request_words::read(command.id, &command.body);
        let mut command = command;
        let late_fate = match &read {
            _ if !self.make_ready(&read, command.is_late) => Some(None),
            Ok((stream, word)) if command.is_late => Some(outcome(self.late_fate(*stream, word))),
            _ => None,
        };
        if let Some(None) = late_fate {
            let id = command.id;
            match self.early.add(command) {
                // The robot reports no fate before it has one.
                None => {
                    return self.session.set_command_state(now, id, CommandState::Received, "");
                }
                Some(refused) => command = refused,
            }
        }
        let ReceivedCommand { id, not_after_ms, epoch, is_late, .. } = command;
        let done = match read {
            _ if is_late => {
                Ok(late_fate.flatten().unwrap_or((CommandState::Started, String::new())))
            }
            Ok((stream, word)) => {
                let left_ms = not_after_ms.saturating_sub(now.as_millis());
                let expiry_ms = clock::since_1970_ms().saturating_add(left_ms);
                let state = self.handle(stream, word, epoch, expiry_ms);
                state.map(|state| (state, String::new()))
            }
            Err(error) => Err(format!("the robot's server does not understand it: {error}")),
        };
        let (state, text) = done.unwrap_or_else(|reason| (CommandState::Refused, reason));
        self.session.set_command_state(now, id, state, &text);
    }

    /// Prepares to carry out a request; false if that, or its fate, needs another moment.
    fn make_ready(
        &mut self,
        read: &Result<(StreamId, StationRequest), String>,
        is_late: bool,
    ) -> bool {
        match read {
            Ok((stream, StationRequest::Command(..))) => is_late || self.runs.make_ready(*stream),
            Ok((_, StationRequest::Resume(..) | StationRequest::Start(..))) => {
                self.settings.authority.is_ready()
            }
            Ok((_, StationRequest::MoveControl(..) | StationRequest::Present(_))) | Err(_) => true,
        }
    }

    /// Fate of a late request, by the run's journal and the server: an earlier start of this server may have carried it out.
    fn late_fate(&self, stream: StreamId, word: &StationRequest) -> RobotAnswer {
        let Self { settings, .. } = self;
        let authority = &settings.authority;
        let at_robot = |author| author_at_robot(author, settings.paired.pairing.station_name());
        match word {
            StationRequest::Command(id, ..) => {
                self.runs.answer_of(stream, id).map_or(RobotAnswer::Expired, RobotAnswer::from)
            }
            StationRequest::Resume(id, author, run, ..) => {
                authority.fate_of_resume(run, &at_robot(author), id)
            }
            StationRequest::Start(id, author, _) => authority.fate_of_start(&at_robot(author), id),
            StationRequest::MoveControl(..) | StationRequest::Present(_) => RobotAnswer::Expired,
        }
    }

    fn handle(
        &mut self,
        stream: StreamId,
        request: StationRequest,
        epoch: u64,
        expiry_ms: u64,
    ) -> Result<CommandState, String> {
        let authority = Arc::clone(&self.settings.authority);
        let Pairing { rights, .. } = self.settings.paired.pairing;
        let station = self.settings.paired.pairing.station_name();
        let run = match &request {
            StationRequest::Resume(_, _, run, ..) => run.clone(),
            StationRequest::Start(..) => String::new(),
            _ => self.runs.name(stream).ok_or("the robot has no such run")?.to_owned(),
        };
        match request {
            StationRequest::Command(id, author, decided_on, command) => {
                rights.check(&command, authority.right_of(&command))?;
                let author = author_at_robot(&author, station);
                if !command.is_for_everybody() {
                    authority.command(&run, &author, &id, epoch)?;
                    // A user who takes control by this command decides the next one under the new epoch.
                    self.tell_control();
                }
                let (expiry, epoch) = (Some(Expiry(expiry_ms)), Some(epoch));
                let new = Envelope::new(id, author, command);
                let envelope = Envelope { decided_on, expiry, epoch, ..new };
                if self.runs.command(&run, envelope) {
                    return Ok(CommandState::Started);
                }
                Err("the run has no program on the robot that could be commanded".to_owned())
            }
            StationRequest::MoveControl(_, author, wanted) => {
                rights.check_right(Right::Command)?;
                let wanted = match wanted {
                    ControlMove::HandOver { to } => {
                        ControlMove::HandOver { to: at_robot(&to, station) }
                    }
                    other => other,
                };
                authority.move_control(&run, &author_at_robot(&author, station), &wanted)?;
                self.tell_control();
                Ok(CommandState::Done)
            }
            StationRequest::Resume(id, author, _, policy, from) => {
                rights.check_right(Right::Start)?;
                let user = author_at_robot(&author, station);
                let answered = self.runs.answerer(id.clone());
                let (asked, expiry_ms) = (ResumeRun { id, policy, from }, Some(expiry_ms));
                authority.resume(ResumeRequest { run, user, asked, expiry_ms }, answered)?;
                Ok(CommandState::Started)
            }
            StationRequest::Start(id, author, of) => {
                rights.check_right(Right::Start)?;
                let user = author_at_robot(&author, station);
                let answered = self.runs.answerer(id.clone());
                let (expiry_ms, no_edit) = (Some(expiry_ms), rights.check_right(Right::Edit).err());
                authority.start(StartRequest { id, user, of, expiry_ms, no_edit }, answered)?;
                Ok(CommandState::Started)
            }
            StationRequest::Present(user) => {
                authority.present(&author_at_robot(&user, station));
                Ok(CommandState::Done)
            }
        }
    }
}

/// State of a request with its text: the reason of a refusal, or the run that was started. None while the fate is unknown.
pub(super) fn outcome(answer: RobotAnswer) -> Option<(CommandState, String)> {
    match answer {
        RobotAnswer::Done { run } => Some((CommandState::Done, run)),
        RobotAnswer::Refused { reason } => Some((CommandState::Refused, reason)),
        RobotAnswer::Expired => Some((CommandState::Expired, String::new())),
        RobotAnswer::Unknown { .. } => None,
    }
}
