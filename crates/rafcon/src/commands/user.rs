//! `rafcon user`: the users who may log in to the server. Knows the password prompt; `rafcon-server` knows users and
//! tokens.

use super::{login, serve};
use crate::cli::{self, UserAction};
use crate::environment::Environment;
use anyhow::{Context as _, Result, bail};
use rafcon_protocol::api::{NewToken, Role};
use rafcon_server::access::{OWNER, Users};
use rafcon_server::settings::HashCost;
use std::io::{self, IsTerminal as _, Write as _};
use std::process::ExitCode;

/// Performs the requested action on users.
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

/// The highest role for a token of a user.
fn most(users: &Users, name: &str) -> Result<Role> {
    if name == OWNER {
        return Ok(Role::Admin);
    }
    let user = users.roster().users().into_iter().find(|user| user.name == name);
    user.map(|user| user.role).with_context(|| {
        format!("the user {name} does not exist; `rafcon user list` lists the users")
    })
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

/// A new password; on a terminal it must be typed twice.
fn password(name: &str) -> Result<String> {
    let password = login::password(name)?;
    if io::stdin().is_terminal() && login::password(&format!("{name} again"))? != password {
        bail!("the passwords differ: try again");
    }
    Ok(password)
}
