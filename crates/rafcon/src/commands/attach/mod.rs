//! `rafcon attach`: a second pair of eyes and hands on a run that is going on.

mod guest;
mod manners;
mod visit;

use crate::cli;
use crate::clock::Clock;
use crate::commands::run::{names_of_run, view};
use crate::console::Console;
use crate::environment::Environment;
use crate::failure::complain;
use crate::runs;
use crate::wires::{self, Wires};
use anyhow::Result;
use guest::{Guest, Line};
use manners::Manners;
use rafcon_protocol::{Hello, Join, ToRunner, encode};
use rafcon_supervisor::{machine_of, socket};
use std::io::{self, IsTerminal as _, Write as _};
use std::os::unix::net::UnixStream;
use std::process::ExitCode;
pub(super) use visit::envelope;
use visit::{End, Visit};

/// Follows a run until it ends or the user leaves.
pub(super) fn attach(
    raw: &cli::Attach,
    environment: &Environment,
    clock: Clock,
) -> Result<ExitCode> {
    let folder = runs::find(&raw.runs, environment, &raw.run)?;
    let mut control = socket::connect(&folder)?;
    let has_keys = raw.output == cli::Output::Text
        && io::stdout().is_terminal()
        && io::stdin().is_terminal()
        && !environment.dumb_terminal;
    let console = has_keys.then(|| Console::new(true));
    let view = view(raw.output, environment, names_of_run(machine_of(&folder)), console);
    let join = Join { from: raw.from, every_event: view.every_event(), values: false };
    let mut wires = Wires::new(wires::signals()?, has_keys)?;
    wires.join(control.try_clone()?)?;
    let prefix = format!("attach-{}", std::process::id());
    let visit = Visit::new(join, &environment.user, prefix, Manners::of_a_guest());
    control.write_all(&encode(&Hello::ours())?)?;
    let end = Guest { visit, view, line: Box::new(control), clock }.until_the_end(&wires)?;
    if let Some(text) = words(&end, &runs::id(&folder)) {
        complain(&text);
    }
    Ok(ExitCode::from(end.code()))
}

/// What the user is told about an end besides what is shown.
fn words(end: &End, run: &str) -> Option<String> {
    match end {
        End::Finished { .. } | End::Killed { .. } => None,
        End::Left => Some(format!("left; {run} goes on (rafcon attach {run} joins it again)")),
        End::Lost { .. } => {
            Some(format!("error: the runner of {run} is gone; to go on: rafcon resume {run}"))
        }
        End::Refused(reason) => Some(format!("error: {reason}")),
    }
}

impl Line for UnixStream {
    /// A runner that does not listen any more is noticed by its silence.
    fn say(&mut self, message: &ToRunner) -> Result<()> {
        self.write_all(&encode(message)?).unwrap_or_default();
        Ok(())
    }
}
