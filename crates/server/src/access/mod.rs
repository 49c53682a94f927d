//! Who may do what. Knows people, rights and doors; must never know machines or runs.

mod audit;
mod door;
mod failures;
mod familiar;
mod layers;
mod limiter;
mod notice;
mod origin;
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
pub(crate) use door::in_link;
pub(crate) use layers::guarded;
pub(crate) use limiter::network;
pub(crate) use notice::notice;
pub(crate) use origin::Names;
pub use passwords::HashError;
pub use people::{OWNER, People};
pub use private::PrivateError;
pub use rights::{ROUTES, Row, of_command, of_frame, of_route, of_start};
pub use roster::{Roster, RosterError};
pub(crate) use routes::{about, routes};
pub(crate) use secret::hex;
pub use users::{Users, UsersError};
pub use who::{Credential, Who};
