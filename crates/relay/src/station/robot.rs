//! One robot as a station knows it: routes datagrams, requests and events of the disk to the parts that own them.

mod commands;
mod keys;
mod link;
mod lists;
mod name;
mod refused;
mod runs;
mod storage;
mod watches;

use super::command_disk::{CommandDisk, FromCommandDisk};
use super::disk::{Disk, FromDisk};
use super::kept_runs::{KeptRuns, Place};
use super::parcels::StationParcels;
use super::received::Received;
use super::stored_command::{StoredCommand, StoredCommands};
use super::value_disk::FromValueDisk;
use super::values::StationValues;
use super::viewers::PendingRequest;
use super::{StationSettings, ToStation};
use crate::carrier::Carrier;
use crate::clock::SessionClock;
use crate::error::RelayError;
use crate::ids;
use crate::inbox::Input;
use crate::machine_lists::MACHINES_FOLDER;
use crate::meter::LinkMeter;
use crate::pairing::Paired;
use crate::start::Start;
#[cfg(test)]
pub(crate) use commands::default_lifetime;
use commands::{CommandContext, StationCommands};
use keys::PairingKeys;
use link::RobotLink;
use name::RobotName;
use rafcon_link::{SessionTime, StationSession, StreamId};
use rafcon_protocol::{LinkHealth, LinkReport};
use runs::StationRuns;
use std::fmt;
use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use storage::CommandStorage;
use watches::RunWatches;

/// Reported while runs wait for others.
const CROWDED: &str = "more runs are incomplete than the station receives at a time (2,048): the others come once some are complete";

pub(crate) struct StationRobot {
    clock: SessionClock,
    session: StationSession,
    link: RobotLink,
    disk: Arc<Disk>,
    keys: PairingKeys,
    runs: StationRuns,
    watches: RunWatches,
    values: StationValues,
    commands: StationCommands,
}

impl fmt::Debug for StationRobot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StationRobot").finish_non_exhaustive()
    }
}

impl StationRobot {
    pub(super) fn begin(
        settings: &StationSettings,
        number: usize,
        paired: &Paired,
        inbox: SyncSender<Input<ToStation>>,
        clock: SessionClock,
    ) -> Result<Self, RelayError> {
        let pairing = &paired.pairing;
        let name = RobotName::new(&pairing.robot, settings.tell);
        let folder = settings.folder.join(&pairing.robot);
        let start = Start::begin(&folder)?;
        let mut session = StationSession::new(&start.identity(pairing), settings.profile.clone());
        let values = StationValues::begin(settings, &pairing.robot, number, inbox.clone());
        let values = values.map_err(|source| RelayError::Thread { source })?;
        let (robot, runs) = (pairing.robot.clone(), settings.runs.clone());
        let machines = folder.join(MACHINES_FOLDER);
        let parcels = StationParcels::open(&machines)
            .map_err(|source| RelayError::Folder { path: machines, source })?;
        let place = Place {
            number,
            robot,
            runs,
            clock,
            inbox: inbox.clone(),
            paired: paired.clone(),
            machines: settings.machines.clone(),
        };
        let mut kept = KeptRuns::new(place, start, parcels);
        let (restored, parcels, whole) = (kept.restore(), kept.restored_parcels(), kept.whole());
        let disk = Disk::begin(kept).map_err(|source| RelayError::Thread { source })?;
        let disk = Arc::new(disk);
        let keys = PairingKeys::begin(paired, Arc::clone(&disk), &mut session);
        settings.server_requests.receive(&pairing.robot);
        settings.lists.receive(&pairing.robot, &folder);
        if let Some(problem) = settings.contacts.receive(&pairing.robot, &folder) {
            name.tell(&problem);
        }
        let meter = LinkMeter::new(pairing, &settings.profile, true);
        let mut link = RobotLink::new(
            name.clone(),
            clock,
            meter,
            settings.contacts.clone(),
            &settings.profile,
        );
        let mut runs = StationRuns::new(name.clone(), pairing.station_name(), Arc::clone(&disk));
        runs.show_link(&session, &link.health(&session), |_| Vec::new());
        for (events, last, parts) in whole {
            session.restore_whole(events, last);
            session.restore_whole(ids::about_beside(events), parts);
        }
        runs.restore(&mut session, restored);
        runs.restore_parcels(&mut session, parcels);
        let (server_requests, lists) = (settings.server_requests.clone(), settings.lists.clone());
        let stored_in = folder.join("commands");
        let (mut read, tags) = (StoredCommands::read(&stored_in), keys.tags());
        read.retain_paired(&stored_in, &tags);
        let StoredCommands { commands: stored, problems } = read;
        for problem in &problems {
            name.tell(problem);
        }
        let command_disk = CommandDisk::begin(stored_in, number, inbox)
            .map_err(|source| RelayError::Thread { source })?;
        let ids = stored.iter().map(StoredCommand::id);
        let tag = tags.into_iter().next().unwrap_or_default();
        let storage = CommandStorage::new(command_disk, tag, ids, problems);
        let mut commands = StationCommands::new(name, server_requests, lists, storage);
        commands.restore(&mut session, stored);
        let watches = RunWatches::new();
        Ok(Self { clock, session, link, disk, keys, runs, watches, values, commands })
    }

    /// Applies an event of the disk's thread.
    pub(super) fn on_disk_event(&mut self, event: FromDisk) {
        match event {
            FromDisk::KeyKept(new) => {
                self.commands.storage.set_pairing(new.tag());
                self.keys.kept(new, &mut self.session);
            }
            event => self.runs.on_disk_event(&mut self.session, event),
        }
    }

    /// Applies an event of the disk's thread for large values.
    pub(super) fn on_value_disk_event(&mut self, event: FromValueDisk) {
        self.values.on_disk_event(event, &mut self.session);
    }

    /// Applies an event of the disk's thread for requests.
    pub(super) fn on_command_disk_event(&mut self, event: FromCommandDisk) {
        self.with_commands(|commands, context| commands.on_disk_event(context, event));
    }

    /// Sends due datagrams. Returns the time of the next one.
    pub(super) fn send(&mut self) -> Result<Option<SessionTime>, RelayError> {
        self.link.send(&mut self.session)?;
        Ok(self.session.poll_timeout(self.clock.now()))
    }

    /// Applies a datagram. Returns false if it is of another robot.
    pub(super) fn receive(&mut self, from: &Carrier, datagram: &[u8]) -> bool {
        let received = self.link.receive(&mut self.session, from, datagram);
        let is_of_robot = received.is_some();
        received.into_iter().flatten().for_each(|received| self.take(received));
        is_of_robot
    }

    /// No robot has made the datagram that was received last.
    pub(super) fn note_unusable(&mut self) {
        self.link.note_unusable();
    }

    fn take(&mut self, received: Received) {
        let Self { session, runs, .. } = self;
        match received {
            Received::Events(stream, items) => runs.take_items(session, stream, items),
            Received::Stands(stream, reported, chain) => {
                if let Some((at_ms, chain)) = chain {
                    runs.check(stream, at_ms, chain);
                }
                runs.reported(session, stream, reported);
            }
            Received::Snapshot(stream, snapshot) => runs.take_snapshot(session, stream, *snapshot),
            Received::NewKey(key_id, key) => self.keys.offered(key_id, key),
            Received::State(id, state, reason) => self.commands.reported(runs, id, state, reason),
            Received::Watched(stream, values) => runs.take_watched(stream, values),
            Received::Part(id, offset, bytes) => self.values.take(id, offset, bytes, session),
            Received::NoValue(id, why) => self.values.refused(id, why, session),
            Received::Started => {
                runs.robot_started();
                // A station that starts again has to know the newest start of its robot.
                self.save();
            }
        }
    }

    /// Sends what a viewer has for the robot.
    pub(super) fn command(&mut self, stream: StreamId, given: &PendingRequest) {
        self.with_commands(|commands, context| commands.command(context, stream, given));
    }

    fn with_commands(&mut self, act: impl FnOnce(&mut StationCommands, &mut CommandContext<'_>)) {
        let mut context = CommandContext {
            is_heard: self.link.is_heard(&self.session),
            session: &mut self.session,
            runs: &self.runs,
            now: self.clock.now(),
            plan: self.link.contacts().plan,
            rights: self.keys.rights(),
        };
        act(&mut self.commands, &mut context);
    }

    /// Shows the state of the link and the fates of commands; closes complete runs.
    pub(super) fn scan(&mut self) {
        self.keys.confirm(&self.session);
        self.runs.pass_waiting();
        self.watches.sync(&mut self.session, &self.runs, self.clock.now());
        self.values.handle_requests(&mut self.session);
        let used_per_s = self.values.bytes_per_s(self.clock.now());
        let rate = self.link.value_rate(&self.session, used_per_s);
        self.values.sync(&self.session, rate);
        self.with_commands(StationCommands::scan);
        let (link, plan) = (self.link.health(&self.session), self.link.contacts().plan);
        let (session, commands) = (&self.session, &self.commands);
        self.runs.show_link(session, &link, |stream| commands.open(Some(stream), session, &plan));
        self.runs.close_complete(session);
    }

    /// State of the link.
    pub(super) fn report(&mut self) -> LinkReport {
        let plan = self.link.contacts().plan;
        let commands = self.commands.open(None, &self.session, &plan);
        let health = LinkHealth { commands, ..self.link.health(&self.session) };
        let report = self.link.report(health, &self.session, self.runs.report(&self.session));
        let crowded = self.session.is_crowded(self.clock.now()).then(|| CROWDED.to_owned());
        let problems = self.runs.problems().chain(self.commands.storage.problems());
        let problems = problems.chain(crowded).chain(report.problems).collect();
        LinkReport { problems, ..report }
    }

    /// Stores the state of the link for the next start.
    pub(super) fn save(&mut self) {
        self.disk.keep_heard(self.session.key_id(), self.session.horizon());
    }

    /// Writes what waits for the disk, as far as it takes it.
    pub(super) fn end(&mut self) {
        self.save();
        self.commands.storage.end();
        self.disk.end();
    }
}

#[cfg(test)]
pub(super) mod tests;
