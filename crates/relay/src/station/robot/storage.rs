//! The requests to one robot on the station's disk: each is durable before it is accepted, and removed once its fate is known.
//!
//! A stop and a pause are accepted at once and stored beside. So are the others if the disk fails or hangs. Knows no session.

use crate::station::command_disk::{CommandDisk, FromCommandDisk};
use crate::station::pending_requests::SendTimes;
use crate::station::stored_command::{AboutCommand, StoredCommand};
use crate::station::viewers::PendingRequest;
use crate::words::StationRequest;
use rafcon_link::{CommandId, SessionTime, StreamId, TimedCommand};
use rafcon_protocol::Command;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// A request waits this long for the disk.
const DISK_WITHIN: Duration = Duration::from_secs(1);

/// A request that the session can send.
#[derive(Debug, Clone)]
pub(super) struct PreparedRequest {
    pub(super) stream: StreamId,
    /// Id of the run, if the station shows it.
    pub(super) run: String,
    pub(super) given: PendingRequest,
    pub(super) command: TimedCommand,
    pub(super) times: SendTimes,
}

/// A request that waits for the disk.
struct Storing {
    request: PreparedRequest,
    since: SessionTime,
}

/// Requests that are being stored, and those that are stored.
pub(super) struct CommandStorage {
    disk: CommandDisk,
    /// Tag of the pairing in force.
    pairing: String,
    /// Requests that wait for the disk before they are accepted.
    storing: BTreeMap<CommandId, Storing>,
    /// Accepted requests that the disk was given.
    stored: BTreeSet<CommandId>,
    /// Accepted requests that are not durable, with their problems.
    unstored: BTreeMap<CommandId, Unstored>,
    /// Requests of earlier starts that were lost.
    lost: Vec<String>,
}

/// An accepted request that the disk does not take.
struct Unstored {
    about: String,
    /// Reason of the disk; `None` until it fails.
    why: Option<String>,
}

impl CommandStorage {
    /// The requests with these ids are on the disk; `lost` are the problems of others.
    pub(super) fn new(
        disk: CommandDisk,
        pairing: String,
        stored: impl IntoIterator<Item = CommandId>,
        lost: Vec<String>,
    ) -> Self {
        let (storing, unstored) = (BTreeMap::new(), BTreeMap::new());
        Self { disk, pairing, storing, stored: stored.into_iter().collect(), unstored, lost }
    }

    /// Sets the tag of the pairing in force.
    pub(super) fn set_pairing(&mut self, tag: String) {
        self.pairing = tag;
    }

    /// Reports a request of an earlier start that is lost.
    pub(super) fn note_lost(&mut self, problem: String) {
        self.lost.push(problem);
    }

    /// True while a request waits for the disk.
    pub(super) fn is_storing(&self, id: CommandId) -> bool {
        self.storing.contains_key(&id)
    }

    /// Number of requests that wait for the disk.
    pub(super) fn storing_count(&self) -> usize {
        self.storing.len()
    }

    /// Stores a request. Returns it if it is accepted at once.
    pub(super) fn store(
        &mut self,
        now: SessionTime,
        request: PreparedRequest,
    ) -> Option<PreparedRequest> {
        match durability(&request.given.word) {
            Durability::First => {
                self.disk.keep(self.stored(&request));
                self.storing.insert(request.command.id, Storing { request, since: now });
                return None;
            }
            Durability::Beside => self.store_beside(&request),
            Durability::Never => {}
        }
        Some(request)
    }

    /// Stores a request that is accepted already.
    pub(super) fn store_beside(&mut self, request: &PreparedRequest) {
        self.disk.keep(self.stored(request));
        self.note_unstored(request, None);
    }

    /// Applies an event of the disk. Returns the request that is accepted now.
    pub(super) fn on_disk_event(&mut self, event: FromCommandDisk) -> Option<PreparedRequest> {
        match event {
            FromCommandDisk::Kept(id) => {
                self.unstored.remove(&id);
                let Storing { request, .. } = self.storing.remove(&id)?;
                self.stored.insert(id);
                Some(request)
            }
            FromCommandDisk::NotKept(id, why) => {
                if let Some(unstored) = self.unstored.get_mut(&id) {
                    unstored.why = Some(why);
                    return None;
                }
                let Storing { request, .. } = self.storing.remove(&id)?;
                self.note_unstored(&request, Some(why));
                Some(request)
            }
        }
    }

    /// Requests that have waited too long for the disk: they are accepted now.
    pub(super) fn take_slow(&mut self, now: SessionTime) -> Vec<PreparedRequest> {
        let is_slow = |_: &CommandId, storing: &mut Storing| now >= storing.since + DISK_WITHIN;
        let slow: Vec<_> = self.storing.extract_if(.., is_slow).collect();
        let slow = slow.into_iter().map(|(_, storing)| storing.request);
        slow.inspect(|request| {
            self.note_unstored(request, Some("the disk does not answer".to_owned()));
        })
        .collect()
    }

    /// Notes that an accepted request is not durable yet.
    fn note_unstored(&mut self, request: &PreparedRequest, why: Option<String>) {
        let about = format!("{} ({})", request.given.word.asks(), request.given.id);
        self.stored.insert(request.command.id);
        self.unstored.insert(request.command.id, Unstored { about, why });
    }

    /// Removes the requests that are not open any more.
    pub(super) fn retain(&mut self, is_open: impl Fn(CommandId) -> bool) {
        let over: Vec<_> = self.stored.extract_if(.., |id| !is_open(*id)).collect();
        for id in over {
            self.unstored.remove(&id);
            self.disk.remove(id);
        }
    }

    /// Requests that a restart of the station would lose, and those that it has lost.
    pub(super) fn problems(&self) -> impl Iterator<Item = String> {
        let unstored = self.unstored.values().filter_map(|Unstored { about, why }| {
            let why = why.as_ref()?;
            Some(format!("{about} is sent, and a restart of the station would drop it: {why}"))
        });
        unstored.chain(self.lost.iter().cloned())
    }

    fn stored(&self, request: &PreparedRequest) -> StoredCommand {
        let PreparedRequest { run, given, command, times, .. } = request;
        let about = AboutCommand {
            id: given.id.clone(),
            pairing: self.pairing.clone(),
            run: run.clone(),
            epoch: command.epoch,
            sent_ms: times.sent,
            expires_ms: times.expiry,
            not_before_ms: given.not_before,
            transfer_ms: times.transfer,
            robot_start: command.times.start.0,
            robot_not_before_ms: command.times.not_before,
            robot_not_after_ms: command.times.not_after,
        };
        StoredCommand { about, body: command.body.clone() }
    }

    /// Does what waits for the disk, as far as it takes it.
    pub(super) fn end(&self) {
        self.disk.end();
    }
}

/// When a request has to be durable.
enum Durability {
    /// Before it is accepted.
    First,
    /// It waits for no disk.
    Beside,
    /// It is repeated by its sender.
    Never,
}

fn durability(word: &StationRequest) -> Durability {
    match word {
        StationRequest::Command(_, _, _, Command::Stop | Command::Pause) => Durability::Beside,
        StationRequest::Present(_) => Durability::Never,
        StationRequest::Command(..)
        | StationRequest::MoveControl(..)
        | StationRequest::Resume(..)
        | StationRequest::Start(..) => Durability::First,
    }
}

#[cfg(test)]
impl CommandStorage {
    pub(super) fn is_empty(&self) -> bool {
        self.storing.is_empty() && self.stored.is_empty()
    }

    /// Replaces the disk by one that hangs.
    pub(super) fn hang(&mut self) {
        self.disk = CommandDisk::stuck();
    }
}
