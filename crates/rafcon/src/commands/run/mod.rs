//! `rafcon run` and `rafcon resume`: from the options to the exit code.

mod at_server;
mod drive;
mod limits;
mod own_line;
mod report;
mod request;
mod watchdog;

use crate::cli;
use crate::clock::Clock;
use crate::commands::kept::{find_run, make_run, runs_folder};
use crate::commands::remote;
use crate::console::Console;
use crate::environment::Environment;
use crate::failure::Usage;
use crate::view::{Json, Lines, Live, Names, Paint, View};
use anyhow::Result;
use drive::{Place, RunSetup};
use rafcon_protocol::Launch;
use rafcon_supervisor::{kept_machine, machine_of, resume_launch};
use request::Request;
use std::io::{self, IsTerminal as _};
use std::path::Path;
use std::process::ExitCode;
use std::rc::Rc;

/// Runs a machine until it ends.
pub(super) fn run(raw: &cli::Run, environment: &Environment, clock: Clock) -> Result<ExitCode> {
    if let Some(server) = remote::server(&raw.remote, environment)? {
        return at_server::run(raw, &server, environment, clock);
    }
    let request = Request::new(raw)?;
    let place = match raw.keeping.keep {
        cli::Level::Off => Place::passing()?,
        cli::Level::Full | cli::Level::Status => {
            let runs = runs_folder(&raw.runs, environment)?;
            Place::Kept(make_run(&runs, &request.machine_name())?)
        }
    };
    let launch = request.launch(&place)?;
    let (python, output, timeout) = (&raw.python, raw.output, request.timeout);
    let setup = RunSetup { python, output, timeout, environment, clock };
    let (names, folder) = (request.later_names(), place.folder().to_owned());
    let names: LaterNames = Rc::new(move || following(names(), &folder));
    ended(setup, launch, &place, &names)
}

/// Resumes a run and follows it until it ends.
pub(super) fn resume(
    raw: &cli::Resume,
    environment: &Environment,
    clock: Clock,
) -> Result<ExitCode> {
    if let Some(server) = remote::server(&raw.remote, environment)? {
        return at_server::resume(raw, &server, environment, clock);
    }
    let place = Place::Kept(find_run(&raw.runs, environment, &raw.run)?);
    let launch = resume_launch(place.folder(), request::on_crash(raw.policy), raw.from);
    let timeout = raw.timeout.map(request::timeout).transpose()?;
    let setup = RunSetup { python: &raw.python, output: raw.output, timeout, environment, clock };
    let folder = place.folder().to_owned();
    let names: LaterNames = Rc::new(move || names_of_run(&folder));
    ended(setup, launch, &place, &names)
}

/// Starts the machine of a run of a server again.
pub(super) fn again(raw: &cli::Again, environment: &Environment, clock: Clock) -> Result<ExitCode> {
    let server = remote::meet(&raw.server, &raw.access, environment)?;
    at_server::again(raw, &server, clock)
}

/// The names of the machine of a run, from the run's copy, or else from the original location.
pub(super) fn names_of_run(folder: &Path) -> Names {
    let run = folder.to_owned();
    let load = move || {
        let source = || crate::machine::Source::of(machine_of(&run)).load_quietly().ok();
        kept_machine(&run, None).or_else(|| Some(source()?.machine))
    };
    following(Names::new(load), folder)
}

/// The names, updated after changes of the run's machine.
fn following(names: Names, folder: &Path) -> Names {
    let run = folder.to_owned();
    names.following(move |hash| kept_machine(&run, Some(hash)))
}

/// Names that are loaded on demand.
type LaterNames = Rc<dyn Fn() -> Names>;

/// Runs to the end, and reports an end other than the machine's own.
fn ended(
    setup: RunSetup<'_>,
    launch: Launch,
    place: &Place,
    names: &LaterNames,
) -> Result<ExitCode> {
    let end = setup.follow(launch, place, names)?;
    report::end(&end, place.kept_run(), Some(place.folder()), || names());
    Ok(ExitCode::from(end.code()))
}

fn is_terminal(environment: &Environment) -> bool {
    io::stdout().is_terminal() && !environment.dumb_terminal
}

/// True if the keyboard controls the view.
pub(super) fn has_keys(output: cli::Output, environment: &Environment) -> bool {
    output == cli::Output::Text && is_terminal(environment) && io::stdin().is_terminal()
}

/// The keyboard, if it controls the view of a run that can be left (`may_leave`) or ends with this program.
pub(super) fn keyboard(
    output: cli::Output,
    environment: &Environment,
    may_leave: bool,
) -> Option<Console> {
    has_keys(output, environment).then(|| Console::new(may_leave))
}

/// The view of a run.
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

/// A breakpoint in the syntax of the command line.
fn breakpoint(id: u64, text: &str, names: &mut Names) -> Result<rafcon_protocol::Breakpoint> {
    let refused = |reason: String| Usage(format!("--break {text}: {reason}"));
    let mut breakpoint = crate::console::breakpoint(id, text).map_err(refused)?;
    breakpoint.path = names.resolve(&breakpoint.path).map_err(refused)?;
    Ok(breakpoint)
}
