//! The Gregorian calendar in UTC: dates in names, files and requests. Has no clock.

/// A date and a time of day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Date {
    /// Year, such as 2026.
    pub year: u64,
    /// Month, counted from 1.
    pub month: u64,
    /// Day of the month, counted from 1.
    pub day: u64,
    /// Hour, counted from 0.
    pub hour: u64,
    /// Minute, counted from 0.
    pub minute: u64,
    /// Second, counted from 0.
    pub second: u64,
}

impl Date {
    /// Returns the date this many seconds after 1970-01-01.
    pub fn since_1970(seconds: u64) -> Self {
        let (days, second) = (seconds / 86_400, seconds % 86_400);
        // Years begin on March 1, so that the leap day is the last day of a year.
        let days = days + 719_468;
        let (era, day) = (days / 146_097, days % 146_097);
        let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
        let day = day - (365 * year + year / 4 - year / 100);
        let month = (5 * day + 2) / 153;
        let day = day - (153 * month + 2) / 5 + 1;
        let (month, next_year) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
        let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
        Self { year: year + era * 400 + next_year, month, day, hour, minute, second }
    }

    /// Returns seconds since 1970-01-01. `None` if the date does not exist or is earlier.
    fn seconds(&self) -> Option<u64> {
        let Self { year, month, day, hour, minute, second } = *self;
        let is_time = hour < 24 && minute < 60 && second < 60;
        if year < 1970 || !(1..=12).contains(&month) || !(1..=31).contains(&day) || !is_time {
            return None;
        }
        let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
        let (era, year) = (year / 400, year % 400);
        let days = 365 * year + year / 4 - year / 100 + (153 * month + 2) / 5 + day - 1;
        let days = (era * 146_097 + days).checked_sub(719_468)?;
        let seconds = days * 86_400 + hour * 3_600 + minute * 60 + second;
        // A day that the month does not have yields another date.
        (Self::since_1970(seconds) == *self).then_some(seconds)
    }
}

/// Formats a time in ms since 1970 in ISO 8601: `2026-01-31T12:00:00Z`. Milliseconds are written only if they are not zero.
pub fn utc_text(ms: u64) -> String {
    let date = Date::since_1970(ms / 1000).to_string().replace(' ', "T");
    match ms % 1000 {
        0 => format!("{date}Z"),
        ms => format!("{date}.{ms:03}Z"),
    }
}

/// Parses a time as written by [`utc_text`], in ms since 1970. Seconds and their fraction are optional.
pub fn utc_ms(text: &str) -> Option<u64> {
    let (date, time) = text.strip_suffix('Z')?.split_once('T')?;
    let [year, month, day] = numbers(date, '-', [4, 2, 2])?;
    let (time, ms) = match time.split_once('.') {
        None => (time, 0),
        Some((time, fraction)) => (time, fraction_ms(fraction)?),
    };
    let [hour, minute, second] = match time.len() {
        5 => numbers(&format!("{time}:00"), ':', [2, 2, 2])?,
        _ => numbers(time, ':', [2, 2, 2])?,
    };
    let seconds = Date { year, month, day, hour, minute, second }.seconds()?;
    Some(seconds * 1000 + ms)
}

/// Parses three numbers with given numbers of digits.
fn numbers(text: &str, between: char, digits: [usize; 3]) -> Option<[u64; 3]> {
    let parts: Vec<&str> = text.split(between).collect();
    let is_number = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    let is_fit = |(part, digits): (&&str, usize)| part.len() == digits && is_number(part);
    if parts.len() != 3 || !parts.iter().zip(digits).all(is_fit) {
        return None;
    }
    let numbers: Option<Vec<u64>> = parts.iter().map(|part| part.parse().ok()).collect();
    numbers?.try_into().ok()
}

/// Parses one to three digits after the decimal point as ms.
fn fraction_ms(digits: &str) -> Option<u64> {
    let is_fit =
        (1..=3).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit());
    is_fit.then(|| format!("{digits:0<3}").parse().ok()).flatten()
}

/// Formats the date as in machine files: `2026-01-31 12:00:00`.
impl std::fmt::Display for Date {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { year, month, day, hour, minute, second } = self;
        write!(f, "{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02}")
    }
}

#[cfg(test)]
mod tests {
    use super::{Date, utc_ms, utc_text};
    use proptest::prelude::*;

    #[test]
    fn dates_know_leap_years() {
        let date = |seconds| Date::since_1970(seconds).to_string();
        assert_eq!(date(0), "1970-01-01 00:00:00");
        assert_eq!(date(951_782_399), "2000-02-28 23:59:59");
        assert_eq!(date(951_782_400), "2000-02-29 00:00:00");
        assert_eq!(date(1_772_323_200), "2026-03-01 00:00:00");
        assert_eq!(date(1_798_761_599), "2026-12-31 23:59:59");
    }

    #[test]
    fn a_time_is_read_in_one_form_only() {
        let read = |text| utc_ms(text).map(utc_text);
        for text in ["2026-11-28T14:00:00Z", "2024-02-29T23:59:59Z", "2026-11-28T14:00:00.250Z"] {
            assert_eq!(read(text).as_deref(), Some(text));
        }
        assert_eq!(read("2026-11-28T14:00Z").as_deref(), Some("2026-11-28T14:00:00Z"));
        assert_eq!(read("2026-11-28T14:00:00.5Z").as_deref(), Some("2026-11-28T14:00:00.500Z"));
        let bad = [
            "",
            "2026-11-28",
            "2026-11-28T14:00:00",
            "2026-11-28 14:00:00Z",
            "2026-11-28T14:00:00+01:00",
            "2026-02-29T00:00:00Z",
            "2026-13-01T00:00:00Z",
            "2026-00-01T00:00:00Z",
            "2026-11-00T00:00:00Z",
            "2026-11-28T24:00:00Z",
            "2026-11-28T14:00:60Z",
            "2026-11-28T14:00:00.Z",
            "2026-11-28T14:00:00.0001Z",
            "+026-11-28T14:00:00Z",
            "1969-12-31T23:59:59Z",
            "1970-01-01T00:00:00.é1Z",
        ];
        assert_eq!(bad.map(utc_ms), [None; 16]);
    }

    proptest! {
        #[test]
        fn every_time_is_read_as_it_is_written(ms in 0_u64..253_402_300_800_000) {
            prop_assert_eq!(utc_ms(&utc_text(ms)), Some(ms));
        }
    }
}
