//! Refused runs of one robot: nothing more of them is stored.

use rafcon_link::StreamId;
use std::collections::BTreeMap;

/// Capacity of the reasons of refused runs. Of more their number is reported.
const REFUSED_MAX: usize = 64;

/// Refused runs with their reasons.
#[derive(Debug, Default)]
pub(super) struct RefusedRuns {
    reasons: BTreeMap<StreamId, String>,
    /// Number of further refused runs.
    more: u64,
}

impl RefusedRuns {
    pub(super) fn add(&mut self, events: StreamId, reason: String) {
        if self.reasons.len() < REFUSED_MAX {
            self.reasons.insert(events, reason);
        } else {
            self.more += 1;
        }
    }

    pub(super) fn has(&self, events: StreamId) -> bool {
        self.reasons.contains_key(&events)
    }

    /// The reasons, and the number of further runs.
    pub(super) fn problems(&self) -> impl Iterator<Item = String> {
        let more = (self.more > 0).then(|| format!("{} more runs are refused", self.more));
        self.reasons.values().cloned().chain(more)
    }
}

#[cfg(test)]
mod tests {
    use super::{REFUSED_MAX, RefusedRuns};
    use crate::station::robot::tests::stream;

    #[test]
    fn of_many_refused_runs_the_first_are_named_and_the_others_counted() {
        let mut refused = RefusedRuns::default();
        let mut refuse = |number: usize| {
            refused.add(stream(number), format!("run-{number} is bad"));
            refused.problems().collect::<Vec<_>>()
        };
        let named: Vec<_> = (0..REFUSED_MAX).map(&mut refuse).collect();
        assert_eq!(named.last().map(Vec::len), Some(REFUSED_MAX));
        assert_eq!(refuse(REFUSED_MAX).last().unwrap(), "1 more runs are refused");
        let problems = refuse(REFUSED_MAX + 1);
        assert_eq!(problems.len(), REFUSED_MAX + 1);
        assert_eq!(problems.last().unwrap(), "2 more runs are refused");
        assert!(problems.contains(&"run-0 is bad".to_owned()), "{problems:?}");
        assert!([0, REFUSED_MAX - 1].iter().all(|number| refused.has(stream(*number))));
    }
}
