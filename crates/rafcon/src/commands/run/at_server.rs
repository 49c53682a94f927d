//! `rafcon run` and `rafcon resume` at a server: messages, views and exit codes as for local runs; the run belongs to the
//! server.

use super::{report, request, view};
use crate::cli;
use crate::client::{Fault, Server};
use crate::clock::Clock;
use crate::commands::attach::{self, AtServer, FollowOptions};
use crate::commands::remote::{self, refuse, refuse_runs};
use crate::environment::Environment;
use crate::failure::{Usage, complain};
use crate::follow::{End, RunRole};
use crate::view::Names;
use anyhow::Result;
use rafcon_protocol::Afterwards;
use rafcon_protocol::api::{MachineFile, ResumeRun, RunSummary, StartAgain, StartRun, StartedRun};
use std::io::{self, Write as _};
use std::process::ExitCode;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// Time limit of retries for a start whose response was lost.
const START_RETRY_TIMEOUT: Duration = Duration::from_mins(1);
/// Delay between two attempts.
const PAUSE: Duration = Duration::from_secs(1);

/// Runs a machine at a server, until it ends.
pub(super) fn run(
    raw: &cli::Run,
    server: &Arc<Server>,
    environment: &Environment,
    clock: Clock,
) -> Result<ExitCode> {
    fits(raw, environment)?;
    let timeout = raw.timeout.map(request::timeout).transpose()?;
    if let Some(robot) = &raw.robot {
        let why =
            "the robot runs the machine, and its station does not follow it: `rafcon attach` does";
        refuse(timeout.is_some(), "--timeout", why)?;
        let names = "the machine is on the robot: set breakpoints when the run is at the station";
        refuse(!raw.breakpoints.is_empty(), "--break", names)?;
        let id = request_id(raw.request.as_ref(), "run")?;
        let request = StartRun { id: id.clone(), ..start_run(raw, server)? };
        let run = asked(clock, &id, || server.start_at(robot, &request))?;
        return started(&run, raw.output);
    }
    let request = start_run(raw, server)?;
    let at = AtServer { server, output: raw.output, environment, clock };
    begin(&at, timeout, 1, || server.start(&request))
}

/// Resumes a run at a server, until it ends.
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
    if let Some(robot) = &before.robot {
        let why =
            "the robot resumes the run, and its station does not follow it: `rafcon attach` does";
        refuse(timeout.is_some(), "--timeout", why)?;
        // The first event of the resumed run arrives after the delay of the link.
        begun(clock, || server.resume(&before.id, &request))?;
        complain(&format!("robot {robot} has resumed the run; follow it with `rafcon attach`"));
        return Ok(ExitCode::SUCCESS);
    }
    let at = AtServer { server, output: raw.output, environment, clock };
    begin(&at, timeout, before.events + 1, || server.resume(&before.id, &request))
}

/// Starts the machine of a run of a server again.
pub(super) fn again(raw: &cli::Again, server: &Server, clock: Clock) -> Result<ExitCode> {
    let before = remote::run(server, &raw.run)?;
    let id = request_id(raw.request.as_ref(), "again")?;
    let request = StartAgain { id: id.clone() };
    started(&asked(clock, &id, || server.start_again(&before.id, &request))?, raw.output)
}

/// Prints the id of a run that was started, as text or JSON.
fn started(run: &StartedRun, output: cli::Output) -> Result<ExitCode> {
    let StartedRun { run: id, robot } = run;
    match output {
        cli::Output::Json => writeln!(io::stdout(), "{}", serde_json::to_string(run)?)?,
        cli::Output::Text => writeln!(io::stdout(), "{id}")?,
    }
    let by = robot.as_ref().map(|robot| format!("robot {robot} has ")).unwrap_or_default();
    complain(&format!("{by}started the run; follow it with `rafcon attach {id}`"));
    Ok(ExitCode::SUCCESS)
}

/// Id of a request: a new one, or that of an earlier request without a response.
fn request_id(given: Option<&String>, what: &str) -> Result<String> {
    given.map_or_else(|| remote::unique(what), |id| Ok(id.clone()))
}

/// Has a robot start a run. If the fate of the request is unknown, prints its id: a repetition with it starts no second run.
fn asked<T>(clock: Clock, id: &str, ask: impl Fn() -> Result<T, Fault>) -> Result<T> {
    let answer = begun(clock, ask);
    if answer.as_ref().is_err_and(|fault| fault.is_passing() || fault.may_have_arrived()) {
        complain(&format!("rafcon: to ask for the fate of this request, add `--request {id}`"));
    }
    Ok(answer?)
}

/// Refuses options that the server decides.
fn fits(raw: &cli::Run, environment: &Environment) -> Result<()> {
    let libraries = &raw.libraries;
    refuse_runs(&raw.runs, environment)?;
    refuse_python(&raw.python, environment)?;
    let own = "the server has its own libraries (`rafcon serve --library-path`)";
    refuse(!libraries.roots.is_empty(), "--library-path", own)?;
    refuse(libraries.config.is_some(), "--config", own)?;
    let why = "the server records every run; `--keep status` records the least";
    refuse(raw.keeping.keep == cli::Level::Off, "--keep off", why)
}

fn refuse_python(raw: &cli::Python, environment: &Environment) -> Result<()> {
    let [in_environment, _] = &environment.options;
    let is_given = raw.python.is_some() && raw.python != *in_environment;
    refuse(is_given, "--python", "the server has its own interpreter (`rafcon serve --python`)")
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
    match raw.path.to_str().and_then(|text| text.split_once('/')) {
        // A project can be a machine itself: its path ends with the slash.
        Some((project, path)) if !project.is_empty() => {
            let path = path.trim_end_matches('/').to_owned();
            Ok(MachineFile { project: project.to_owned(), path })
        }
        _ => {
            let path = raw.path.display();
            let words = format!(
                "{path}: write the project and the folder of the machine, such as robots/pick"
            );
            Err(Usage(words).into())
        }
    }
}

/// Requests a run, and repeats the request with an unchanged id if the response is lost.
fn begun<T>(clock: Clock, ask: impl Fn() -> Result<T, Fault>) -> Result<T, Fault> {
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
        complain(&format!("rafcon: {fault} (trying again)"));
        thread::park_timeout(PAUSE);
    }
}

/// Requests a run and follows it from this event on until it ends.
fn begin(
    at: &AtServer<'_>,
    timeout: Option<Duration>,
    from: u64,
    ask: impl Fn() -> Result<RunSummary, Fault>,
) -> Result<ExitCode> {
    // Connect before the run exists, so that Ctrl-C never leaves a run behind.
    let queue = at.queue()?;
    let deadline = timeout.map(|timeout| at.clock.now().saturating_add(timeout));
    let run = match begun(at.clock, ask) {
        Ok(run) => run.id,
        Err(fault) => return not_begun(at, fault),
    };
    let options = FollowOptions { from, role: RunRole::Host, deadline };
    let end = at.follow(&run, queue, options)?;
    let named = at.named(&run);
    if let End::Left = end {
        return Ok(attach::ended(&end, &named));
    }
    report::end(&end, Some(&named), None, || remote::names(at.server, &run));
    Ok(ExitCode::from(end.code()))
}

/// Reports a failed start as for a local run.
fn not_begun(at: &AtServer<'_>, fault: Fault) -> Result<ExitCode> {
    let end = match fault {
        Fault::Refused { refusal, .. } if refusal.code == "load_failed" => {
            End::LoadFailed { reason: refusal.message }
        }
        Fault::Refused { refusal, .. } if refusal.code == "not_started" => {
            End::NotStarted { reason: refusal.message, said: Vec::new() }
        }
        fault => return Err(fault.into()),
    };
    view(at.output, at.environment, Names::new(|| None), None).end(&end)?;
    report::end(&end, None, None, || Names::new(|| None));
    Ok(ExitCode::from(end.code()))
}
