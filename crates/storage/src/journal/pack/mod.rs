//! Machines as a run keeps them: every file of the machine and of the libraries that it uses, by the hash of its content, so
//! that a machine with one edit costs one edit.
//!
//! Knows machines and bytes. Must never know a run.

mod manifest;
pub(crate) mod packed;
mod packer;
mod store;
#[cfg(test)]
mod tests;

pub use manifest::{Hash, Manifest};
pub use packed::Packed;
pub use packer::{Pack, Packer};
pub(super) use store::Roots;
