//! Requests to a robot to watch values of its runs: of as many runs at a time as it can. Knows nothing of viewers or values.

use crate::watch_words::RUNS_MAX;
use rafcon_link::{SessionTime, StreamId};
use rafcon_protocol::Watching;
use std::collections::BTreeMap;

/// A request for values of a run.
pub(super) struct Asked {
    pub(super) at: SessionTime,
    /// Anything is watched.
    pub(super) is_any: bool,
    pub(super) watching: Watching,
}

/// True if the robot can watch this run, too. A run that it was asked to forget counts until it has confirmed that.
pub(super) fn is_room(asked: &BTreeMap<StreamId, Asked>, stream: StreamId) -> bool {
    let is_watched = |(other, asked): &(&StreamId, &Asked)| {
        **other != stream && (asked.is_any || !asked.watching.is_confirmed)
    };
    asked.iter().filter(is_watched).count() < RUNS_MAX
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `asked`, then `watched` once that is confirmed; `withdrawn`, then `forgotten`.
    fn asked(state: &str) -> Asked {
        let is_confirmed = ["watched", "forgotten"].contains(&state);
        let is_any = ["asked", "watched"].contains(&state);
        let watching = Watching { is_confirmed, ..Watching::default() };
        Asked { at: SessionTime::BEGIN, is_any, watching }
    }

    #[test]
    fn a_further_run_is_asked_for_once_the_robot_has_forgotten_another() {
        let runs = u32::try_from(RUNS_MAX).expect("a small number");
        let mut all: BTreeMap<_, _> =
            (1..runs).map(|nth| (StreamId(nth), asked("watched"))).collect();
        assert!(is_room(&all, StreamId(runs)));
        all.insert(StreamId(runs), asked("asked"));
        assert!(!is_room(&all, StreamId(runs + 1)));
        // Requests of before may change.
        assert!(is_room(&all, StreamId(runs)) && is_room(&all, StreamId(1)));
        all.insert(StreamId(1), asked("withdrawn"));
        assert!(!is_room(&all, StreamId(runs + 1)));
        all.insert(StreamId(1), asked("forgotten"));
        assert!(is_room(&all, StreamId(runs + 1)));
    }
}
