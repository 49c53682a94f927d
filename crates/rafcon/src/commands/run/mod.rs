//! `rafcon run`: from the words of the command line to the exit code.

mod drive;
mod report;
mod request;

use crate::cli;
use crate::clock::Clock;
use crate::environment::Environment;
use crate::runner::extension;
use crate::runner::interpreter::Interpreter;
use crate::view::{Json, Lines, Live, Paint, View};
use anyhow::Result;
use request::Request;
use std::io::{self, IsTerminal as _};
use std::process::ExitCode;

/// Runs a machine until it ends.
pub(super) fn run(raw: &cli::Run, environment: &Environment, clock: Clock) -> Result<ExitCode> {
    let request = Request::new(raw)?;
    let interpreter = Interpreter::choose(raw.python.python.as_deref(), environment)?;
    let extension = extension::find(environment)?;
    let view = view(&request, environment);
    let start = crate::runner::Start { interpreter: &interpreter, extension: &extension };
    let end = drive::follow(&request, &start, view, clock)?;
    Ok(ExitCode::from(end.code()))
}

fn view(request: &Request, environment: &Environment) -> Box<dyn View> {
    let terminal = io::stdout().is_terminal() && !environment.dumb_terminal;
    match request.output {
        cli::Output::Json => Box::new(Json::new(io::stdout())),
        cli::Output::Text if terminal => {
            let paint = Paint { colour: !environment.no_color, unicode: environment.unicode };
            Box::new(Live::new(paint, request.names()))
        }
        cli::Output::Text => Box::new(Lines::new(io::stdout(), request.names())),
    }
}
