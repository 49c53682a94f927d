//! The options for commands at a server, and the commands that exist only there.

use super::{Output, State};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// The server that carries out a command.
#[derive(Debug, Args)]
pub(crate) struct Remote {
    /// Use the server at this address (`rafcon serve`), such as `https://rover:4747`
    #[arg(long, value_name = "URL", help_heading = "At a server")]
    pub(crate) server: Option<String>,
    #[command(flatten)]
    pub(crate) access: Access,
}

/// The server that has a recorded run. `--server-state` stands for `--state`, which means a state of the machine here.
#[derive(Debug, Args)]
pub(crate) struct KeptRemote {
    /// Read the run from the server at this address (`rafcon serve`), such as `https://rover:4747`
    #[arg(long, value_name = "URL", help_heading = "At a server")]
    pub(crate) server: Option<String>,
    /// File with a token for the server; the default is `RAFCON_TOKEN`, then the token that `rafcon login` saved, then the
    /// token of this computer's own server
    #[arg(long, value_name = "FILE", help_heading = "At a server")]
    pub(crate) token_file: Option<PathBuf>,
    /// Fingerprint of the server's certificate, as `rafcon serve` prints it; it is saved
    #[arg(long, value_name = "HEX", help_heading = "At a server")]
    pub(crate) fingerprint: Option<String>,
    /// Folder of this computer's own server; the default is `rafcon/server` in the user's folder for program state
    #[arg(long, value_name = "DIR", env = "RAFCON_STATE", help_heading = "At a server")]
    pub(crate) server_state: Option<PathBuf>,
}

/// How the server recognises the user, and the user the server.
#[derive(Debug, Args)]
pub(crate) struct Access {
    /// File with a token for the server; the default is `RAFCON_TOKEN`, then the token that `rafcon login` saved, then the
    /// token of this computer's own server
    #[arg(long, value_name = "FILE", help_heading = "At a server")]
    pub(crate) token_file: Option<PathBuf>,
    /// Fingerprint of the server's certificate, as `rafcon serve` prints it; it is saved
    #[arg(long, value_name = "HEX", help_heading = "At a server")]
    pub(crate) fingerprint: Option<String>,
    #[command(flatten)]
    pub(crate) state: State,
}

/// Get a token from a server for this user and computer.
///
/// Asks for the password without showing it; without a terminal, the first line of the input is the password.
/// The token is saved for this user only, and every command with `--server` uses it.
#[derive(Debug, Args)]
pub(crate) struct Login {
    /// Address of the server, such as `https://rover:4747`
    #[arg(long, value_name = "URL")]
    pub(crate) server: String,
    /// Name of the user; without it, the command asks for the name
    #[arg(long, value_name = "NAME")]
    pub(crate) user: Option<String>,
    #[command(flatten)]
    pub(crate) access: Access,
}

/// Show, request, hand over or take control of a run.
///
/// One user at a time is in control of a run. Every user who may command runs can stop and pause it.
#[derive(Debug, Args)]
pub(crate) struct Control {
    /// The run: its id or the start of the id, or `last`
    pub(crate) run: String,
    /// What to do
    #[arg(value_enum, default_value_t = Wanted::Show)]
    pub(crate) wanted: Wanted,
    /// User to hand control over to
    #[arg(value_name = "USER", required_if_eq("wanted", "hand-over"))]
    pub(crate) user: Option<String>,
    /// Address of the server, such as `https://rover:4747`
    #[arg(long, value_name = "URL")]
    pub(crate) server: String,
    #[command(flatten)]
    pub(crate) access: Access,
}

/// Start another run with the inputs and settings of an earlier one.
///
/// The server that has the run starts its machine as it is on disk now, and this prints the id of the new run. A station asks the
/// robot of the run; what the robot sends of the new run arrives after the delay of the link.
#[derive(Debug, Args)]
pub(crate) struct Again {
    /// The run before: its id or the start of the id, or `last`
    pub(crate) run: String,
    /// Repeat the request with this id, whose answer did not come, instead of making another
    #[arg(long, value_name = "ID")]
    pub(crate) request: Option<String>,
    /// Format of the standard output
    #[arg(long, value_enum, default_value_t = Output::Text)]
    pub(crate) output: Output,
    /// Address of the server or station, such as `https://ground:4747`
    #[arg(long, value_name = "URL")]
    pub(crate) server: String,
    #[command(flatten)]
    pub(crate) access: Access,
}

/// Fetch a large value of a robot's run to its station.
///
/// Events bring what can be shown of a value; a large one stays on the robot until someone needs its bytes. Without NAME, this lists the
/// large values of the event, and what each costs on the link. A value comes when nothing else needs the link, and goes on after
/// blackouts and restarts, whether or not this program waits.
#[derive(Debug, Args)]
pub(crate) struct Fetch {
    /// The run: its id or the start of the id, or `last`
    pub(crate) run: String,
    /// Number of the event that has the value
    pub(crate) event: u64,
    /// The port or variable
    #[arg(value_name = "NAME")]
    pub(crate) name: Option<String>,
    /// Send at most so many bytes of it, those lost on the way included; usually a quarter more than it has
    #[arg(long, value_name = "BYTES", requires = "name")]
    pub(crate) budget: Option<u64>,
    /// Do not wait until it is here
    #[arg(long, requires = "name")]
    pub(crate) no_wait: bool,
    /// Give the value up instead
    #[arg(long, requires = "name", conflicts_with_all = ["budget", "no_wait"])]
    pub(crate) cancel: bool,
    /// Address of the station, such as `https://ground:4747`
    #[arg(long, value_name = "URL")]
    pub(crate) server: String,
    #[command(flatten)]
    pub(crate) access: Access,
}

/// Request about control.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Wanted {
    /// Show who is in control, and who requests it
    Show,
    /// Request control; it is granted at once if no user is in control
    Request,
    /// Withdraw your request, or the offer that you made
    Withdraw,
    /// Give up control
    Release,
    /// Take control from a user who has been silent for a while
    TakeOver,
    /// Hand control over to USER: at once if they requested it, otherwise when they accept
    HandOver,
    /// Accept an offer of control
    Accept,
    /// Decline an offer of control
    Decline,
    /// Take control from any user at once; for admins, and recorded in the run's history
    Override,
}
