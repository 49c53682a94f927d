//! Events as lines of JSON: as `docs/protocol.md` tells them, each with its number and both its times.

use super::{ExportError, utc_at};
use crate::journal::found::Found;
use rafcon_protocol::Event;
use serde::Serialize;

/// The line of an event of a run that began at `started_ms`.
pub(super) fn line(found: &Found, started_ms: u64) -> Result<String, ExportError> {
    Ok(serde_json::to_string(&Line {
        sequence: found.sequence,
        t_ns: found.t_ns,
        utc: utc_at(started_ms + found.t_ns / 1_000_000),
        names: &found.names,
        next: found.next.as_deref(),
        lasted_ns: found.lasted.map(|lasted| u64::try_from(lasted.as_nanos()).unwrap_or(u64::MAX)),
        event: &found.event,
    })?)
}

#[derive(Debug, Serialize)]
struct Line<'f> {
    sequence: u64,
    t_ns: u64,
    utc: String,
    names: &'f str,
    /// The name of the state before which the run is held.
    #[serde(skip_serializing_if = "Option::is_none")]
    next: Option<&'f str>,
    /// How long a state was active that was left.
    #[serde(skip_serializing_if = "Option::is_none")]
    lasted_ns: Option<u64>,
    event: &'f Event,
}
