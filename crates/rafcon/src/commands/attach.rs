//! `rafcon attach`: a second pair of eyes and hands on a run that goes on, on this computer or at a server.

use crate::cli;
use crate::client::{Server, follow};
use crate::clock::Clock;
use crate::commands::remote;
use crate::commands::run::{names_of_run, view};
use crate::console::Console;
use crate::environment::Environment;
use crate::event_queue::{self, EventQueue};
use crate::failure::complain;
use crate::follow::{End, Follower, Role, RunLoop};
use crate::runs;
use crate::view::View;
use anyhow::Result;
use rafcon_protocol::{Hello, Join, encode};
use rafcon_supervisor::{connect, machine_of};
use std::io::{self, IsTerminal as _, Write as _};
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
        return at_server(raw, &server, environment, clock);
    }
    let folder = runs::find(&raw.runs, environment, &raw.run)?;
    let mut control = connect(&folder)?;
    let has_keys = has_keys(raw.output, environment);
    let console = has_keys.then(|| Console::new(true));
    let view = view(raw.output, environment, names_of_run(machine_of(&folder)), console);
    let join = Join { from: raw.from, every_event: view.every_event(), values: false };
    let mut queue = EventQueue::new(event_queue::signals()?, has_keys)?;
    queue.join(control.try_clone()?)?;
    let prefix = format!("attach-{}", std::process::id());
    let follower = Follower::new(Role::Guest, &environment.user, prefix, None);
    let follower = follower.joining(join).asking_for_the_engine();
    control.write_all(&encode(&Hello::ours())?)?;
    let line = Box::new(control);
    let end =
        RunLoop { follower, view, line, group: None, clock }.until_the_end_is_shown(&queue)?;
    Ok(ended(&end, &runs::id(&folder)))
}

fn at_server(
    raw: &cli::Attach,
    server: &Arc<Server>,
    environment: &Environment,
    clock: Clock,
) -> Result<ExitCode> {
    remote::refuse_runs(&raw.runs, environment)?;
    let run = remote::run(server, &raw.run)?.id;
    let has_keys = has_keys(raw.output, environment);
    let console = has_keys.then(|| Console::new(true));
    let view = view(raw.output, environment, remote::names(server, &run), console);
    let queue = EventQueue::new(event_queue::signals()?, has_keys)?;
    let (from, run, role) = (raw.from, run.as_str(), (Role::Guest, None));
    let visit = RemoteAttach { server, run, queue, view, from, role, environment, clock };
    let end = visit.until_the_end()?;
    Ok(ended(&end, &format!("{run} --server {}", server.address)))
}

/// What following a run at a server needs.
pub(super) struct RemoteAttach<'a> {
    pub(super) server: &'a Arc<Server>,
    /// The run's id.
    pub(super) run: &'a str,
    pub(super) queue: EventQueue,
    pub(super) view: Box<dyn View>,
    /// The first event that is told; 0: from now on.
    pub(super) from: u64,
    /// What this program has to do with the run, and when the machine is stopped.
    pub(super) role: (Role, Option<Duration>),
    pub(super) environment: &'a Environment,
    pub(super) clock: Clock,
}

impl RemoteAttach<'_> {
    /// Follows the run until it ends or the user leaves.
    pub(super) fn until_the_end(self) -> Result<End> {
        let Self { server, run, mut queue, view, from, role, environment, clock } = self;
        let join = Join { from, every_event: view.every_event(), values: false };
        let line = Box::new(follow(server, run, &mut queue, clock)?);
        let ((role, deadline), prefix) = (role, remote::unique("attach")?);
        let follower = Follower::new(role, &environment.user, prefix, deadline).joining(join);
        RunLoop { follower, view, line, group: None, clock }.until_the_end_is_shown(&queue)
    }
}

/// Whether the keyboard is for the view.
pub(super) fn has_keys(output: cli::Output, environment: &Environment) -> bool {
    let is_terminal = io::stdout().is_terminal() && io::stdin().is_terminal();
    output == cli::Output::Text && is_terminal && !environment.dumb_terminal
}

/// Tells the user about an end; `run` is how commands name it.
fn ended(end: &End, run: &str) -> ExitCode {
    if let Some(text) = words(end, run) {
        complain(&text);
    }
    ExitCode::from(end.code())
}

/// What the user is told about an end besides what is shown; `run` is how commands name it.
pub(super) fn words(end: &End, run: &str) -> Option<String> {
    match end {
        End::Finished { .. } | End::Killed { .. } => None,
        End::Left => Some(format!("left; it goes on (rafcon attach {run} joins it again)")),
        End::Died(_) => Some(format!("error: its runner is gone; to go on: rafcon resume {run}")),
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
            reason: "its runner is gone".to_owned(),
            active: vec!["A".to_owned()],
            said: Vec::new(),
            is_cut_off: false,
        };
        check(&End::Left, &expect!["left; it goes on (rafcon attach RUN joins it again)"]);
        check(
            &End::Died(death),
            &expect!["error: its runner is gone; to go on: rafcon resume RUN"],
        );
        check(&End::LoadFailed { reason: "no room".to_owned() }, &expect!["error: no room"]);
        check(&End::Killed { timed_out: false, active: Vec::new() }, &expect![""]);
    }
}
