//! The words of the commands that serve, and that manage who may come in.

use super::{Libraries, Python, Runs};
use clap::{Args, Subcommand, ValueEnum};
use std::net::SocketAddr;
use std::path::PathBuf;

/// Serve projects and runs to browsers, programs and other computers.
///
/// Prints the address that lets you in. Runs go on when the server ends, and the next one finds them.
#[derive(Debug, Args)]
pub(crate) struct Serve {
    /// Folders with machines: the only ones that clients may read and write
    #[arg(value_name = "DIR")]
    pub(crate) projects: Vec<PathBuf>,
    /// Where it listens; any address but a loopback's needs TLS and users
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:4747")]
    pub(crate) bind: SocketAddr,
    /// Name by which others call this computer (repeat for more)
    #[arg(long = "host", value_name = "NAME")]
    pub(crate) hosts: Vec<String>,
    /// Certificate for TLS, as a PEM file; else the server makes one
    #[arg(long, value_name = "FILE", requires = "key")]
    pub(crate) certificate: Option<PathBuf>,
    /// The certificate's key, as a PEM file
    #[arg(long, value_name = "FILE", requires = "certificate")]
    pub(crate) key: Option<PathBuf>,
    /// Keep the token of the last start, so that old addresses still let you in
    #[arg(long)]
    pub(crate) keep_token: bool,
    #[command(flatten)]
    pub(crate) state: State,
    #[command(flatten)]
    pub(crate) runs: Runs,
    #[command(flatten)]
    pub(crate) libraries: Libraries,
    #[command(flatten)]
    pub(crate) python: Python,
}

/// Where the server keeps what is its own.
#[derive(Debug, Args)]
pub(crate) struct State {
    /// The server's own folder (users, token, certificate); else `rafcon/server` in the user's folder for program state
    #[arg(long = "state", value_name = "DIR", env = "RAFCON_STATE", global = true)]
    pub(crate) folder: Option<PathBuf>,
}

/// Manage who may log in to the server.
///
/// Works whether the server runs or not; what changes counts at once.
#[derive(Debug, Args)]
pub(crate) struct User {
    #[command(subcommand)]
    pub(crate) action: UserAction,
    #[command(flatten)]
    pub(crate) state: State,
}

/// What to do about users.
#[derive(Debug, Subcommand)]
pub(crate) enum UserAction {
    /// Add a user; the password is asked for, or read from a pipe
    Add {
        /// Letters, digits, `.`, `-`, `_`
        name: String,
        /// What the user may do
        #[arg(long, value_enum)]
        role: Role,
    },
    /// List the users
    List,
    /// Remove a user and all their tokens
    Remove {
        /// Who
        name: String,
    },
    /// Give a user another role
    Role {
        /// Who
        name: String,
        /// What the user may do from now on
        #[arg(value_enum)]
        role: Role,
    },
    /// Set another password, which ends the user's logins; it is asked for, or read from a pipe
    Password {
        /// Who
        name: String,
    },
    /// Make a token for a program, and print it this once
    Token {
        /// Whom the program stands for; `owner` for yourself
        name: String,
        /// What the token is for
        #[arg(long = "for", value_name = "TEXT")]
        purpose: String,
        /// A lesser role than the user's
        #[arg(long, value_enum)]
        role: Option<Role>,
        /// For how many days it is good; else until it is deleted
        #[arg(long)]
        days: Option<u64>,
    },
}

/// What somebody may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Role {
    /// Looks on
    Viewer,
    /// Also starts and commands runs
    Operator,
    /// Also changes machines and scripts
    Engineer,
    /// Also manages users and deletes runs
    Admin,
}
