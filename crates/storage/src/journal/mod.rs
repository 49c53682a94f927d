//! Journal of a run: all its events in order, in a separate folder (`docs/journal.md`).
//!
//! Handles the storage and retrieval of events, not their causes.

mod compare;
mod export;
pub mod folder;
mod moment;
pub(crate) mod pack;
mod read;
pub mod record;
mod replicate;
mod store;
pub mod stream;
#[cfg(test)]
mod tests;
mod write;

pub use compare::compare;
pub use export::{ExportError, export_csv, export_jsonl, export_mcap, export_mcap_forwards};
pub use folder::{
    About, ContentHash, Doing, Full, JournalError, is_content_here, locks, make_folder, run_id,
    writer_of,
};
pub use moment::{
    ANSWERS_MAX, ActiveStateData, BadMoment, ChildEnd, GroundSilence, Moment, ScopedValue,
    StopRequest, Whole,
};
pub use pack::{Hash, Manifest, Pack, Packed, Parcel};
pub use rafcon_events::EventBlock;
pub use read::{
    Entry, Filter, FilterState, Found, KINDS, Looked, Outline, Reader, RunState, Search, Span,
    Summary, Tally, is_about_values, kind, kind_of, path_of, place_of, run_folders, runs, size_of,
};
pub use record::{
    Batch, Broken, DAMAGED, Definition, Glossary, Item, Kept, Left, Place, PlaceNumber, Places,
    Record, Stored, ValueNumber, tell,
};
pub use replicate::{Chain, EventSource, IncomingContent, Replica, ReplicaError, ValueContent};
pub use store::leave_log;
pub use write::{
    Committed, Journal, Options, Pruned, RECORDER_BYTES, ResumePoint, Retention, SIZE_MAX,
    has_begun, remove,
};
