//! Why something could not be done at a server. Knows what can be tried again, and what cannot.

use super::Fingerprint;
use rafcon_protocol::api::Refusal;
use std::fmt;
use std::io;
use std::path::PathBuf;

/// What went wrong.
#[derive(Debug)]
pub(crate) enum Fault {
    /// The server cannot be reached, or went away in the middle.
    Unreachable {
        /// Its address.
        server: String,
        /// Why.
        source: io::Error,
    },
    /// The connection broke in the middle of a talk: what was said may have arrived.
    Lost {
        /// Its address.
        server: String,
        /// Why.
        source: io::Error,
    },
    /// It has another certificate than it had, or than was named.
    Changed {
        /// Its address.
        server: String,
        /// What is expected.
        known: Fingerprint,
        /// What it has.
        seen: Fingerprint,
    },
    /// It has a certificate that no one has vouched for.
    Unknown {
        /// Its address.
        server: String,
        /// What it has.
        seen: Fingerprint,
    },
    /// The file with the token cannot be read.
    NoToken {
        /// Which one.
        file: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// It said no.
    Refused {
        /// HTTP's number for it.
        status: u16,
        /// Its words.
        refusal: Refusal,
    },
    /// It said something that makes no sense here.
    Nonsense {
        /// Its address.
        server: String,
        /// What is wrong with it.
        what: String,
    },
}

impl Fault {
    /// Whether it may go away by itself: the connection is the reason, not the words.
    pub(crate) fn is_passing(&self) -> bool {
        match self {
            Self::Unreachable { .. } | Self::Lost { .. } | Self::NoToken { .. } => true,
            Self::Refused { status, .. } => matches!(status, 429 | 502 | 503 | 504),
            Self::Changed { .. } | Self::Unknown { .. } | Self::Nonsense { .. } => false,
        }
    }

    /// Whether the server may have done what it was asked for.
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
