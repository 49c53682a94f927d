//! Whoever makes a request, once the door has let them in.

use crate::Failure;
use axum::extract::FromRequestParts;
use axum::http::StatusCode;
use axum::http::request::Parts;
use rafcon_protocol::api::{Right, Role};

/// Somebody whom the door knows. A handler that takes one as an argument is told who asks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Who {
    /// The user's name: the author of what they do.
    pub user: String,
    /// What they may do.
    pub role: Role,
    /// When the session ends: ms since 1970, UTC.
    pub expires_ms: Option<u64>,
}

impl Who {
    /// Refuses whoever lacks a right.
    pub fn must(&self, right: Right) -> Result<(), Failure> {
        if self.role.grants(right) {
            return Ok(());
        }
        let message = format!(
            "{} is {:?} here, and this needs the right to {:?}: ask an admin for another role",
            self.user, self.role, right
        );
        Err(Failure::forbidden("not_your_right", message.to_lowercase()))
    }
}

impl<S: Sync> FromRequestParts<S> for Who {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, Failure> {
        parts.extensions.get::<Self>().cloned().ok_or_else(|| {
            let message = "nobody is logged in: send a token, or log in at /api/v1/session";
            Failure::new(StatusCode::UNAUTHORIZED, "not_logged_in", message)
        })
    }
}
