//! Machines as a run keeps them: every file of the machine and of the libraries that it uses, by the hash of its content, so
//! that a machine with one edit costs one edit.
//!
//! Knows machines and bytes. Must never know a run.

mod manifest;
mod packer;
mod store;
#[cfg(test)]
mod tests;
mod unpack;

pub use manifest::{Hash, Manifest};
pub use packer::{Pack, Packer};
pub(super) use store::Roots;
pub use unpack::{Unpacked, unpack};
