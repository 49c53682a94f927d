//! Libraries: machines that other machines use. Knows their roots, finds and reads each of them once.
//! Must never know who uses them.

mod lookup;
mod roots;
mod tree;

pub use lookup::Libraries;
pub(crate) use lookup::{Loading, ReadLibrary};
pub use roots::{Root, RootNote, roots};
pub use tree::{Entry, EntryKind};

#[cfg(test)]
mod tests;
