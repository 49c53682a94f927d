//! `rafcon login`: exchanges a name and a password for a token, and saves it.

use super::remote;
use crate::cli;
use crate::environment::Environment;
use crate::failure::Usage;
use anyhow::{Context as _, Result};
use rafcon_protocol::api::{Login, NewToken};
use rustix::termios::{LocalModes, OptionalActions, Termios, tcgetattr, tcsetattr};
use std::io::{self, IsTerminal as _, Write as _};
use std::process::ExitCode;

/// Lifetime of a token: 90 days, in seconds.
const LIFETIME_S: u64 = 90 * 24 * 3600;

/// Logs in and saves the token.
pub(super) fn login(raw: &cli::Login, environment: &Environment) -> Result<ExitCode> {
    let server = remote::meet(&raw.server, &raw.access, environment)?;
    let user = match &raw.user {
        Some(user) => user.clone(),
        None if io::stdin().is_terminal() => asked("user: ")?,
        None => return Err(Usage("name the user with --user".to_owned()).into()),
    };
    let password = password(&user)?;
    let computer = rustix::system::uname().nodename().to_string_lossy().into_owned();
    let token = NewToken {
        name: format!("rafcon on {computer}"),
        lifetime_s: Some(LIFETIME_S),
        role: None,
    };
    let made = server.log_in(&Login { user: user.clone(), password }, &token)?;
    remote::notebook(environment)?.keep_token(&server.address, &made.token)?;
    writeln!(io::stdout(), "{user} is logged in to {} from this computer", server.address)?;
    Ok(ExitCode::SUCCESS)
}

/// A password: one line from a pipe, or typed on a terminal without echo.
pub(super) fn password(user: &str) -> Result<String> {
    let quiet = EchoOff::new();
    let password = if io::stdin().is_terminal() {
        let password = asked(&format!("password of {user}: "));
        writeln!(io::stderr())?;
        password
    } else {
        line()
    };
    drop(quiet);
    password
}

fn asked(what: &str) -> Result<String> {
    write!(io::stderr(), "{what}")?;
    line()
}

fn line() -> Result<String> {
    let mut line = String::new();
    io::stdin().read_line(&mut line).context("cannot read the answer")?;
    Ok(line.trim_end_matches(['\n', '\r']).to_owned())
}

/// Switches the echo of a terminal off, until dropped.
struct EchoOff(Option<Termios>);

impl EchoOff {
    fn new() -> Self {
        let before = tcgetattr(io::stdin()).ok();
        if let Some(before) = &before {
            let mut modes = before.clone();
            modes.local_modes -= LocalModes::ECHO;
            tcsetattr(io::stdin(), OptionalActions::Flush, &modes).unwrap_or_default();
        }
        Self(before)
    }
}

impl Drop for EchoOff {
    fn drop(&mut self) {
        if let Some(before) = &self.0 {
            tcsetattr(io::stdin(), OptionalActions::Flush, before).unwrap_or_default();
        }
    }
}
