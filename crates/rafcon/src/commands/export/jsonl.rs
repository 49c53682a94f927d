//! Events as lines of JSON: as `docs/protocol.md` tells them, each with its number and both its times.

use super::Found;
use crate::clock;
use anyhow::Result;
use serde_json::json;

/// The line of an event of a run that began at `started_ms`.
pub(super) fn line(found: &Found, started_ms: u64) -> Result<String> {
    Ok(serde_json::to_string(&json!({
        "sequence": found.sequence,
        "t_ns": found.t_ns,
        "utc": clock::utc_at(started_ms + found.t_ns / 1_000_000),
        "names": found.names,
        "event": found.event,
    }))?)
}
