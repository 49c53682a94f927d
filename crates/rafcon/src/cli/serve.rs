//! The words of the commands that serve, and that manage who may come in.

use super::{Libraries, Python, Runs};
use clap::Args;
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
    #[arg(long = "state", value_name = "DIR", env = "RAFCON_STATE")]
    pub(crate) folder: Option<PathBuf>,
}
