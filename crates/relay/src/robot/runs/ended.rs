//! The runs of a robot that are over: those that the station has, and those that are still to be sent.

use rafcon_protocol::LinkRun;
use std::collections::{BTreeSet, VecDeque};

/// Newest whole runs that are named at once after a start of the station.
const NAMED_AGAIN: usize = 16;
/// Capacity of the whole runs in reports.
const WHOLE_MAX: usize = 8;

/// Runs that are not sent now.
#[derive(Debug, Default)]
pub(in crate::robot) struct EndedRuns {
    /// Newest runs that are whole at the station.
    whole: VecDeque<LinkRun>,
    /// The runs that were over before the robot had this station: they are sent last, the newest first.
    older: Vec<String>,
    /// The runs that are known without being sent now.
    seen: BTreeSet<String>,
}

impl EndedRuns {
    /// Sets the runs that earlier starts did not send.
    pub(super) fn restore(&mut self, mut older: Vec<String>) {
        // The newest is taken first.
        older.sort();
        self.seen = older.iter().cloned().collect();
        self.older = older;
    }

    /// The newest of the older runs.
    pub(super) fn pop_older(&mut self) -> Option<String> {
        self.older.pop()
    }

    pub(super) fn has_older(&self) -> bool {
        !self.older.is_empty()
    }

    /// The station has started again: returns the newest known runs, which are named at once. The others are sent as older ones.
    pub(super) fn name_again(&mut self, is_sent: impl Fn(&str) -> bool) -> Vec<String> {
        self.whole.clear();
        let mut known: Vec<_> = self.seen.iter().cloned().collect();
        known.retain(|id| !is_sent(id) && !self.older.contains(id));
        let newest = known.split_off(known.len().saturating_sub(NAMED_AGAIN));
        self.older.extend(known);
        self.older.sort();
        newest
    }

    /// Lists a whole run in reports, in the place of the oldest if there are many.
    pub(super) fn add_whole(&mut self, run: LinkRun) {
        self.seen.insert(run.id.clone());
        self.whole.push_back(run);
        self.whole.drain(..self.whole.len().saturating_sub(WHOLE_MAX));
    }

    pub(super) fn whole(&self) -> impl Iterator<Item = &LinkRun> {
        self.whole.iter()
    }

    pub(super) fn add_seen(&mut self, id: &str) {
        self.seen.insert(id.to_owned());
    }

    pub(super) fn has_seen(&self, id: &str) -> bool {
        self.seen.contains(id)
    }

    pub(super) fn seen(&self) -> impl Iterator<Item = &String> {
        self.seen.iter()
    }

    /// Forgets the runs that are not in the folder any more.
    pub(super) fn retain(&mut self, is_there: impl Fn(&str) -> bool) {
        self.seen.retain(|id| is_there(id));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_whole_runs_are_listed_up_to_the_bound() {
        let mut ended = EndedRuns::default();
        for nth in 0..WHOLE_MAX + 3 {
            ended.add_whole(LinkRun { id: format!("run-{nth}"), head: 4, missing: 0 });
        }
        let listed: Vec<_> = ended.whole().map(|run| run.id.as_str()).collect();
        assert_eq!(listed.len(), WHOLE_MAX);
        assert_eq!((listed[0], listed[WHOLE_MAX - 1]), ("run-3", "run-10"));
    }

    #[test]
    fn after_a_start_of_the_station_the_newest_runs_are_named_and_the_others_are_older() {
        let mut ended = EndedRuns::default();
        let ids: Vec<_> = (10..10 + NAMED_AGAIN + 3).map(|nth| format!("run-{nth}")).collect();
        for id in &ids {
            ended.add_seen(id);
        }
        let newest = ended.name_again(|id| id == ids[1]);
        assert_eq!(newest, ids[3..]);
        let older = [ended.pop_older(), ended.pop_older(), ended.pop_older()];
        assert_eq!(older, [Some(ids[2].clone()), Some(ids[0].clone()), None]);
    }
}
