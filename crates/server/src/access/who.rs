//! The authenticated sender of a request.

use crate::Failure;
use axum::extract::{FromRequestParts, OptionalFromRequestParts};
use axum::http::request::Parts;
use rafcon_protocol::api::{Right, Role};

/// An authenticated user. Handlers receive it as an argument.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Who {
    /// The user's name, recorded as the author of their actions.
    pub user: String,
    /// Role of the user, limited to that of the credential.
    pub role: Role,
    /// Expiry of the credential: ms since 1970, UTC.
    pub expires_ms: Option<u64>,
    /// Credential of the request.
    pub by: Credential,
}

/// Identifies a credential. It contains no secret.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Credential {
    /// The token of the owner.
    Owner,
    /// The token of the bridge to ROS 2.
    Ros,
    /// A login, by the digest of its secret.
    Session(String),
    /// A token for a program, by its id.
    Token(String),
}

impl Who {
    /// Refuses a user who lacks a right.
    pub fn must(&self, right: Right) -> Result<(), Failure> {
        if self.role.grants(right) {
            return Ok(());
        }
        let (role, right) = (format!("{:?}", self.role), format!("{right:?}"));
        let message = format!(
            "{} is {} here, and this needs the right to {}: ask an admin for another role",
            self.user,
            role.to_lowercase(),
            right.to_lowercase()
        );
        Err(Failure::forbidden("not_your_right", message))
    }
}

impl<S: Sync> FromRequestParts<S> for Who {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, Failure> {
        parts.extensions.get::<Self>().cloned().ok_or_else(nobody)
    }
}

impl<S: Sync> OptionalFromRequestParts<S> for Who {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Option<Self>, Failure> {
        Ok(parts.extensions.get::<Self>().cloned())
    }
}

/// The refusal of a request without a credential.
pub(crate) fn nobody() -> Failure {
    let message = "nobody is logged in: send a token, or log in at /api/v1/session";
    let failure = Failure::unauthorized("not_logged_in", message);
    failure.asking_for_token()
}
