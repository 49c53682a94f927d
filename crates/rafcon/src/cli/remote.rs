//! The words by which commands are carried out at a server, and of those that only make sense there.

use super::State;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Where a command is carried out.
#[derive(Debug, Args)]
pub(crate) struct Remote {
    /// Do it at the server with this address (`rafcon serve`), such as `https://rover:4747`
    #[arg(long, value_name = "URL", help_heading = "At a server")]
    pub(crate) server: Option<String>,
    #[command(flatten)]
    pub(crate) access: Access,
}

/// Which server has kept a run. The server's own folder has another name than elsewhere, where `--state` means something else.
#[derive(Debug, Args)]
pub(crate) struct KeptRemote {
    /// Read the run at the server with this address (`rafcon serve`), such as `https://rover:4747`
    #[arg(long, value_name = "URL", help_heading = "At a server")]
    pub(crate) server: Option<String>,
    /// File with a token that the server knows; else `RAFCON_TOKEN`, else what `rafcon login` has kept, else that of this
    /// computer's own server
    #[arg(long, value_name = "FILE", help_heading = "At a server")]
    pub(crate) token_file: Option<PathBuf>,
    /// Fingerprint of the server's certificate, as `rafcon serve` prints it; it is remembered
    #[arg(long, value_name = "HEX", help_heading = "At a server")]
    pub(crate) fingerprint: Option<String>,
    /// The folder of this computer's own server; else `rafcon/server` in the user's folder for program state
    #[arg(long, value_name = "DIR", env = "RAFCON_STATE", help_heading = "At a server")]
    pub(crate) server_state: Option<PathBuf>,
}

/// How one is let in, and by whom.
#[derive(Debug, Args)]
pub(crate) struct Access {
    /// File with a token that the server knows; else `RAFCON_TOKEN`, else what `rafcon login` has kept, else that of this
    /// computer's own server
    #[arg(long, value_name = "FILE", help_heading = "At a server")]
    pub(crate) token_file: Option<PathBuf>,
    /// Fingerprint of the server's certificate, as `rafcon serve` prints it; it is remembered
    #[arg(long, value_name = "HEX", help_heading = "At a server")]
    pub(crate) fingerprint: Option<String>,
    #[command(flatten)]
    pub(crate) state: State,
}

/// Get a token from a server for this user and computer.
///
/// Asks for the password without showing it; if the input is no terminal, its first line is the password.
/// The token is kept for this user only, and used by every command with `--server`.
#[derive(Debug, Args)]
pub(crate) struct Login {
    /// Address of the server, such as `https://rover:4747`
    #[arg(long, value_name = "URL")]
    pub(crate) server: String,
    /// Who logs in; else it is asked
    #[arg(long, value_name = "NAME")]
    pub(crate) user: Option<String>,
    #[command(flatten)]
    pub(crate) access: Access,
}

/// Say who commands a run: ask for control, give it, take it.
///
/// One user at a time commands a run; stop and pause are everybody's who may command at all.
#[derive(Debug, Args)]
pub(crate) struct Control {
    /// The run: its id, the beginning of it, or `last`
    pub(crate) run: String,
    /// What is wanted
    #[arg(value_enum, default_value_t = Wanted::Show)]
    pub(crate) wanted: Wanted,
    /// To whom it is handed over
    #[arg(value_name = "USER", required_if_eq("wanted", "hand-over"))]
    pub(crate) user: Option<String>,
    /// Address of the server, such as `https://rover:4747`
    #[arg(long, value_name = "URL")]
    pub(crate) server: String,
    #[command(flatten)]
    pub(crate) access: Access,
}

/// What is wanted about control.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Wanted {
    /// Who holds it, and who asks for it
    Show,
    /// Ask for it; it is given at once if nobody holds it
    Request,
    /// Take back the own request, or, as its holder, the offer
    Withdraw,
    /// Hold it no more
    Release,
    /// Take it from a holder who has not been heard for a while
    TakeOver,
    /// Give it to USER: at once if they requested it, else when they accept
    HandOver,
    /// Accept the holder's offer
    Accept,
    /// Decline the holder's offer
    Decline,
    /// Take it from any holder at once; for admins, and on record
    Override,
}
