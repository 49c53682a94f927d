//! `rafcon run` and `rafcon resume` at a server: the same words, views and exit codes; the run is the server's.

use super::{report, request, view};
use crate::cli;
use crate::client::{Fault, Server};
use crate::clock::Clock;
use crate::commands::attach::{self, RemoteAttach, has_keys};
use crate::commands::remote::{self, refuse, refuse_runs};
use crate::console::Console;
use crate::environment::Environment;
use crate::event_queue::{self, EventQueue};
use crate::failure::{Usage, complain};
use crate::follow::{End, Role};
use crate::view::Names;
use anyhow::Result;
use rafcon_protocol::Afterwards;
use rafcon_protocol::api::{MachineFile, ResumeRun, RunSummary, StartRun};
use std::process::ExitCode;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// For how long a start is asked for again whose answer got lost.
const START_RETRY_TIMEOUT: Duration = Duration::from_mins(1);
/// Between two attempts.
const PAUSE: Duration = Duration::from_secs(1);

/// Has a server run a machine, until it ends.
pub(super) fn run(
    raw: &cli::Run,
    server: &Arc<Server>,
    environment: &Environment,
    clock: Clock,
) -> Result<ExitCode> {
    fits(raw, environment)?;
    let timeout = raw.timeout.map(request::timeout).transpose()?;
    let request = start_run(raw, server)?;
    // Listened to before there is a run, so that none is left alone by Ctrl-C.
    let at = Follow { server, output: raw.output, environment, clock };
    let queue = EventQueue::new(event_queue::signals()?, has_keys(raw.output, environment))?;
    let deadline = timeout.map(|timeout| clock.now().saturating_add(timeout));
    match begun(clock, || server.start(&request)) {
        Ok(run) => at.until_the_end(&run.id, queue, 1, deadline),
        Err(fault) => at.not_begun(fault),
    }
}

/// Has a server take a run up again, until it ends.
pub(super) fn resume(
    raw: &cli::Resume,
    server: &Arc<Server>,
    environment: &Environment,
    clock: Clock,
) -> Result<ExitCode> {
    refuse_runs(&raw.runs, environment)?;
    refuse_python(&raw.python, environment)?;
    let timeout = raw.timeout.map(request::timeout).transpose()?;
    let before = remote::run(server, &raw.run)?;
    let policy = request::on_crash(raw.policy);
    let request = ResumeRun { id: remote::unique("resume")?, policy, from: raw.from };
    let at = Follow { server, output: raw.output, environment, clock };
    let queue = EventQueue::new(event_queue::signals()?, has_keys(raw.output, environment))?;
    let deadline = timeout.map(|timeout| clock.now().saturating_add(timeout));
    match begun(clock, || server.resume(&before.id, &request)) {
        Ok(run) => {
            let from = before.events + 1;
            at.until_the_end(&run.id, queue, from, deadline)
        }
        Err(fault) => at.not_begun(fault),
    }
}

/// Refuses what is the server's to decide.
fn fits(raw: &cli::Run, environment: &Environment) -> Result<()> {
    let libraries = &raw.libraries;
    refuse_runs(&raw.runs, environment)?;
    refuse_python(&raw.python, environment)?;
    let own = "it was started with its own libraries (`rafcon serve --library-path`)";
    refuse(!libraries.roots.is_empty(), "--library-path", own)?;
    refuse(libraries.config.is_some(), "--config", own)?;
    let why = "a run that is followed over the network is kept; --keep status keeps little";
    refuse(raw.keeping.keep == cli::Level::Off, "--keep off", why)
}

fn refuse_python(raw: &cli::Python, environment: &Environment) -> Result<()> {
    let [in_environment, _] = &environment.options;
    let is_given = raw.python.is_some() && raw.python != *in_environment;
    refuse(is_given, "--python", "it was started with its own (`rafcon serve --python`)")
}

fn start_run(raw: &cli::Run, server: &Arc<Server>) -> Result<StartRun> {
    let machine = machine(raw)?;
    let breakpoints = if raw.breakpoints.is_empty() {
        Vec::new()
    } else {
        let found = server.machine_in(&machine)?;
        let mut names = Names::new(move || Some(found));
        request::breakpoints(&raw.breakpoints, &mut names)?
    };
    Ok(StartRun {
        id: remote::unique("run")?,
        machine,
        inputs: request::named(&raw.inputs, request::INPUT)?.into_iter().collect(),
        globals: request::named(&raw.globals, request::GLOBAL)?.into_iter().collect(),
        start_from: raw.start_from.clone(),
        afterwards: Afterwards::GoOn,
        keeping: request::keeping(raw.keeping.keep),
        strict: raw.keeping.strict,
        hold: raw.hold,
        breakpoints,
        on_crash: raw.keeping.on_crash.map(request::on_crash),
        size_max: request::size_max(&raw.keeping),
    })
}

fn machine(raw: &cli::Run) -> Result<MachineFile> {
    let text = raw.path.to_str().map(|text| text.trim_end_matches('/'));
    match text.and_then(|text| text.split_once('/')) {
        Some((project, path)) if !project.is_empty() => {
            Ok(MachineFile { project: project.to_owned(), path: path.to_owned() })
        }
        _ => {
            let path = raw.path.display();
            let words =
                format!("{path}: write the project and the folder in it, such as robots/pick");
            Err(Usage(words).into())
        }
    }
}

/// Asks for a run, and again by the same id if the answer got lost.
fn begun(clock: Clock, ask: impl Fn() -> Result<RunSummary, Fault>) -> Result<RunSummary, Fault> {
    let (until, mut is_sent) = (clock.now() + START_RETRY_TIMEOUT, false);
    loop {
        let fault = match ask() {
            Ok(run) => return Ok(run),
            Err(fault) => fault,
        };
        is_sent |= fault.may_have_arrived();
        if !is_sent || !fault.is_passing() || clock.now() >= until {
            return Err(fault);
        }
        complain(&format!("rafcon: {fault} (asking again)"));
        thread::park_timeout(PAUSE);
    }
}

/// How a run at a server is followed.
struct Follow<'a> {
    server: &'a Arc<Server>,
    output: cli::Output,
    environment: &'a Environment,
    clock: Clock,
}

impl Follow<'_> {
    fn until_the_end(
        self,
        run: &str,
        queue: EventQueue,
        from: u64,
        deadline: Option<Duration>,
    ) -> Result<ExitCode> {
        let Self { server, output, environment, clock } = self;
        let console = has_keys(output, environment).then(|| Console::new(true));
        let view = view(output, environment, remote::names(server, run), console);
        let role = (Role::Host, deadline);
        let visit = RemoteAttach { server, run, queue, view, from, role, environment, clock };
        let end = visit.until_the_end()?;
        let named = format!("{run} --server {}", server.address);
        match &end {
            End::Finished { timed_out: false, .. } => {}
            End::Finished { .. } | End::Killed { .. } | End::Died(_) => {
                complain(&report::text(&end, &mut remote::names(server, run)));
            }
            End::Left | End::LoadFailed { .. } | End::NotStarted { .. } => {
                if let Some(text) = attach::words(&end, &named) {
                    complain(&text);
                }
            }
        }
        if let End::Killed { .. } | End::Died(_) = end {
            complain(&report::way_out(&named));
        }
        Ok(ExitCode::from(end.code()))
    }

    /// A run that did not begin is shown as on this computer.
    fn not_begun(self, fault: Fault) -> Result<ExitCode> {
        let end = match fault {
            Fault::Refused { refusal, .. } if refusal.code == "load_failed" => {
                End::LoadFailed { reason: refusal.message }
            }
            Fault::Refused { refusal, .. } if refusal.code == "not_started" => {
                End::NotStarted { reason: refusal.message, said: Vec::new() }
            }
            fault => return Err(fault.into()),
        };
        let mut view = view(self.output, self.environment, Names::new(|| None), None);
        view.end(&end)?;
        complain(&report::text(&end, &mut Names::new(|| None)));
        Ok(ExitCode::from(end.code()))
    }
}
