//! Machines for clients: a list of states by path, suited to maps and to small changes (see "on the wire" in `docs/edits.md`).
//! Defines the data types and their conversion, not the requests or the transport.
//!
//! Documents do not contain the content of libraries. A library is a machine of its own, and is sent once even if it is used in
//! fifty states.
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
