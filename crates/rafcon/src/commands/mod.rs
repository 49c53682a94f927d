//! One module per command. Each converts its options to a checked request and executes it.

mod attach;
mod check;
mod command_list;
mod compare;
mod contacts;
mod control;
mod export;
mod fetch;
mod fmt;
mod history;
mod kept;
mod kept_at_server;
mod link;
mod link_status;
mod login;
mod machines;
mod new;
mod plan;
mod remote;
mod replay;
mod ros;
mod run;
mod runs;
mod serve;
mod shell;
mod show;
mod station_address;
mod tell;
mod user;

use crate::cli::{Cli, Command};
use crate::clock::Clock;
use crate::environment::Environment;
use anyhow::Result;
use std::process::ExitCode;

/// Runs a command and returns the exit code.
pub(crate) fn main(cli: Cli, environment: &Environment, clock: Clock) -> Result<ExitCode> {
    match cli.command {
        Command::Run(request) => run::run(&request, environment, clock),
        Command::Attach(request) => attach::attach(&request, environment, clock),
        Command::Tell(request) => tell::tell(&request, environment),
        Command::Resume(request) => run::resume(&request, environment, clock),
        Command::Again(request) => run::again(&request, environment, clock),
        Command::Runs(request) => runs::runs(&request, environment),
        Command::History(request) => history::history(&request, environment),
        Command::Log(request) => history::log(&request, environment),
        Command::Replay(request) => replay::replay(&request, environment),
        Command::Compare(request) => compare::compare(&request, environment),
        Command::Export(request) => export::export(&request, environment),
        Command::Serve(request) => serve::serve(&request, None, environment),
        Command::Station(request) => {
            serve::serve(&request.serve, Some(request.listen), environment)
        }
        Command::Pair(request) => link::pair(&request, environment),
        Command::Link(request) => link_status::link_status(&request, environment),
        Command::Contacts(request) => contacts::contacts(&request, environment),
        Command::Machines(request) => machines::machines(&request, environment),
        Command::Commands(request) => command_list::command_list(&request, environment),
        Command::Fetch(request) => fetch::fetch(&request, environment),
        Command::Login(request) => login::login(&request, environment),
        Command::Control(request) => control::control(&request, environment),
        Command::User(request) => user::user(&request, environment),
        Command::Check(request) => check::check(&request, environment),
        Command::Plan(request) => plan::plan(&request, environment),
        Command::Show(request) => show::show(&request, environment),
        Command::Fmt(request) => fmt::fmt(&request),
        Command::New(request) => new::new(&request),
        Command::Completions(request) => shell::completions(&request),
        Command::Man(_) => shell::man(),
    }
}
