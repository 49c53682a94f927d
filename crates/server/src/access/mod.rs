//! Who may do what. Knows people, rights and doors; must never know machines or runs.

mod rights;
mod who;

pub use rights::{ROUTES, Row, of_command, of_route};
pub use who::Who;
