//! `rafcon user`: who may log in to the server. Knows how a password is asked for; users and tokens, `rafcon-server` knows.

use super::serve;
use crate::cli::{self, UserAction};
use crate::environment::Environment;
use anyhow::{Context as _, Result, bail};
use rafcon_protocol::api::{NewToken, Role};
use rafcon_server::access::{OWNER, Users};
use rafcon_server::settings::HashCost;
use rustix::termios::{LocalModes, OptionalActions, Termios, tcgetattr, tcsetattr};
use std::io::{self, BufRead as _, IsTerminal as _, Write as _};
use std::process::ExitCode;

/// Does what was asked about users.
pub(super) fn user(raw: &cli::User, environment: &Environment) -> Result<ExitCode> {
    let users = Users::open(&serve::state(&raw.state, environment)?, HashCost::USUAL)?;
    match &raw.action {
        UserAction::Add { name, role } => users.add(name, of(*role), &password(name)?)?,
        UserAction::List => list(&users)?,
        UserAction::Remove { name } => users.remove(name)?,
        UserAction::Role { name, role } => users.change(name, Some(of(*role)), None)?,
        UserAction::Password { name } => users.change(name, None, Some(&password(name)?))?,
        UserAction::Token { name, purpose, role, days } => {
            let lifetime_s = days.map(|days| days.saturating_mul(86_400));
            let wanted = NewToken { name: purpose.clone(), lifetime_s, role: role.map(of) };
            let made = users.make_token(name, most(&users, name)?, &wanted)?;
            writeln!(io::stdout(), "{}", made.token)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn list(users: &Users) -> Result<()> {
    let line = |user: rafcon_protocol::api::User| format!("{}  {}\n", user.name, word(user.role));
    let lines = users.roster().users().into_iter().map(line).collect::<String>();
    Ok(io::stdout().write_all(lines.as_bytes())?)
}

/// What a user's token may do at most.
fn most(users: &Users, name: &str) -> Result<Role> {
    if name == OWNER {
        return Ok(Role::Admin);
    }
    let user = users.roster().users().into_iter().find(|user| user.name == name);
    user.map(|user| user.role)
        .with_context(|| format!("there is no user {name}: `rafcon user list` names them"))
}

fn of(role: cli::Role) -> Role {
    match role {
        cli::Role::Viewer => Role::Viewer,
        cli::Role::Operator => Role::Operator,
        cli::Role::Engineer => Role::Engineer,
        cli::Role::Admin => Role::Admin,
    }
}

fn word(role: Role) -> &'static str {
    match role {
        Role::Viewer => "viewer",
        Role::Operator => "operator",
        Role::Engineer => "engineer",
        Role::Admin => "admin",
    }
}

/// A password: one line of a pipe, or typed twice on a terminal that does not show it.
fn password(name: &str) -> Result<String> {
    if !io::stdin().is_terminal() {
        return line();
    }
    let hidden = Hidden::new()?;
    let password = asked(&format!("Password for {name}: "))?;
    let again = asked("The same again: ")?;
    drop(hidden);
    if password != again {
        bail!("the two passwords are not the same: try again");
    }
    Ok(password)
}

fn asked(question: &str) -> Result<String> {
    io::stderr().write_all(question.as_bytes())?;
    let line = line();
    io::stderr().write_all(b"\n")?;
    line
}

fn line() -> Result<String> {
    let mut text = String::new();
    io::stdin().lock().read_line(&mut text).context("cannot read the password")?;
    Ok(text.trim_end_matches(['\n', '\r']).to_owned())
}

/// A terminal that shows nothing of what is typed, until dropped.
struct Hidden(Termios);

impl Hidden {
    fn new() -> Result<Self> {
        let before = tcgetattr(io::stdin())?;
        let mut modes = before.clone();
        modes.local_modes.remove(LocalModes::ECHO);
        tcsetattr(io::stdin(), OptionalActions::Flush, &modes)?;
        Ok(Self(before))
    }
}

impl Drop for Hidden {
    fn drop(&mut self) {
        tcsetattr(io::stdin(), OptionalActions::Flush, &self.0).unwrap_or_default();
    }
}
