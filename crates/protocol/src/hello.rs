//! The first line of every talk.

use serde::{Deserialize, Serialize};

/// The version of the vocabulary. Both sides must have the same one: binary and extension are built together.
pub const VERSION: u32 = 3;

/// Who speaks.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// [`VERSION`] of the speaker.
    pub protocol: u32,
    /// The program's version, for messages.
    pub program: String,
}

impl Hello {
    /// This build's own hello.
    pub fn ours() -> Self {
        Self { protocol: VERSION, program: env!("CARGO_PKG_VERSION").to_owned() }
    }

    /// Whether both sides speak the same; the error says what to do.
    pub fn check(&self) -> Result<(), VersionMismatch> {
        if self.protocol == VERSION {
            return Ok(());
        }
        Err(VersionMismatch { theirs: self.protocol, program: self.program.clone() })
    }
}

/// The other side speaks another version.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the other side (version {program}) speaks protocol {theirs}, this one speaks {VERSION}: \
     install the rafcon binary and its extension from the same build"
)]
pub struct VersionMismatch {
    theirs: u32,
    program: String,
}
