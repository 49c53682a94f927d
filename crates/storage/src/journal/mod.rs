//! The journal of a run: everything that happened in it, in order, in a folder of its own (`docs/journal.md`).
//!
//! Knows how events are kept and found again. Must never know what makes them happen.

mod binary;
pub mod record;

pub use binary::Broken;
pub use record::{Definition, Item, Kept, Place, PlaceNumber, Record, Stored, ValueNumber};
