//! The commands that serve machines and runs, and that manage users.

use super::{Libraries, Link, Python, Runs};
use clap::{Args, Subcommand, ValueEnum};
use rafcon_server::settings::BasePath;
use std::net::{IpAddr, Ipv6Addr, SocketAddr};
use std::path::PathBuf;

/// Serve projects and runs to browsers, programs and other computers.
///
/// Prints the address that lets you in. Runs continue when the server ends, and the next server finds them.
#[derive(Debug, Args)]
pub(crate) struct Serve {
    /// Folders with machines; clients can read and write no others
    #[arg(value_name = "DIR")]
    pub(crate) projects: Vec<PathBuf>,
    /// Address to listen at; every address except loopback requires TLS and users
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:4747")]
    pub(crate) bind: SocketAddr,
    /// Name of this computer in the network, without a port: it counts with every port (repeat for more)
    #[arg(long = "host", value_name = "NAME", value_parser = host)]
    pub(crate) hosts: Vec<String>,
    /// Address of a reverse proxy whose `X-Forwarded` headers count (repeat for more)
    #[arg(long = "trusted-proxy", value_name = "ADDRESS")]
    pub(crate) proxies: Vec<IpAddr>,
    /// Path below which a reverse proxy offers the server, such as `/robot`
    #[arg(long, value_name = "PATH", value_parser = base_path, default_value = "/")]
    pub(crate) base_path: BasePath,
    /// Certificate for TLS, as a PEM file; without it, the server makes one
    #[arg(long, value_name = "FILE", requires = "key")]
    pub(crate) certificate: Option<PathBuf>,
    /// Key of the certificate, as a PEM file
    #[arg(long, value_name = "FILE", requires = "certificate")]
    pub(crate) key: Option<PathBuf>,
    /// Keep the token of the last start, so that old addresses still work
    #[arg(long)]
    pub(crate) keep_token: bool,
    /// Offer the machines to ROS 2: as the action `run_machine`, and each that declares one as an action of its own; with services and
    /// topics for the runs, all below this namespace (default: `/rafcon`)
    #[arg(long, value_name = "NAMESPACE", num_args = 0..=1, require_equals = true, default_missing_value = "/rafcon")]
    pub(crate) ros: Option<String>,
    /// The frame in which rviz shows the runs, 1 m above its origin
    #[arg(long, value_name = "FRAME", default_value = "base_link", requires = "ros")]
    pub(crate) ros_frame: String,
    #[command(flatten)]
    pub(crate) link: Link,
    #[command(flatten)]
    pub(crate) state: State,
    #[command(flatten)]
    pub(crate) runs: Runs,
    #[command(flatten)]
    pub(crate) libraries: Libraries,
    #[command(flatten)]
    pub(crate) python: Python,
}

/// A name or an address, without scheme and port.
fn host(text: &str) -> Result<String, &'static str> {
    let plain = text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')).unwrap_or(text);
    if plain.parse::<Ipv6Addr>().is_err() && plain.contains([':', '/', '[', ']', ' ']) {
        return Err(
            "write the name only, without scheme, port and path: it counts with every port",
        );
    }
    Ok(plain.to_owned())
}

fn base_path(text: &str) -> Result<BasePath, &'static str> {
    BasePath::parse(text)
        .ok_or("write a path of letters, digits, `-`, `_`, `.` and `~`, such as /robot")
}

/// The server's own folder.
#[derive(Debug, Args)]
pub(crate) struct State {
    /// The server's own folder (users, token, certificate); the default is `rafcon/server` in the user's folder for
    /// program state
    #[arg(long = "state", value_name = "DIR", env = "RAFCON_STATE", global = true)]
    pub(crate) folder: Option<PathBuf>,
}

/// Manage the users of the server.
///
/// Works whether or not the server runs; changes apply at once.
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
    /// Add a user; asks for the password, or reads it from a pipe
    Add {
        /// Name of the user: letters, digits, `.`, `-`, `_`
        name: String,
        /// Role of the user
        #[arg(long, value_enum)]
        role: Role,
    },
    /// List the users
    List,
    /// Remove a user and all their tokens
    Remove {
        /// Name of the user
        name: String,
    },
    /// Change the role of a user
    Role {
        /// Name of the user
        name: String,
        /// New role of the user
        #[arg(value_enum)]
        role: Role,
    },
    /// Change a password, which ends the user's logins; asks for it, or reads it from a pipe
    Password {
        /// Name of the user
        name: String,
    },
    /// Make a token for a program, and print it once
    Token {
        /// User that the program acts for; `owner` is yourself
        name: String,
        /// Purpose of the token
        #[arg(long = "for", value_name = "TEXT")]
        purpose: String,
        /// Role of the token, if it is lower than the user's
        #[arg(long, value_enum)]
        role: Option<Role>,
        /// Number of days until the token expires; without it, the token never expires
        #[arg(long)]
        days: Option<u64>,
    },
}

/// Rights of a user.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Role {
    /// Only watches
    Viewer,
    /// Also starts and commands runs
    Operator,
    /// Also changes machines and scripts
    Engineer,
    /// Also manages users and deletes runs
    Admin,
}
