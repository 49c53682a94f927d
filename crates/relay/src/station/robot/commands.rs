//! The requests to one robot: those of viewers and of the station's server, with their fates.

use super::name::RobotName;
use super::runs::StationRuns;
use super::storage::{CommandStorage, PreparedRequest};
use crate::command_lists::CommandListStore;
use crate::ids;
use crate::meter::millis;
use crate::request_words;
use crate::requests::RequestBroker;
use crate::rights::PairingRights;
use crate::station::command_disk::FromCommandDisk;
use crate::station::lifetime::lifetime;
use crate::station::pending_requests::{PendingRequests, SendTimes, overdue};
use crate::station::stored_command::{AboutCommand, StoredCommand};
use crate::station::viewers::PendingRequest;
use crate::words::StationRequest;
use rafcon_link::{CommandId, CommandState, NewCommand, SessionTime, StationSession, StreamId};
use rafcon_protocol::api::{RobotAnswer, RobotRequest};
use rafcon_protocol::{CommandStage, ContactPlan, OpenCommand};
use rafcon_supervisor::clock;
use std::sync::Arc;
use std::time::Duration;

/// The parts of a robot that its commands use.
pub(super) struct CommandContext<'r> {
    pub(super) session: &'r mut StationSession,
    pub(super) runs: &'r StationRuns,
    /// Present time of the session.
    pub(super) now: SessionTime,
    /// Planned contacts.
    pub(super) plan: Arc<ContactPlan>,
    pub(super) rights: PairingRights,
    /// Regular datagrams of the robot arrive.
    pub(super) is_heard: bool,
}

/// Requests to one robot.
pub(super) struct StationCommands {
    pub(super) name: RobotName,
    pub(super) server_requests: RequestBroker,
    pub(super) lists: CommandListStore,
    pub(super) requests: PendingRequests,
    pub(super) storage: CommandStorage,
}

impl StationCommands {
    pub(super) fn new(
        name: RobotName,
        server_requests: RequestBroker,
        lists: CommandListStore,
        storage: CommandStorage,
    ) -> Self {
        Self { name, server_requests, lists, requests: PendingRequests::default(), storage }
    }

    /// Sends the requests of earlier starts again, with their times. Their fates are unknown until the robot reports them.
    pub(super) fn restore(&mut self, session: &mut StationSession, stored: Vec<StoredCommand>) {
        let now_ms = clock::since_1970_ms();
        for command in stored {
            let id = command.id();
            let (stream, word) = match request_words::read(id, &command.body) {
                Ok(read) => read,
                Err(why) => {
                    let name = &command.about.id;
                    self.storage.note_lost(format!("command {name} is not sent again: {why}"));
                    continue;
                }
            };
            if session.command_at(SessionTime::BEGIN, command.restored()).is_err() {
                continue;
            }
            let AboutCommand { id: name, sent_ms, expires_ms, not_before_ms, .. } = command.about;
            let soon = PendingRequest::soon(name, word);
            let given = PendingRequest { not_before: not_before_ms, ..soon };
            let (transfer, one_way) = (command.about.transfer_ms, None);
            let times = SendTimes { sent: sent_ms, transfer, one_way, expiry: expires_ms };
            self.requests.add(stream, &given, times);
            if expires_ms.is_some_and(|expires_ms| expires_ms <= now_ms) {
                self.requests.set_stage(id, CommandStage::Overdue);
            }
        }
    }

    /// Sends what a viewer has for the robot. What is on its way already is not sent twice, and what was answered is answered again.
    pub(super) fn command(
        &mut self,
        context: &mut CommandContext<'_>,
        stream: StreamId,
        given: &PendingRequest,
    ) {
        let id = ids::command(&given.id);
        if let Some(answer) = self.requests.known_answer(id) {
            return self.answer(context.runs, stream, &given.id, &answer);
        }
        if self.requests.is_open(id) || self.storage.is_storing(id) {
            return;
        }
        let others = self.storage.storing_count();
        let prepared = context.prepare(stream, given).and_then(|(command, times)| {
            let robot_times = context.session.times_for(context.now, &command, others);
            let command = command.at(robot_times.map_err(|why| why.to_string())?);
            let (run, given) = (context.run_of(stream), given.clone());
            Ok(PreparedRequest { stream, run, given, command, times })
        });
        match prepared {
            Ok(request) => {
                if let Some(request) = self.storage.store(context.now, request) {
                    self.accept(context, request);
                }
            }
            Err(reason) => {
                self.answer(context.runs, stream, &given.id, &RobotAnswer::Refused { reason });
            }
        }
    }

    /// Sends a request until its fate is known.
    fn accept(&mut self, context: &mut CommandContext<'_>, request: PreparedRequest) {
        let PreparedRequest { stream, given, command, times, .. } = request;
        match context.session.command_at(context.now, command) {
            Ok(()) => self.requests.add(stream, &given, times),
            Err(why) => {
                let reason = why.to_string();
                self.answer(context.runs, stream, &given.id, &RobotAnswer::Refused { reason });
            }
        }
    }

    /// Accepts a request once the disk has taken or refused it.
    pub(super) fn on_disk_event(
        &mut self,
        context: &mut CommandContext<'_>,
        event: FromCommandDisk,
    ) {
        if let Some(request) = self.storage.on_disk_event(event) {
            self.accept(context, request);
        }
    }

    /// Accepts the requests for which the disk was too slow, and removes those that are over from it.
    fn scan_storage(&mut self, context: &mut CommandContext<'_>) {
        for request in self.storage.take_slow(context.now) {
            self.accept(context, request);
        }
        self.storage.retain(|id| context.session.is_open(id));
    }

    /// Does what is due: reports overdue requests, and takes those of the server.
    pub(super) fn scan(&mut self, context: &mut CommandContext<'_>) {
        self.note_overdue(context);
        self.send_server_requests(context);
        self.answer_list_questions(context);
        self.note_round_trip(context.session);
        self.scan_storage(context);
    }

    /// Sends what the server asks for: these runs have no viewers here.
    fn send_server_requests(&mut self, context: &mut CommandContext<'_>) {
        for request in self.server_requests.take(self.name.as_str()) {
            let (stream, id, word) = match request {
                RobotRequest::Resume(it) => {
                    let (stream, id) = (ids::events_of(&it.run), it.asked.id.clone());
                    let (policy, from) = (it.asked.policy, it.asked.from);
                    (stream, id, StationRequest::Resume(it.asked.id, it.user, it.run, policy, from))
                }
                RobotRequest::Start(it) => {
                    // No run has an empty id.
                    let (stream, id) = (ids::events_of(""), it.id.clone());
                    (stream, id, StationRequest::Start(it.id, it.user, it.of))
                }
            };
            self.command(context, stream, &PendingRequest::soon(id, word));
        }
    }

    /// Applies the robot's report about a request.
    pub(super) fn reported(
        &mut self,
        runs: &StationRuns,
        id: CommandId,
        state: CommandState,
        reason: String,
    ) {
        let answer = match state {
            CommandState::Received => return self.requests.set_stage(id, CommandStage::Received),
            CommandState::Started => return self.requests.set_stage(id, CommandStage::Started),
            CommandState::Done => RobotAnswer::Done { run: reason },
            CommandState::Refused => RobotAnswer::Refused { reason },
            CommandState::Expired => RobotAnswer::Expired,
        };
        if let Some((stream, name)) = self.requests.close(id, &answer) {
            self.answer(runs, stream, &name, &answer);
        }
    }

    /// Reports the fates of requests whose time is over as unknown.
    fn note_overdue(&mut self, context: &mut CommandContext<'_>) {
        for id in context.session.take_overdue(context.now) {
            if self.requests.is_beginning_run(id) {
                continue;
            }
            self.requests.set_stage(id, CommandStage::Overdue);
            if let Some((stream, name)) = self.requests.find(id) {
                self.answer(context.runs, stream, name, &overdue());
            }
        }
    }

    /// Takes the measured round trip for the expected times of requests.
    fn note_round_trip(&mut self, session: &StationSession) {
        if let Some(round_trip) = session.round_trip() {
            self.requests.set_one_way(millis(round_trip) / 2);
        }
    }

    /// Open commands of this run, or of all, with their expected times.
    pub(super) fn open(
        &self,
        stream: Option<StreamId>,
        session: &StationSession,
        plan: &ContactPlan,
    ) -> Vec<OpenCommand> {
        self.requests.commands(stream, session, plan, clock::since_1970_ms())
    }

    fn answer(&self, runs: &StationRuns, stream: StreamId, name: &str, answer: &RobotAnswer) {
        runs.answer(stream, name, answer);
        self.server_requests.answer(self.name.as_str(), name, answer);
    }
}

impl CommandContext<'_> {
    /// Id of the open run with these events; empty without one.
    fn run_of(&self, stream: StreamId) -> String {
        self.runs.get(stream).map(|run| run.id.clone()).unwrap_or_default()
    }

    /// A request as the session sends it, with its times. The error is the reason for a refusal.
    pub(super) fn prepare(
        &self,
        stream: StreamId,
        given: &PendingRequest,
    ) -> Result<(NewCommand, SendTimes), String> {
        let today = clock::since_1970_ms();
        let known = self.runs.get(stream).map_or(0, |run| run.epoch);
        let wait = given.not_before.map(|ms| Duration::from_millis(ms.saturating_sub(today)));
        let body = request_words::write(stream, &given.word);
        let transfer = self.session.transfer_time(body.len());
        let usual = default_lifetime(self.session, self.now, body.len());
        let valid = lifetime(given, &self.plan, today, usual)?;
        let times = SendTimes {
            sent: today,
            transfer: millis(transfer),
            one_way: self.session.round_trip().map(|round_trip| millis(round_trip) / 2),
            expiry: (!given.is_lasting).then(|| today + millis(valid)),
        };
        let (id, epoch) = (ids::command(&given.id), given.epoch.unwrap_or(known));
        Ok((NewCommand { id, valid, wait, epoch, body }, times))
    }
}

/// Default lifetime of a request of `length` bytes.
pub(crate) fn default_lifetime(
    session: &StationSession,
    now: SessionTime,
    length: usize,
) -> Duration {
    // Twice: parts are lost and sent again.
    session.command_lifetime(now) + session.transfer_time(length) * 2
}
