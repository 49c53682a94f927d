//! What Ctrl-C and the time mean to a run that is followed: to a guest, who may leave, and to whoever asked for it. Pure.

use rafcon_protocol::Command;
use std::time::Duration;

/// How long a machine may take to stop after its time is over, before it is killed.
const GRACE: Duration = Duration::from_secs(3);

/// What is to be done.
#[derive(Debug, PartialEq)]
pub(in crate::commands) enum MannersStep {
    /// Leave; the run goes on.
    Leave,
    /// Tell the user this, and the run that.
    Say(&'static str, Command),
}

/// How a visitor behaves.
#[derive(Debug, Default)]
pub(in crate::commands) struct AttachOptions {
    /// The run was begun for this visitor, and ends when the visitor says so.
    is_host: bool,
    /// When the machine is stopped because its time is over.
    deadline: Option<Duration>,
    /// When patience with a machine ends that does not stop.
    kill_at: Option<Duration>,
    timed_out: bool,
    interrupts: u32,
    killed: bool,
}

impl AttachOptions {
    /// Somebody who looks in.
    pub(in crate::commands) fn of_a_guest() -> Self {
        Self::default()
    }

    /// Whoever asked for the run; it is stopped at `deadline`.
    pub(in crate::commands) fn of_the_host(deadline: Option<Duration>) -> Self {
        Self { is_host: true, deadline, ..Self::default() }
    }

    /// Whether the run was begun for this visitor.
    pub(super) fn is_host(&self) -> bool {
        self.is_host
    }

    /// Whether the machine's time is over.
    pub(super) fn timed_out(&self) -> bool {
        self.timed_out
    }

    /// Whether the runner was to be killed.
    pub(super) fn killed(&self) -> bool {
        self.killed
    }

    /// When there is something to do without a cause.
    pub(super) fn wake_at(&self) -> Option<Duration> {
        [self.deadline, self.kill_at].into_iter().flatten().min()
    }

    /// Ctrl-C.
    pub(super) fn interrupt(&mut self) -> MannersStep {
        self.interrupts += 1;
        match self.interrupts {
            _ if !self.is_host => MannersStep::Leave,
            1 => MannersStep::Say("stopping; press Ctrl-C again to kill", Command::Stop),
            2 => self.kill("killing; press Ctrl-C again to leave it alone"),
            _ => MannersStep::Leave,
        }
    }

    /// What the time alone brings about.
    pub(super) fn watch(&mut self, now: Duration) -> Option<MannersStep> {
        if self.kill_at.is_some_and(|at| now >= at) {
            return Some(self.kill("it did not stop; killing"));
        }
        if self.deadline.is_some_and(|at| now >= at) {
            self.deadline = None;
            self.timed_out = true;
            self.kill_at = Some(now + GRACE);
            return Some(MannersStep::Say("the time is over; stopping", Command::Stop));
        }
        None
    }

    fn kill(&mut self, text: &'static str) -> MannersStep {
        self.kill_at = None;
        self.killed = true;
        MannersStep::Say(text, Command::Kill)
    }
}

#[cfg(test)]
mod tests {
    use super::AttachOptions;
    use expect_test::{Expect, expect};
    use std::time::Duration;

    /// `c` is Ctrl-C, a number lets so many seconds pass.
    fn check(mut manners: AttachOptions, script: &str, expect: &Expect) {
        let (mut now, mut text) = (Duration::ZERO, String::new());
        for word in script.split(' ') {
            let step = if word == "c" {
                Some(manners.interrupt())
            } else {
                now += Duration::from_secs(word.parse().unwrap());
                manners.watch(now)
            };
            text.extend([word, ": ", &format!("{step:?}"), "\n"]);
        }
        expect.assert_eq(&text);
    }

    #[test]
    fn a_guest_leaves() {
        check(
            AttachOptions::of_a_guest(),
            "100 c",
            &expect![[r"
            100: None
            c: Some(Leave)
        "]],
        );
    }

    #[test]
    fn the_host_stops_kills_and_leaves() {
        check(
            AttachOptions::of_the_host(None),
            "c 9 c c",
            &expect![[r#"
                c: Some(Say("stopping; press Ctrl-C again to kill", Stop))
                9: None
                c: Some(Say("killing; press Ctrl-C again to leave it alone", Kill))
                c: Some(Leave)
            "#]],
        );
    }

    #[test]
    fn when_the_time_is_over_it_is_stopped_and_then_killed() {
        check(
            AttachOptions::of_the_host(Some(Duration::from_secs(5))),
            "4 1 2 1 9",
            &expect![[r#"
                4: None
                1: Some(Say("the time is over; stopping", Stop))
                2: None
                1: Some(Say("it did not stop; killing", Kill))
                9: None
            "#]],
        );
    }
}
