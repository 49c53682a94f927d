//! The engine with its lock, threads and scripts: what goes in, what comes out, and what is written down of it.

pub(crate) mod branch;
pub(crate) mod core;
pub(crate) mod dispatch;
pub(crate) mod document;
pub(crate) mod driver;
pub(crate) mod due;
pub(crate) mod error;
pub(crate) mod inquiry;
pub(crate) mod notes;
pub(crate) mod past;
pub(crate) mod points;
pub(crate) mod prepare;
pub(crate) mod pulse;
pub(crate) mod questions;
pub(crate) mod record_events;
pub(crate) mod roots;
pub(crate) mod scripts;
pub(crate) mod snapshot;
pub(crate) mod worker_pool;
