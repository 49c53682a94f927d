//! What runs leave: their events, logs, moments, values, machines and figures, read from their journals.
//!
//! Knows journals. Must never know runners: whether a run goes on means nothing here but that its journal grows.

mod follow;
mod readers;
mod refusal;

pub(crate) use follow::{HistoryPage, HistoryReader};
pub(crate) use readers::Readers;

use std::sync::Arc;

/// What all requests about the past share.
#[derive(Debug, Default)]
pub(crate) struct History {
    /// Open journals.
    readers: Arc<Readers>,
}
