//! What the errors of this part are called in answers.

use super::private::PrivateError;
use super::roster::RosterError;
use super::users::UsersError;
use crate::Failure;
use axum::http::StatusCode;

impl From<PrivateError> for Failure {
    fn from(error: PrivateError) -> Self {
        Self::new(StatusCode::SERVICE_UNAVAILABLE, "disk", error.to_string())
    }
}

impl From<UsersError> for Failure {
    fn from(error: UsersError) -> Self {
        let message = error.to_string();
        match error {
            UsersError::Roster(error) => roster(&error, message),
            UsersError::Private(error) => error.into(),
            UsersError::Hash(_) => Self::new(StatusCode::SERVICE_UNAVAILABLE, "no_secret", message),
            UsersError::BadPassword => Self::bad("bad_password", message),
            UsersError::BadTokenName => Self::bad("bad_token_name", message),
        }
    }
}

fn roster(error: &RosterError, message: String) -> Failure {
    match error {
        RosterError::BadName(_) => Failure::bad("bad_name", message),
        RosterError::Taken(_) => Failure::conflict("user_exists", message),
        RosterError::NoUser(_) => Failure::not_found("no_such_user", message),
        RosterError::LastAdmin(_) => Failure::conflict("last_admin", message),
        RosterError::NoToken => Failure::not_found("no_such_token", message),
        RosterError::TooMuch => Failure::forbidden("not_your_right", message),
        RosterError::TooMany(_) => Failure::conflict("too_many_tokens", message),
    }
}
