//! The runs of one robot at its station: items on their way to the disk, replicas that are open to viewers, and their ends.

use super::name::RobotName;
use super::refused::RefusedRuns;
use crate::ids;
use crate::station::disk::{Disk, FromDisk, OpenRun, SettledRun, Work};
use crate::station::health::run_of;
use crate::station::in_order::InOrder;
use crate::station::kept_runs::{Restored, RestoredState};
use crate::station::parcels::RestoredParcel;
use crate::station::received::{Early, StationRun};
use crate::words::{ReportedRunState, RunFate};
use rafcon_link::{EventHash, RangeSet, StationSession, StreamId};
use rafcon_protocol::api::RobotAnswer;
use rafcon_protocol::{LinkHealth, LinkRun, OpenCommand, Snapshot, WatchedValue};
use rafcon_storage::journal::EventBlock;
use rafcon_supervisor::clock;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Capacity of the hashes that were compared. Beyond it, all are forgotten, and compared again.
const CHECKED_MAX: usize = 4_096;

/// The runs of one robot.
pub(in crate::station) struct StationRuns {
    name: RobotName,
    /// Name of this station at the robot.
    station: String,
    disk: Arc<Disk>,
    /// State of the link at the last scan, for runs that open.
    link: LinkHealth,
    /// The runs that are open to viewers.
    open: BTreeMap<StreamId, StationRun>,
    refused: RefusedRuns,
    /// Fault of the disk.
    problem: Option<String>,
    /// Last compared hashes, with the times of the robot's reports.
    checked: BTreeMap<StreamId, (u64, u64)>,
    in_order: InOrder,
    early: Early,
}

impl StationRuns {
    pub(super) fn new(name: RobotName, station: &str, disk: Arc<Disk>) -> Self {
        Self {
            name,
            station: station.to_owned(),
            disk,
            link: LinkHealth::default(),
            open: BTreeMap::new(),
            refused: RefusedRuns::default(),
            problem: None,
            checked: BTreeMap::new(),
            in_order: InOrder::default(),
            early: Early::default(),
        }
    }

    /// Restores the replicas on the disk.
    pub(super) fn restore(&mut self, session: &mut StationSession, restored: Vec<Restored>) {
        for Restored { events, last, taken, state } in restored {
            let streams = [(events, last), (ids::about_beside(events), taken)];
            match state {
                RestoredState::Open(open) => {
                    for (stream, last) in streams {
                        session.restore(stream, RangeSet::up_to(last));
                        self.in_order.restore(stream, last);
                    }
                    self.opened(session, events, open);
                }
                RestoredState::Left => {
                    for (stream, last) in streams {
                        session.settle(stream, last);
                    }
                }
                RestoredState::Whole => {
                    let whole = streams.into_iter();
                    whole.for_each(|(it, last)| session.restore_whole(it, last));
                }
                RestoredState::Refused(why) => self.refuse(session, events, &why),
            }
        }
    }

    /// Restores the parcels on the disk.
    pub(super) fn restore_parcels(
        &mut self,
        session: &mut StationSession,
        restored: Vec<RestoredParcel>,
    ) {
        for RestoredParcel { stream, parts, is_whole } in restored {
            self.in_order.restore(stream, parts);
            if is_whole {
                session.restore_whole(stream, parts);
            } else {
                session.restore(stream, RangeSet::up_to(parts));
            }
        }
    }

    /// Applies an event of the disk's thread about runs.
    pub(super) fn on_disk_event(&mut self, session: &mut StationSession, event: FromDisk) {
        match event {
            FromDisk::Opened(stream, open) => self.opened(session, stream, open),
            FromDisk::Safe(stream, safe) => {
                session.set_safe(stream, safe);
                if let Some(run) = self.open.get_mut(&stream) {
                    run.safe = safe;
                }
            }
            FromDisk::Closed(stream) => self.closed(stream),
            FromDisk::Settled(SettledRun { stream, events, parts }) => {
                let about = ids::about_beside(stream);
                if let Some(events) = events {
                    session.settle(stream, events);
                    self.in_order.forget(stream);
                }
                session.settle(about, parts);
                self.in_order.forget(about);
            }
            FromDisk::Refused(stream, why) => self.refuse(session, stream, &why),
            FromDisk::ParcelsGone(streams) => {
                for stream in streams {
                    self.in_order.forget(stream);
                    session.forget(stream);
                }
            }
            FromDisk::Problem(problem) => {
                if let Some(problem) = &problem {
                    self.name.tell(&format!("the disk does not store what it sends: {problem}"));
                }
                self.problem = problem;
            }
            FromDisk::KeyKept(_) => {}
        }
    }

    fn refuse(&mut self, session: &mut StationSession, events: StreamId, why: &str) {
        self.closed(events);
        for stream in [events, ids::about_beside(events)] {
            session.refuse(stream);
            self.in_order.forget(stream);
        }
        self.name.tell(why);
        self.refused.add(events, format!("robot {}: {why}", self.name.as_str()));
    }

    /// A run is not open to viewers any more.
    fn closed(&mut self, stream: StreamId) {
        self.open.remove(&stream);
        drop(self.early.take(stream));
    }

    fn opened(&mut self, session: &mut StationSession, stream: StreamId, open: OpenRun) {
        open.shared.set_link(self.link.clone());
        session.set_safe(stream, open.safe);
        let (reported, snapshot) = self.early.take(stream);
        if let Some(snapshot) = snapshot {
            open.shared.reported(snapshot);
        }
        self.open.insert(stream, StationRun::new(open));
        if let Some(reported) = reported {
            self.reported(session, stream, reported);
        }
    }

    /// The robot has started again: its reports are compared anew.
    pub(super) fn robot_started(&mut self) {
        self.checked.clear();
    }

    /// Events or parts: they are given to the disk in order.
    pub(super) fn take_items(
        &mut self,
        session: &mut StationSession,
        stream: StreamId,
        items: EventBlock,
    ) {
        if self.refused.has(run_of_stream(stream)) {
            return;
        }
        let safe = session.safe(stream);
        if let Some(lost) = self.in_order.add(stream, items, safe) {
            session.lose(stream, lost);
        }
        self.pass(stream);
    }

    fn pass(&mut self, stream: StreamId) {
        let (disk, is_part) = (&self.disk, stream.is_files() || ids::is_about(stream));
        self.in_order.pass(stream, |items| {
            let run = run_of_stream(stream);
            if is_part { disk.give_part(run, items) } else { disk.give_events(run, items) }
        });
    }

    /// Gives the disk the items that it did not take before.
    pub(super) fn pass_waiting(&mut self) {
        for stream in self.in_order.waiting() {
            self.pass(stream);
        }
    }

    pub(super) fn take_snapshot(
        &mut self,
        session: &StationSession,
        stream: StreamId,
        snapshot: Snapshot,
    ) {
        match self.open.get(&stream) {
            Some(run) => run.shared.reported(snapshot),
            None if is_awaited(session, stream) => self.early.snapshot(stream, snapshot),
            None => {}
        }
    }

    pub(super) fn take_watched(&self, stream: StreamId, values: Vec<WatchedValue>) {
        if let Some(run) = self.open.get(&stream) {
            run.shared.watched(values);
        }
    }

    /// The robot's events have this hash: the disk compares it with that of the replica.
    pub(super) fn check(&mut self, stream: StreamId, at_ms: u64, chain: EventHash) {
        let before = self.checked.get(&stream);
        let is_news = before.is_none_or(|(then_ms, last)| at_ms > *then_ms && chain.last != *last);
        if is_news && !self.refused.has(stream) {
            self.disk.give_task(stream, Work::Check(chain));
            if self.checked.len() >= CHECKED_MAX {
                self.checked.clear();
            }
            self.checked.insert(stream, (at_ms, chain.last));
        }
    }

    /// Applies the reported state of a run.
    pub(super) fn reported(
        &mut self,
        session: &StationSession,
        stream: StreamId,
        reported: ReportedRunState,
    ) {
        let head = session.progress(stream).map_or(0, |progress| progress.head);
        let is_waiting = !self.in_order.is_empty(stream);
        let Some(run) = self.open.get_mut(&stream) else {
            if is_awaited(session, stream) {
                self.early.reported(stream, reported);
            }
            return;
        };
        run.is_over |= matches!(reported.fate, RunFate::Finished | RunFate::Removed);
        if let Some(control) = reported.control(&self.station, clock::since_1970_ms()) {
            run.epoch = control.epoch;
            run.shared.set_control(control);
        }
        let is_here = run.safe >= head && !is_waiting && has_machines(session, stream);
        let has_ended = reported.fate == RunFate::Crashed && is_here
            || reported.fate == RunFate::Removed && !is_waiting;
        if has_ended && !run.is_closing {
            // Closed as its runner left it, the run is shown as what it is: crashed.
            let is_final = reported.fate == RunFate::Removed;
            run.is_closing = true;
            self.disk.give_task(stream, Work::Leave { is_final });
        }
    }

    /// Shows viewers the link and the commands of their run.
    pub(super) fn show_link(
        &mut self,
        session: &StationSession,
        link: &LinkHealth,
        commands: impl Fn(StreamId) -> Vec<OpenCommand>,
    ) {
        self.link = link.clone();
        for (stream, run) in &self.open {
            let missing = run_of(session, *stream, &run.id).missing;
            let commands = commands(*stream);
            run.shared.set_link(LinkHealth { missing, commands, ..link.clone() });
        }
    }

    /// Closes the runs that are over and on the disk.
    pub(super) fn close_complete(&mut self, session: &StationSession) {
        for (stream, run) in &mut self.open {
            let progress = session.progress(*stream);
            let head = progress.map_or(0, |progress| progress.head);
            // The last status may precede the opening of the run.
            run.is_over |= progress.is_some_and(|progress| progress.is_over);
            let is_complete = run.is_over && head > 0 && run.safe >= head;
            if is_complete && !run.is_closing && has_machines(session, *stream) {
                run.is_closing = true;
                self.disk.give_task(*stream, Work::Close);
            }
        }
    }

    /// Delivers an answer to the viewers of a run.
    pub(super) fn answer(&self, stream: StreamId, request: &str, answer: &RobotAnswer) {
        if let Some(run) = self.open.get(&stream) {
            run.shared.answer(request, &answer.to_command());
        }
    }

    pub(super) fn get(&self, stream: StreamId) -> Option<&StationRun> {
        self.open.get(&stream)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (&StreamId, &StationRun)> {
        self.open.iter()
    }

    /// State of each open run.
    pub(super) fn report(&self, session: &StationSession) -> Vec<LinkRun> {
        self.open.iter().map(|(stream, run)| run_of(session, *stream, &run.id)).collect()
    }

    /// Reasons why something is not stored.
    pub(super) fn problems(&self) -> impl Iterator<Item = String> {
        let problems = self.problem.clone().into_iter().chain(self.refused.problems());
        problems.map(|problem| format!("not everything is kept: {problem}"))
    }
}

/// The stream with the events of the run that a stream is of; that of a parcel is of no run.
fn run_of_stream(stream: StreamId) -> StreamId {
    if stream.is_files() { stream } else { ids::events_beside(stream) }
}

/// True if a run is to be opened. Only events open a settled one again.
fn is_awaited(session: &StationSession, stream: StreamId) -> bool {
    let is_open = session.progress(stream).is_some_and(|progress| !progress.is_settled);
    is_open && !stream.is_files() && !ids::is_about(stream)
}

/// True if the whole description of a run has arrived.
fn has_machines(session: &StationSession, events: StreamId) -> bool {
    let about = session.progress(ids::about_beside(events));
    about.is_some_and(|about| about.contiguous >= about.head)
}

#[cfg(test)]
impl StationRuns {
    pub(in crate::station) fn for_tests(disk: Arc<Disk>) -> Self {
        Self::new(RobotName::new("scout", |_| {}), "station", disk)
    }

    pub(super) fn insert(&mut self, stream: StreamId, run: StationRun) {
        self.open.insert(stream, run);
    }

    pub(super) fn remove(&mut self, stream: StreamId) {
        self.open.remove(&stream);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::station::robot::tests::stream;

    #[test]
    fn beyond_so_many_compared_hashes_all_are_forgotten_and_compared_again() {
        let mut runs = StationRuns::for_tests(Arc::new(Disk::without_thread()));
        let chain = EventHash { last: 4, hash: 0 };
        (0..CHECKED_MAX).for_each(|number| runs.check(stream(number), 1, chain));
        assert_eq!(runs.checked.len(), CHECKED_MAX);
        // A known hash is not compared again.
        runs.check(stream(0), 1, chain);
        assert_eq!(runs.checked.len(), CHECKED_MAX);
        runs.check(stream(CHECKED_MAX), 1, chain);
        assert_eq!(runs.checked.keys().copied().collect::<Vec<_>>(), [stream(CHECKED_MAX)]);
        runs.check(stream(0), 1, chain);
        assert_eq!(runs.checked.len(), 2);
    }
}
