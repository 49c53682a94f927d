//! The one place of this program that reads a clock; everybody else gets the time as an argument. Dates are as programs and
//! machines write them.

use rafcon_supervisor::clock::since_1970_ms;
use std::time::{Duration, Instant};

/// Time since the program began.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Clock(Instant);

impl Clock {
    /// A clock at zero.
    pub(crate) fn start() -> Self {
        #[expect(clippy::disallowed_methods, reason = "this is the program's one clock")]
        Self(Instant::now())
    }

    /// How long it has been running.
    pub(crate) fn now(self) -> Duration {
        self.0.elapsed()
    }
}

/// The date and time in UTC, as machines keep it: `2026-01-31 12:00:00`.
pub(crate) fn utc() -> String {
    date(since_1970_ms() / 1000)
}

/// A time in ms since 1970 as programs read it: `2026-01-31T12:00:00.000Z`.
pub(crate) fn utc_at(ms: u64) -> String {
    format!("{}.{:03}Z", date(ms / 1000).replace(' ', "T"), ms % 1000)
}

/// Seconds since 1970 as a date of the Gregorian calendar.
fn date(seconds: u64) -> String {
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // Years are counted from the first of March, so that the leap day is the last day of its year.
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted / 146_097, shifted % 146_097);
    let year = (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year + year / 4 - year / 100);
    let march_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * march_month + 2) / 5 + 1;
    let month = if march_month < 10 { march_month + 3 } else { march_month - 9 };
    let year = year + era * 400 + u64::from(month <= 2);
    let (hour, minute, second) = (second / 3_600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02}")
}

#[cfg(test)]
mod tests {
    use super::date;

    #[test]
    fn dates_know_leap_years() {
        assert_eq!(date(0), "1970-01-01 00:00:00");
        assert_eq!(date(951_782_399), "2000-02-28 23:59:59");
        assert_eq!(date(951_782_400), "2000-02-29 00:00:00");
        assert_eq!(date(1_772_323_200), "2026-03-01 00:00:00");
        assert_eq!(date(1_798_761_599), "2026-12-31 23:59:59");
    }
}
