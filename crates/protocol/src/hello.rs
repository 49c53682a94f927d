//! The first line of every connection.

use serde::{Deserialize, Serialize};

/// Version of the protocol. Both sides must have an equal version: binary and extension are built together.
pub const VERSION: u32 = 3;

/// Identification of a side of the connection.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// [`VERSION`] of the sender.
    pub protocol: u32,
    /// Version of the program, for error messages.
    pub program: String,
}

impl Hello {
    /// Returns the hello of this build.
    pub fn ours() -> Self {
        Self { protocol: VERSION, program: env!("CARGO_PKG_VERSION").to_owned() }
    }

    /// Checks that both sides have an equal protocol version. The error contains the remedy.
    pub fn check(&self) -> Result<(), VersionMismatch> {
        if self.protocol == VERSION {
            return Ok(());
        }
        Err(VersionMismatch { theirs: self.protocol, program: self.program.clone() })
    }
}

/// The other side has another protocol version.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the other side (version {program}) speaks protocol {theirs}, this one speaks {VERSION}: \
     install the rafcon binary and its extension from the same build"
)]
pub struct VersionMismatch {
    theirs: u32,
    program: String,
}
