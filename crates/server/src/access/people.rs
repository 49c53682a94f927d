//! Who is let in: the owner of this computer's account, users with passwords, and programs with tokens.

use super::private::{self, PrivateError};
use super::secret::{Digest, Secret};
use super::who::{Credential, Who};
use crate::Settings;
use rafcon_protocol::api::Role;
use std::path::Path;

/// The name of whoever has the owner's token.
pub const OWNER: &str = "owner";

/// What somebody shows to be let in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Claim {
    /// A token: the owner's or a program's.
    Token(String),
    /// The cookie of a login.
    Cookie(String),
}

/// Everybody who may come in.
#[derive(Debug)]
pub struct People {
    owner: Secret,
}

impl People {
    /// Reads who they are, and makes the owner's token.
    pub(crate) fn open(settings: &Settings) -> Result<Self, PrivateError> {
        let owner = owners_token(&settings.state, settings.access.keep_token)?;
        Ok(Self { owner })
    }

    /// The owner's token.
    pub(crate) fn owner(&self) -> &Secret {
        &self.owner
    }

    /// Who shows this. The owner's token counts on this computer only.
    pub(crate) fn known(&self, claim: &Claim, is_near: bool) -> Option<Who> {
        match claim {
            Claim::Token(text) if is_near && Digest::of(text) == self.owner.digest() => {
                Some(owner())
            }
            Claim::Token(_) | Claim::Cookie(_) => None,
        }
    }
}

fn owner() -> Who {
    let user = OWNER.to_owned();
    Who { user, role: Role::Admin, expires_ms: None, by: Credential::Owner }
}

/// The token in the folder if it is to stay, else a new one.
fn owners_token(state: &Path, keep: bool) -> Result<Secret, PrivateError> {
    let file = state.join("token");
    let kept = if keep { private::read(&file)? } else { None };
    if let Some(secret) = kept.as_deref().and_then(Secret::read) {
        return Ok(secret);
    }
    let secret = Secret::new().map_err(|source| PrivateError::new("make", &file, source))?;
    private::write(&file, secret.text().as_bytes())?;
    Ok(secret)
}
