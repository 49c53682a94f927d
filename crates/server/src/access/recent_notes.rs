//! Limits repeated notes: a few a minute are recorded, the rest is counted. Pure: time is an argument.

use std::collections::BTreeMap;

/// Duration of a counting period.
const MINUTE_MS: u64 = 60_000;
/// Maximum recorded notes per period.
const NOTES_MAX: u32 = 10;
/// Maximum number of distinct names.
const MAX: usize = 10_000;
/// Common name for all names beyond that number.
const OTHERS: &str = "others";

/// Counts of recent notes.
#[derive(Debug, Default)]
pub(super) struct RecentNotes {
    minutes: BTreeMap<String, Minute>,
    /// Second of the last cleanup.
    tidied_s: u64,
}

#[derive(Debug, Default)]
struct Minute {
    since_ms: u64,
    noted: u32,
    /// Number of notes suppressed since the last recorded one.
    untold: u64,
}

impl RecentNotes {
    /// `Some` if the note may be recorded, with the number suppressed since the last one.
    pub(super) fn may(&mut self, what: &str, now_ms: u64) -> Option<u64> {
        let what = self.known(what, now_ms);
        let minute = self.minutes.entry(what).or_default();
        // A clock that was set back starts a new period.
        if now_ms.checked_sub(minute.since_ms).is_none_or(|age| age >= MINUTE_MS) {
            (minute.since_ms, minute.noted) = (now_ms, 0);
        }
        if minute.noted >= NOTES_MAX {
            minute.untold += 1;
            return None;
        }
        minute.noted += 1;
        Some(std::mem::take(&mut minute.untold))
    }

    /// The name under which a note counts. The number of names is limited.
    fn known(&mut self, what: &str, now_ms: u64) -> String {
        let now_s = now_ms / 1000;
        if self.minutes.len() >= MAX && now_s != self.tidied_s {
            self.tidied_s = now_s;
            self.minutes.retain(|_, minute| minute.since_ms + MINUTE_MS > now_ms);
        }
        let is_known = self.minutes.len() < MAX || self.minutes.contains_key(what);
        if is_known { what } else { OTHERS }.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::{MAX, MINUTE_MS, RecentNotes};

    #[test]
    fn ten_a_minute_are_told_and_the_others_counted() {
        let mut recent_notes = RecentNotes::default();
        let told = (0..100).filter(|now_ms| recent_notes.may("refused anna", *now_ms) == Some(0));
        assert_eq!(told.count(), 10);
        assert_eq!(recent_notes.may("refused ben", 100), Some(0));
        assert_eq!(recent_notes.may("refused anna", MINUTE_MS), Some(90));
        assert_eq!(recent_notes.may("refused anna", MINUTE_MS), Some(0));
    }

    #[test]
    fn whatever_strangers_are_called_it_is_bounded() {
        let mut recent_notes = RecentNotes::default();
        let told = (0..3 * MAX).filter(|name| recent_notes.may(&name.to_string(), 7).is_some());
        assert_eq!(told.count(), MAX + 10);
        assert_eq!(recent_notes.minutes.len(), MAX + 1);
        assert_eq!(recent_notes.may("anna", 7 + MINUTE_MS), Some(0));
    }
}
