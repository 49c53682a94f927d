//! Machines as text, read: the other half of [`rafcon_model::notation`], which prints them. Knows the syntax of
//! `docs/notation.md`; never files.

mod block;
mod connect;
mod draft;
mod parse;
mod scan;

pub use parse::{NotationError, parse};
pub use rafcon_model::notation::{Shown, print, print_with};

#[cfg(test)]
mod tests;
