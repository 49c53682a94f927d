//! `rafcon attach`: views and controls a run in progress, on this computer or at a server.

use crate::cli;
use crate::client::{Server, follow};
use crate::clock::Clock;
use crate::commands::kept::{find_run, run_id};
use crate::commands::remote;
use crate::commands::run::{has_keys, keyboard, names_of_run, view};
use crate::environment::Environment;
use crate::event_queue::{EventQueue, line_to};
use crate::failure::complain;
use crate::follow::{End, RunFollower, RunLoop, RunRole};
use anyhow::Result;
use rafcon_protocol::{Hello, Join, encode};
use rafcon_supervisor::connect_once_listening;
use std::io::Write as _;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

/// Follows a run until it ends or the user leaves.
pub(super) fn attach(
    raw: &cli::Attach,
    environment: &Environment,
    clock: Clock,
) -> Result<ExitCode> {
    if let Some(server) = remote::server(&raw.remote, environment)? {
        remote::refuse_runs(&raw.runs, environment)?;
        let run = remote::run(&server, &raw.run)?.id;
        let at = AtServer { server: &server, output: raw.output, environment, clock };
        let options = FollowOptions { from: raw.from, role: RunRole::Guest, deadline: None };
        let end = at.follow(&run, at.queue()?, options)?;
        return Ok(ended(&end, &at.named(&run)));
    }
    let folder = find_run(&raw.runs, environment, &raw.run)?;
    let mut control = connect_once_listening(&folder)?;
    let keyboard = keyboard(raw.output, environment, true);
    let mut queue = EventQueue::new(keyboard.is_some())?;
    let view = view(raw.output, environment, names_of_run(&folder), keyboard);
    let join = Join { from: raw.from, every_event: view.every_event() };
    queue.join(control.try_clone()?, Some(&folder))?;
    let prefix = format!("attach-{}", std::process::id());
    let follower = RunFollower::new(RunRole::Guest, &environment.user, prefix, None);
    let follower = follower.joining(join).asking_for_the_engine();
    control.write_all(&encode(&Hello::ours())?)?;
    let line = line_to(&folder, control);
    let end =
        RunLoop { follower, view, line, group: None, clock }.until_the_end_is_shown(&queue)?;
    Ok(ended(&end, &run_id(&folder)))
}

/// Options for following one run at a server.
#[derive(Debug, Clone, Copy)]
pub(super) struct FollowOptions {
    /// Number of the first event; 0 for new events only.
    pub(super) from: u64,
    /// Relation of this command to the run.
    pub(super) role: RunRole,
    /// Time of the clock at which the machine is stopped.
    pub(super) deadline: Option<Duration>,
}

/// Settings for following a run at a server.
pub(super) struct AtServer<'a> {
    pub(super) server: &'a Arc<Server>,
    pub(super) output: cli::Output,
    pub(super) environment: &'a Environment,
    pub(super) clock: Clock,
}

impl AtServer<'_> {
    /// A queue with signals and keys as sources.
    pub(super) fn queue(&self) -> Result<EventQueue> {
        EventQueue::new(has_keys(self.output, self.environment))
    }

    /// Follows a run until it ends or the user leaves.
    pub(super) fn follow(
        &self,
        run: &str,
        mut queue: EventQueue,
        options: FollowOptions,
    ) -> Result<End> {
        let FollowOptions { from, role, deadline } = options;
        let Self { server, output, environment, clock } = *self;
        let keyboard = keyboard(output, environment, true);
        let view = view(output, environment, remote::names(server, run), keyboard);
        let join = Join { from, every_event: view.every_event() };
        let line = Box::new(follow(server, run, &mut queue, clock)?);
        let (user, prefix) = (&environment.user, remote::unique("attach")?);
        let follower = RunFollower::new(role, user, prefix, deadline).joining(join);
        RunLoop { follower, view, line, group: None, clock }.until_the_end_is_shown(&queue)
    }

    /// Name of a run in commands.
    pub(super) fn named(&self, run: &str) -> String {
        format!("{run} --server {}", self.server.address)
    }
}

/// Reports an end to the user; `run` is the name of the run in commands.
pub(super) fn ended(end: &End, run: &str) -> ExitCode {
    if let Some(text) = words(end, run) {
        complain(&text);
    }
    ExitCode::from(end.code())
}

/// Message to the user about an end, in addition to the view.
fn words(end: &End, run: &str) -> Option<String> {
    match end {
        End::Finished { .. } | End::OnlyWaited { .. } | End::Killed { .. } => None,
        End::Left => Some(format!("left; the run continues (rafcon attach {run} joins it again)")),
        End::Died(_) => {
            Some(format!("error: the runner died; resume the run: rafcon resume {run}"))
        }
        End::LoadFailed { reason } | End::NotStarted { reason, .. } => {
            Some(format!("error: {reason}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::words;
    use crate::follow::End;
    use expect_test::{Expect, expect};
    use rafcon_supervisor::RunnerDeath;

    fn check(end: &End, expect: &Expect) {
        expect.assert_eq(&words(end, "RUN").unwrap_or_default());
    }

    #[test]
    fn an_end_that_is_not_the_run_s_is_told_with_the_way_out() {
        let death = RunnerDeath {
            reason: "the runner died".to_owned(),
            active: vec!["A".to_owned()],
            ..RunnerDeath::default()
        };
        check(&End::Left, &expect!["left; the run continues (rafcon attach RUN joins it again)"]);
        check(
            &End::Died(death),
            &expect!["error: the runner died; resume the run: rafcon resume RUN"],
        );
        check(&End::LoadFailed { reason: "no room".to_owned() }, &expect!["error: no room"]);
        let killed = End::Killed { timed_out: false, has_begun: true, active: Vec::new() };
        check(&killed, &expect![""]);
    }
}
