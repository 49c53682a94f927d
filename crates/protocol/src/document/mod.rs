//! Machines as clients see them: a list of states by path, made for maps and for small changes (`docs/edits.md`, on the
//! wire). Knows shapes and their meaning in the model, but not who asks, nor how they travel.
//!
//! The content of libraries is no part of a document: a library is a machine of its own, and one that stands in fifty places
//! travels once.
//!
//! ```
//! use rafcon_testkit::notation;
//! use rafcon_protocol::document::{Document, Mirror, changes};
//!
//! let old = notation::parse("hierarchy ROOT\n  execution A")?;
//! let new = notation::parse("hierarchy ROOT\n  start -> A\n  execution A\n    in x: int")?;
//! let mut mirror = Mirror::new(Document::of(&old));
//! for change in changes(&old, &new) {
//!     mirror.apply(change);
//! }
//! assert_eq!(mirror.document(), Document::of(&new));
//! # Ok::<(), notation::NotationError>(())
//! ```

mod change;
mod layout;
mod machine;
mod mirror;
mod of;
mod read;
#[cfg(test)]
pub(crate) mod tests;
mod value;

pub use change::{Change, changes};
pub use layout::LayoutDocument;
pub use machine::{
    DataFlowDocument, Document, HeaderDocument, LibraryDocument, OutcomeDocument, PortDocument,
    RuntimeValueDocument, Selection, StateDocument, StateKind, TransitionDocument,
};
pub use mirror::Mirror;
pub use of::states_of;
pub(crate) use of::{state_documents, type_name};
pub(crate) use read::state_tree;
pub use read::{DocumentError, OnLibrary, leave};
pub(crate) use value::{
    decode as read_value, decode_json as read_json, encode as value_of, encode_json as json_of,
};
