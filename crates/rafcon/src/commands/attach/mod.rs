//! `rafcon attach`: a second pair of eyes and hands on a run that is going on.

mod guest;
mod manners;
mod pulse;
mod stay;
mod visit;

use crate::cli;
use crate::client::Server;
use crate::clock::Clock;
use crate::commands::remote;
use crate::commands::run::{names_of_run, view};
use crate::console::Console;
use crate::environment::Environment;
use crate::event_queue::{self, EventQueue};
use crate::failure::complain;
use crate::runs;
use anyhow::Result;
use guest::Guest;
pub(super) use manners::AttachOptions;
use rafcon_protocol::{Hello, Join, encode};
use rafcon_supervisor::{machine_of, socket};
pub(super) use stay::RemoteAttach;
use std::io::{self, IsTerminal as _, Write as _};
use std::process::ExitCode;
use std::sync::Arc;
use visit::Visit;
pub(super) use visit::{VisitEnd, envelope};

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
    let mut control = socket::connect(&folder)?;
    let has_keys = has_keys(raw.output, environment);
    let console = has_keys.then(|| Console::new(true));
    let view = view(raw.output, environment, names_of_run(machine_of(&folder)), console);
    let join = Join { from: raw.from, every_event: view.every_event() };
    let mut wires = EventQueue::new(event_queue::signals()?, has_keys)?;
    wires.join(control.try_clone()?, Some(&folder))?;
    let prefix = format!("attach-{}", std::process::id());
    let visit = Visit::new(join, &environment.user, prefix, AttachOptions::of_a_guest());
    let visit = visit.asking_for_the_engine();
    control.write_all(&encode(&Hello::ours())?)?;
    let end = Guest { visit, view, line: Box::new(control), clock }.until_the_end(&wires)?;
    if let Some(text) = words(&end, &runs::id(&folder)) {
        complain(&text);
    }
    Ok(ExitCode::from(end.code()))
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
    let wires = EventQueue::new(event_queue::signals()?, has_keys)?;
    let manners = AttachOptions::of_a_guest();
    let (from, run) = (raw.from, run.as_str());
    let stay = RemoteAttach { server, run, wires, view, from, manners, environment, clock };
    let end = stay.until_the_end()?;
    if let Some(text) = words(&end, &format!("{run} --server {}", server.address)) {
        complain(&text);
    }
    Ok(ExitCode::from(end.code()))
}

/// Whether the keyboard is for the view.
pub(super) fn has_keys(output: cli::Output, environment: &Environment) -> bool {
    let is_terminal = io::stdout().is_terminal() && io::stdin().is_terminal();
    output == cli::Output::Text && is_terminal && !environment.dumb_terminal
}

/// What the user is told about an end besides what is shown; `run` is how commands name it.
pub(super) fn words(end: &VisitEnd, run: &str) -> Option<String> {
    match end {
        VisitEnd::Finished { .. } | VisitEnd::Killed { .. } => None,
        VisitEnd::Left => Some(format!("left; it goes on (rafcon attach {run} joins it again)")),
        VisitEnd::Lost { .. } => {
            Some(format!("error: its runner is gone; to go on: rafcon resume {run}"))
        }
        VisitEnd::Refused(reason) => Some(format!("error: {reason}")),
    }
}
