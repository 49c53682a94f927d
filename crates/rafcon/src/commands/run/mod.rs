//! `rafcon run` and `rafcon resume`: from the words of the command line to the exit code.

mod at_server;
mod drive;
mod place;
mod report;
mod request;

use crate::cli;
use crate::clock::Clock;
use crate::commands::remote;
use crate::console::Console;
use crate::environment::Environment;
use crate::failure::Usage;
use crate::runs;
use crate::view::{Json, Lines, Live, Names, Paint, View};
use anyhow::Result;
use drive::RunEnvironment;
use place::Place;
use rafcon_protocol::Launch;
use rafcon_supervisor::{Interpreter, Start, extension, resume_launch};
use request::Request;
use std::io::{self, IsTerminal as _};
use std::path::PathBuf;
use std::process::ExitCode;

/// Runs a machine until it ends.
pub(super) fn run(raw: &cli::Run, environment: &Environment, clock: Clock) -> Result<ExitCode> {
    if let Some(server) = remote::server(&raw.remote, environment)? {
        return at_server::run(raw, &server, environment, clock);
    }
    let request = Request::new(raw)?;
    let place = match raw.keeping.keep {
        cli::Level::Off => Place::passing()?,
        cli::Level::Full | cli::Level::Status => {
            let runs = runs::folder(&raw.runs, environment)?;
            Place::Kept(runs::make(&runs, &request.machine_name())?)
        }
    };
    let launch = request.launch(&place)?;
    let names = || request.names();
    let timeout = request.timeout;
    RunSetup { raw: &raw.python, output: raw.output, timeout, environment, clock }
        .run(launch, &place, &names)
}

/// Takes a run up again until it ends.
pub(super) fn resume(
    raw: &cli::Resume,
    environment: &Environment,
    clock: Clock,
) -> Result<ExitCode> {
    if let Some(server) = remote::server(&raw.remote, environment)? {
        return at_server::resume(raw, &server, environment, clock);
    }
    let place = Place::Kept(runs::find(&raw.runs, environment, &raw.run)?);
    let launch = resume_launch(place.folder(), request::on_crash(raw.policy), raw.from);
    let machine = launch.machine.clone();
    let names = move || names_of_run(machine.clone());
    let timeout = raw.timeout.map(request::timeout).transpose()?;
    RunSetup { raw: &raw.python, output: raw.output, timeout, environment, clock }
        .run(launch, &place, &names)
}

/// The names of the machine that lies where that of a run was.
pub(super) fn names_of_run(machine: PathBuf) -> Names {
    Names::new(move || crate::machine::Source::of(machine).load_quietly().ok().map(|l| l.machine))
}

/// What is needed besides the launch.
struct RunSetup<'a> {
    raw: &'a cli::Python,
    output: cli::Output,
    timeout: Option<std::time::Duration>,
    environment: &'a Environment,
    clock: Clock,
}

impl RunSetup<'_> {
    fn run(self, launch: Launch, place: &Place, names: &dyn Fn() -> Names) -> Result<ExitCode> {
        let surroundings = &self.environment.surroundings;
        let interpreter = Interpreter::choose(self.raw.python.as_deref(), surroundings)?;
        let extension = extension::find(surroundings)?;
        let start = Start { interpreter: &interpreter, extension: &extension };
        let keyboard = keyboard(self.output, self.environment, false);
        let has_keys = keyboard.is_some();
        let view = view(self.output, self.environment, names(), keyboard);
        let launch = Launch { every_event: view.every_event(), ..launch };
        let outside = RunEnvironment {
            start: &start,
            view,
            has_keys,
            clock: self.clock,
            author: &self.environment.user,
            timeout: self.timeout,
        };
        let end = drive::follow(launch, place, outside)?;
        report::end(&end, place.kept_run(), Some(place.folder()), names);
        Ok(ExitCode::from(end.code()))
    }
}

fn is_terminal(environment: &Environment) -> bool {
    io::stdout().is_terminal() && !environment.dumb_terminal
}

/// Whether the keyboard is for the view.
pub(super) fn has_keys(output: cli::Output, environment: &Environment) -> bool {
    output == cli::Output::Text && is_terminal(environment) && io::stdin().is_terminal()
}

/// The keyboard, if it is for the view: of a run that can be left (`may_leave`) or ends with this program.
pub(super) fn keyboard(
    output: cli::Output,
    environment: &Environment,
    may_leave: bool,
) -> Option<Console> {
    has_keys(output, environment).then(|| Console::new(may_leave))
}

/// What shows a run.
pub(super) fn view(
    output: cli::Output,
    environment: &Environment,
    names: Names,
    keyboard: Option<Console>,
) -> Box<dyn View> {
    match output {
        cli::Output::Json => Box::new(Json::new(io::stdout())),
        cli::Output::Text if is_terminal(environment) => {
            let paint = Paint { colour: !environment.no_color, unicode: environment.unicode };
            Box::new(Live::new(paint, names, keyboard))
        }
        cli::Output::Text => Box::new(Lines::new(io::stdout(), names)),
    }
}

/// A breakpoint in the words of the command line.
fn breakpoint(id: u64, text: &str, names: &mut Names) -> Result<rafcon_protocol::Breakpoint> {
    let refused = |reason: String| Usage(format!("--break {text}: {reason}"));
    let mut breakpoint = crate::console::breakpoint(id, text).map_err(refused)?;
    breakpoint.path = names.resolve(&breakpoint.path).map_err(refused)?;
    Ok(breakpoint)
}
