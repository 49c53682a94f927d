//! The journal of a run: everything that happened in it, in order, in a folder of its own (`docs/journal.md`).
//!
//! Knows how events are kept and found again. Must never know what makes them happen.

mod about;
mod batch;
mod binary;
mod blank;
mod committer;
mod compare;
mod database;
mod error;
mod export;
mod filter;
pub mod folder;
mod forget;
mod found;
mod frame;
mod group;
#[expect(
    clippy::module_inception,
    reason = "the type that writes journals stands in the file of its name"
)]
mod journal;
mod leftovers;
mod lock;
mod moment;
pub mod notation;
pub(crate) mod pack;
mod places;
mod reader;
pub mod record;
mod recorder;
mod retention;
mod statistics;
pub mod stream;
mod summary;
mod sums;
mod telling;
#[cfg(test)]
mod tests;
mod thin;
mod tracker;
mod values;

pub use about::About;
pub use batch::{Batch, Left};
pub use binary::Broken;
pub use blank::has_begun;
pub use compare::compare;
pub use error::{Doing, Full, JournalError};
pub use export::{ExportError, export_csv, export_jsonl, export_mcap, export_mcap_forwards};
pub use filter::{Filter, FilterState, KINDS, kind, kind_of, path_of, place_of};
pub use folder::{make_folder, run_id};
pub use found::{Found, Looked, Search, is_about_values};
pub use journal::{Committed, Journal, Options, RECORDER_BYTES, SIZE_MAX, TakenUp};
pub use lock::{locks, writer_of};
pub use moment::{ANSWERS_MAX, BadMoment, Ended, Moment, Standing, StopRequest, Variable, Whole};
pub use pack::{Hash, Manifest, Pack, Packed, Packer};
pub use places::Places;
pub use reader::{Entry, Reader};
pub use record::{Definition, Item, Kept, Place, PlaceNumber, Record, Stored, ValueNumber};
pub use retention::{Pruned, Retention, remove};
pub use statistics::Tally;
pub use summary::{RunState, Summary, run_folders, runs, size_of};
pub use telling::{DAMAGED, Glossary, tell};
