//! Users, their rights and the checks of requests. Does not know machines or runs.

use crate::Failure;

mod audit;
mod connection_slots;
mod door;
mod familiar;
mod layers;
mod limiter;
mod notice;
mod origin;
mod outer_address;
mod passwords;
mod people;
pub(crate) mod private;
mod recent_notes;
mod register;
mod rights;
mod roster;
mod routes;
mod secret;
mod sessions;
mod users;
mod who;

pub use audit::Audit;
pub(crate) use connection_slots::{Capacity, ConnectionSlot, ConnectionSlots, Lost, Peer};
pub(crate) use door::in_link;
pub(crate) use layers::guarded;
pub(crate) use notice::notice;
pub(crate) use origin::Names;
pub(crate) use outer_address::{BasePrefix, OuterAddress};
pub use passwords::HashError;
pub use people::{OWNER, People, ROS};
pub use private::PrivateError;
pub use rights::{ROUTES, Row, of_command, of_frame, of_route, of_start};
pub use roster::{Roster, RosterError};
pub(crate) use routes::{about, routes};
pub(crate) use secret::hex;
pub use users::{Users, UsersError};
pub use who::{Credential, Who};

impl From<PrivateError> for Failure {
    fn from(error: PrivateError) -> Self {
        Self::unavailable("disk", error.to_string())
    }
}

impl From<UsersError> for Failure {
    fn from(error: UsersError) -> Self {
        let message = error.to_string();
        match error {
            UsersError::Roster(error) => roster(&error, message),
            UsersError::Private(error) => error.into(),
            UsersError::Hash(_) => Self::unavailable("no_secret", message),
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
