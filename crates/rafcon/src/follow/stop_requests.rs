//! Requests to stop, and the signals that only repeat one. Pure.
//!
//! Wrappers double signals: GNU `timeout` signals its child and then its own process group, and others forward signals of the
//! terminal. Only a deliberate Ctrl-C may cost a machine its recovery.

use std::time::Duration;

/// Signals repeat a Ctrl-C for this long.
pub(super) const REPETITION: Duration = Duration::from_secs(2);

/// A signal that asks this program to end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StopSignal {
    /// SIGINT, as Ctrl-C sends it.
    CtrlC,
    /// SIGTERM, as service managers send it.
    Terminate,
}

/// The requests of a user who follows a run.
#[derive(Debug, Default)]
pub(super) struct StopRequests {
    count: u32,
    /// Time of the last Ctrl-C that was no repetition.
    ctrl_c_at: Option<Duration>,
}

impl StopRequests {
    /// The number of the request; `None` if the signal repeats the one before.
    ///
    /// The first signal is a request. A Ctrl-C is another one if it arrives more than two seconds after the Ctrl-C before. SIGTERM
    /// never is.
    pub(super) fn add(&mut self, now: Duration, signal: StopSignal) -> Option<u32> {
        let is_ctrl_c = signal == StopSignal::CtrlC;
        let is_repeated = self.ctrl_c_at.is_none_or(|at| now.saturating_sub(at) <= REPETITION);
        let is_deliberate = is_ctrl_c && !is_repeated;
        if is_ctrl_c && (self.ctrl_c_at.is_none() || is_deliberate) {
            self.ctrl_c_at = Some(now);
        }
        if self.count > 0 && !is_deliberate {
            return None;
        }
        self.count += 1;
        Some(self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::{StopRequests, StopSignal};
    use expect_test::{Expect, expect};
    use std::time::Duration;

    /// Milliseconds with `c` for Ctrl-C or `t` for SIGTERM in, the numbers of requests out.
    fn check(script: &str, expect: &Expect) {
        let mut requests = StopRequests::default();
        let signals = script.split(' ').map(|word| {
            let (at_ms, kind) = word.split_at(word.len() - 1);
            let signal = if kind == "c" { StopSignal::CtrlC } else { StopSignal::Terminate };
            match requests.add(Duration::from_millis(at_ms.parse().unwrap()), signal) {
                Some(number) => format!("{word}={number}"),
                None => format!("{word} repeats"),
            }
        });
        expect.assert_eq(&signals.collect::<Vec<_>>().join(", "));
    }

    #[test]
    fn a_signal_that_comes_twice_is_one_request() {
        check("0c 5c", &expect!["0c=1, 5c repeats"]);
        check("0c 2000c", &expect!["0c=1, 2000c repeats"]);
        check("0t 5t", &expect!["0t=1, 5t repeats"]);
        check("0c 5t", &expect!["0c=1, 5t repeats"]);
        check("0t 5c 10c", &expect!["0t=1, 5c repeats, 10c repeats"]);
    }

    #[test]
    fn sigterm_is_one_request_for_ever() {
        check("0t 300t 90000t", &expect!["0t=1, 300t repeats, 90000t repeats"]);
        check("0c 90000t", &expect!["0c=1, 90000t repeats"]);
    }

    #[test]
    fn a_deliberate_ctrl_c_is_another_request() {
        check("0c 2001c 2006c 4002c", &expect!["0c=1, 2001c=2, 2006c repeats, 4002c=3"]);
        check("0c 1500c 3000c", &expect!["0c=1, 1500c repeats, 3000c=2"]);
    }

    #[test]
    fn after_sigterm_the_first_ctrl_c_repeats_it() {
        check("0t 5000c 5005c 7001c", &expect!["0t=1, 5000c repeats, 5005c repeats, 7001c=2"]);
    }
}
