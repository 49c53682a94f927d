//! The values that viewers watch, as the robot is asked for them. Knows neither commands nor large values.

use super::runs::StationRuns;
use crate::station::asked::{Asked, is_room};
use crate::watch_words;
use rafcon_link::{SessionTime, StationSession, StreamId};
use rafcon_protocol::{WatchTarget, Watching};
use rafcon_supervisor::clock;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

/// The end of a watch is sent this long: the robot may not know the run any more.
const WITHDRAW_FOR: Duration = Duration::from_mins(1);
/// The robot is asked for other values of a run at most this often.
const ASK_EVERY: Duration = Duration::from_secs(1);

/// Lists of watched values at the robot.
pub(super) struct RunWatches {
    asked: BTreeMap<StreamId, Asked>,
    /// Number of the last list.
    last_number: u64,
}

impl RunWatches {
    pub(super) fn new() -> Self {
        Self { asked: BTreeMap::new(), last_number: clock::since_1970_ms() }
    }

    /// Asks the robot for the values that viewers watch, and reports to them whether it knows their lists.
    pub(super) fn sync(
        &mut self,
        session: &mut StationSession,
        runs: &StationRuns,
        now: SessionTime,
    ) {
        self.ask(session, runs, now);
        for (stream, Asked { watching, .. }) in &mut self.asked {
            watching.is_confirmed = session.is_watch_confirmed(*stream).unwrap_or(false);
            if let Some(run) = runs.get(*stream) {
                run.shared.set_watching(watching);
            }
        }
        self.forget_closed(session, runs, now);
    }

    /// Asks the robot for what viewers watch now; not again at once, however often they change it.
    pub(super) fn ask(
        &mut self,
        session: &mut StationSession,
        runs: &StationRuns,
        now: SessionTime,
    ) {
        let is_due = |asked: Option<&Asked>| asked.is_none_or(|it| it.at + ASK_EVERY <= now);
        let open = runs.iter().filter(|(stream, _)| is_due(self.asked.get(stream)));
        let open: Vec<_> = open.map(|(stream, run)| (*stream, Arc::clone(&run.shared))).collect();
        // A closed run has no viewers.
        let closed = self
            .asked
            .iter()
            .filter(|(stream, asked)| asked.is_any && runs.get(**stream).is_none());
        let closed: Vec<_> = closed.map(|(stream, _)| *stream).collect();
        for stream in closed {
            self.send_list(session, now, stream, Vec::new());
        }
        for (stream, shared) in open {
            if !is_room(&self.asked, stream) {
                shared.leave_out();
            } else if let Some(targets) = shared.take_subscription() {
                self.send_list(session, now, stream, targets);
            }
        }
    }

    /// Sends the list of a run, as far as it fits.
    fn send_list(
        &mut self,
        session: &mut StationSession,
        now: SessionTime,
        stream: StreamId,
        mut targets: Vec<WatchTarget>,
    ) {
        self.last_number = clock::since_1970_ms().max(self.last_number + 1);
        let wanted = targets.len();
        while session.watch(stream, self.last_number, watch_words::write_targets(&targets)).is_err()
        {
            targets.truncate(targets.len() / 2);
        }
        let left_out = u32::try_from(wanted - targets.len()).unwrap_or(u32::MAX);
        let asked_ms = clock::since_1970_ms();
        let watching = Watching { is_confirmed: false, asked_ms, left_out };
        let asked = Asked { at: now, is_any: !targets.is_empty(), watching };
        self.asked.insert(stream, asked);
    }

    /// Drops the watches of closed runs once the robot knows that.
    fn forget_closed(
        &mut self,
        session: &mut StationSession,
        runs: &StationRuns,
        now: SessionTime,
    ) {
        self.asked.retain(|stream, asked| {
            let is_withdrawn = asked.watching.is_confirmed || asked.at + WITHDRAW_FOR <= now;
            let is_over = runs.get(*stream).is_none() && !asked.is_any && is_withdrawn;
            if is_over {
                session.end_watch(*stream);
            }
            !is_over
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::station::disk::{Disk, OpenRun};
    use crate::station::received::StationRun;
    use crate::station::robot::tests::{session, stream};
    use crate::station::viewers::Shared;
    use rafcon_protocol::{LinkHealth, WatchKind};
    use rafcon_storage::journal::About;

    fn asked(watches: &RunWatches) -> Vec<StreamId> {
        let asked = watches.asked.iter().filter(|(_, asked)| asked.is_any);
        asked.map(|(stream, _)| *stream).collect()
    }

    #[test]
    fn the_robot_is_asked_for_as_many_runs_as_it_can_watch_and_for_another_once_it_forgets_one() {
        let folder = tempfile::tempdir().unwrap();
        let mut session = session();
        let mut runs = StationRuns::for_tests(Arc::new(Disk::without_thread()));
        let target = WatchTarget {
            kind: WatchKind::State,
            path: "R".to_owned(),
            name: String::new(),
            priority: 0,
        };
        for number in 0..=watch_words::RUNS_MAX {
            let about = About::default();
            let shared = Shared::new(folder.path().to_owned(), &about, 0, LinkHealth::default());
            shared.watch(1, vec![target.clone()]);
            let open = OpenRun { id: String::new(), safe: 0, shared: Arc::new(shared) };
            runs.insert(stream(number), StationRun::new(open));
        }
        let (mut watches, now) = (RunWatches::new(), SessionTime::BEGIN);
        watches.ask(&mut session, &runs, now);
        let first = asked(&watches);
        assert_eq!(first.len(), watch_words::RUNS_MAX);
        let last = runs.iter().map(|(run, _)| *run).find(|run| !first.contains(run)).unwrap();
        // The run is closed, and the robot does not know it yet.
        runs.remove(first[0]);
        watches.ask(&mut session, &runs, now);
        assert_eq!(asked(&watches), first[1..]);
        watches.asked.get_mut(&first[0]).unwrap().watching.is_confirmed = true;
        watches.ask(&mut session, &runs, now);
        assert!(asked(&watches).contains(&last));
        assert_eq!(asked(&watches).len(), watch_words::RUNS_MAX);
    }
}
