//! `rafcon plan`: requests a plan from an engine, explains its steps, and writes the machine.

mod request;
mod words;

use crate::cli;
use crate::clock;
use crate::environment::Environment;
use anyhow::{Context as _, Result, anyhow};
use rafcon_model::Header;
use rafcon_protocol::api::{PlanEvent, PlanFound};
use rafcon_storage::{Naming, save};
use rafcon_supervisor::Interpreter;
use rafcon_supervisor::planning::{Cancel, Planner, domain, machine_of};
use request::Asked;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;
use std::thread;

/// Plans; the exit code is 1 if there is no plan.
pub(super) fn plan(raw: &cli::Plan, environment: &Environment) -> Result<ExitCode> {
    let Asked { request, libraries, given } = request::read(raw)?;
    if raw.facts.is_none() {
        let domain = domain(&request.pool, &libraries);
        let wrong = domain.findings.iter().any(|finding| finding.is_error);
        let text =
            if raw.json { serde_json::to_string(&domain)? + "\n" } else { words::domain(&domain) };
        io::stdout().write_all(text.as_bytes())?;
        return Ok(ExitCode::from(u8::from(wrong)));
    }
    if let Some(out) = &raw.out {
        super::new::check_free(out)?;
    }
    let python = Interpreter::choose(raw.python.python.as_deref(), &environment.locations)?;
    let cancel = cancelled_by_signals()?;
    let planner =
        Planner { libraries: &libraries, python: &python, environment: &environment.locations };
    let mut best: Option<PlanFound> = None;
    let last = planner.plan(&request, &cancel, &mut |event| {
        if raw.json {
            print_line(&event);
        }
        if let PlanEvent::Found(found) = event {
            best = Some(*found);
        }
    });
    if raw.json {
        print_line(&last);
    } else {
        io::stdout().write_all(words::answer(best.as_ref(), &last).as_bytes())?;
    }
    let Some(found) = best else { return Ok(ExitCode::FAILURE) };
    if let Some(out) = &raw.out {
        let mut machine = machine_of(&found, &libraries).map_err(|reason| anyhow!(reason))?;
        machine.header = Header { creation_time: clock::utc().into(), ..Header::default() };
        save(&machine, out, None, Naming::default())?;
        if !raw.json {
            writeln!(io::stdout(), "{}", run_it(out, &given))?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn run_it(out: &Path, given: &[(String, std::path::PathBuf)]) -> String {
    let roots =
        given.iter().map(|(name, folder)| format!(" --library-path {name}={}", folder.display()));
    let roots: String = roots.collect();
    format!("the machine is in {0}; run it: rafcon run {0}{roots}", out.display())
}

/// Prints one line. The reader may have closed the output.
fn print_line(event: &PlanEvent) {
    if let Ok(text) = serde_json::to_string(event) {
        writeln!(io::stdout(), "{text}").unwrap_or_default();
    }
}

/// Cancels on signals: engines have their own process groups, which Ctrl-C does not reach.
fn cancelled_by_signals() -> Result<Cancel> {
    let cancel = Cancel::default();
    let by_signal = cancel.clone();
    let mut signals = Signals::new([SIGINT, SIGTERM, SIGHUP]).context("cannot wait for Ctrl-C")?;
    let wait = move || {
        for _signal in signals.forever() {
            by_signal.cancel();
        }
    };
    thread::Builder::new()
        .name("signals".to_owned())
        .spawn(wait)
        .context("cannot start a thread")?;
    Ok(cancel)
}
