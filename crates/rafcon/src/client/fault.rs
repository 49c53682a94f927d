//! Errors of operations at a server. Knows which operations can be retried.

use super::Fingerprint;
use rafcon_protocol::api::Refusal;
use std::fmt;
use std::io;
use std::path::PathBuf;

/// Cause of a failed operation.
#[derive(Debug)]
pub(crate) enum Fault {
    /// The server cannot be reached, or the connection could not be completed.
    Unreachable {
        server: String,
        /// Underlying error of the connection.
        source: io::Error,
    },
    /// The connection broke during the exchange: the request may have arrived.
    Lost {
        server: String,
        /// Underlying error of the connection.
        source: io::Error,
    },
    /// The certificate differs from the saved or named one.
    Changed {
        server: String,
        /// Saved earlier or named by the user.
        known: Fingerprint,
        /// The certificate of the server.
        seen: Fingerprint,
    },
    /// The certificate is unknown, and no one has vouched for it.
    Unknown {
        server: String,
        /// The certificate of the server.
        seen: Fingerprint,
    },
    /// The file with the token cannot be read.
    NoToken {
        /// Path of the file.
        file: PathBuf,
        source: io::Error,
    },
    /// The server refused the request.
    Refused {
        /// Status code of the HTTP response.
        status: u16,
        /// Code and message of the server.
        refusal: Refusal,
    },
    /// The response is not valid here.
    Nonsense {
        server: String,
        /// Description of the problem.
        what: String,
    },
}

impl Fault {
    /// True if a retry may succeed: the cause is the connection or the load, not the request.
    pub(crate) fn is_passing(&self) -> bool {
        match self {
            Self::Unreachable { .. } | Self::Lost { .. } | Self::NoToken { .. } => true,
            Self::Refused { status, .. } => matches!(status, 429 | 502 | 503 | 504),
            Self::Changed { .. } | Self::Unknown { .. } | Self::Nonsense { .. } => false,
        }
    }

    /// True if the server may have executed the request.
    pub(crate) fn may_have_arrived(&self) -> bool {
        match self {
            Self::Lost { .. } => true,
            Self::Refused { refusal, .. } => {
                matches!(&*refusal.code, "not_finished" | "fate_unknown")
            }
            _ => false,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreachable { server, .. } => {
                write!(f, "cannot reach the server at {server}: is `rafcon serve` running there?")
            }
            Self::Lost { server, .. } => {
                write!(f, "the connection to the server at {server} is lost")
            }
            Self::NoToken { file, .. } => write!(f, "cannot read the token in {}", file.display()),
            Self::Changed { server, known, seen } => write!(
                f,
                "THE CERTIFICATE OF {server} HAS CHANGED: another computer may be listening in. Nothing was sent.\n  \
                 expected: {known}\n  received: {seen}\n\
                 If the server's administrator confirms the new one, accept it once with --fingerprint {}",
                seen.hex()
            ),
            Self::Unknown { server, seen } => write!(
                f,
                "this computer does not know the server at {server} yet; its certificate has the fingerprint\n  {seen}\n\
                 Compare it with the one that `rafcon serve` printed, and accept it once with --fingerprint {}",
                seen.hex()
            ),
            Self::Refused { status: 401, refusal } => write!(
                f,
                "{} (`rafcon login --server URL` gets a token; --token-file and RAFCON_TOKEN name one)",
                refusal.message
            ),
            Self::Refused { refusal, .. } => f.write_str(&refusal.message),
            Self::Nonsense { server, what } => {
                write!(f, "cannot understand the answer of the server at {server}: {what}")
            }
        }
    }
}

impl std::error::Error for Fault {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Unreachable { source, .. }
            | Self::Lost { source, .. }
            | Self::NoToken { source, .. } => Some(source),
            _ => None,
        }
    }
}
