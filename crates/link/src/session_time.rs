//! Times of a session, measured from its begin. Spans between them are `Duration`s.

use std::fmt;
use std::ops::{Add, AddAssign, Sub};
use std::time::Duration;

/// A time of a session, by a clock that begins with it and never goes back. Sums and differences saturate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct SessionTime(Duration);

impl SessionTime {
    /// The begin of the session. Anything due since then is due at once.
    pub const BEGIN: Self = Self(Duration::ZERO);

    /// The time that is this long after the begin.
    pub const fn after(span: Duration) -> Self {
        Self(span)
    }

    /// The time that is this many milliseconds after the begin, as in datagrams.
    pub const fn from_millis(ms: u64) -> Self {
        Self(Duration::from_millis(ms))
    }

    /// Whole milliseconds since the begin.
    pub fn as_millis(self) -> u64 {
        millis(self.0)
    }

    /// The span since an earlier time; zero since a later one.
    pub fn since(self, earlier: Self) -> Duration {
        self.0.saturating_sub(earlier.0)
    }

    /// The earliest of several due times, each `None` if it never comes.
    pub fn earliest(times: impl IntoIterator<Item = Option<Self>>) -> Option<Self> {
        times.into_iter().flatten().min()
    }

    /// This time, or the earliest of these if that is earlier.
    #[must_use]
    pub fn or_earlier(self, times: impl IntoIterator<Item = Option<Self>>) -> Self {
        Self::earliest(times).map_or(self, |at| at.min(self))
    }
}

impl Add<Duration> for SessionTime {
    type Output = Self;

    fn add(self, span: Duration) -> Self {
        Self(self.0.saturating_add(span))
    }
}

impl AddAssign<Duration> for SessionTime {
    fn add_assign(&mut self, span: Duration) {
        *self = *self + span;
    }
}

impl Sub<Duration> for SessionTime {
    type Output = Self;

    fn sub(self, span: Duration) -> Self {
        Self(self.0.saturating_sub(span))
    }
}

impl fmt::Display for SessionTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.0)
    }
}

/// Whole milliseconds of a span.
pub(crate) fn millis(span: Duration) -> u64 {
    u64::try_from(span.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::SessionTime;
    use std::time::Duration;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn sums_and_differences_saturate() {
        let (begin, later) = (SessionTime::BEGIN, SessionTime::from_millis(1_500));
        assert_eq!(later - SECOND, SessionTime::from_millis(500));
        assert_eq!(later - SECOND * 2, begin);
        assert_eq!([later.since(begin), begin.since(later)], [SECOND * 3 / 2, Duration::ZERO]);
        let last = SessionTime::after(Duration::MAX);
        assert_eq!((last + SECOND, last.as_millis()), (last, u64::MAX));
        assert_eq!(later.to_string(), "1.5s");
    }

    #[test]
    fn the_earliest_time_ignores_those_that_never_come() {
        let [early, late] = [1, 2].map(|ms| Some(SessionTime::from_millis(ms)));
        assert_eq!(SessionTime::earliest([None, late, early]), early);
        assert_eq!(SessionTime::earliest([None, None]), None);
        let between = SessionTime::after(Duration::from_micros(1_500));
        assert_eq!(Some(between.or_earlier([None, late, early])), early);
        assert_eq!([[None], [late]].map(|other| between.or_earlier(other)), [between; 2]);
    }
}
