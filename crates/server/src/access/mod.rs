//! Who may do what. Knows people, rights and doors; must never know machines or runs.

mod door;
mod layers;
mod origin;
mod people;
pub(crate) mod private;
mod rights;
mod secret;
mod who;

pub(crate) use layers::guarded;
pub(crate) use origin::Names;
pub use people::{OWNER, People};
pub use private::PrivateError;
pub use rights::{ROUTES, Row, of_command, of_frame, of_route};
pub use who::{Credential, Who};
