//! Exports a run to formats of other programs, event by event, without holding the run in memory.
//!
//! Handles events and formats, not the destination of the bytes.

mod csv;
mod mcap;
mod schemas;
mod states;

pub use self::mcap::{export_mcap, export_mcap_forwards};

use crate::journal::folder::JournalError;
use crate::journal::read::{Filter, Found, Reader};
use ::mcap::McapError;
use rafcon_protocol::Event;
use rafcon_protocol::calendar::Date;
use serde::Serialize;
use std::io::{self, BufWriter, Write};

/// Size of the write buffer, in bytes.
const WRITTEN_AT_ONCE: usize = 64 * 1024;

/// Reason why an export failed.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The run cannot be read.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// An event cannot be expressed in the format.
    #[error("an event of the run cannot be written as JSON")]
    Json(#[from] serde_json::Error),
    /// The output cannot be written.
    #[error("cannot write the run: make room, or write it elsewhere")]
    Write(#[from] io::Error),
    /// The recording cannot be written.
    #[error("cannot write the recording: make room, or write it elsewhere")]
    Recording(#[from] McapError),
}

/// Exports the matching events, each as a JSON object on a line.
pub fn export_jsonl(
    reader: &mut Reader,
    filter: &Filter,
    out: impl Write,
) -> Result<(), ExportError> {
    lines(reader, filter, out, json_line, "")
}

/// Exports the matching events as a table for spreadsheets.
pub fn export_csv(
    reader: &mut Reader,
    filter: &Filter,
    out: impl Write,
) -> Result<(), ExportError> {
    lines(reader, filter, out, csv::line, csv::HEAD)
}

/// Writes one line for each event.
fn lines(
    reader: &mut Reader,
    filter: &Filter,
    out: impl Write,
    line: fn(&Found, u64) -> Result<String, ExportError>,
    head: &str,
) -> Result<(), ExportError> {
    let started_ms = reader.about().started_ms;
    let mut out = BufWriter::with_capacity(WRITTEN_AT_ONCE, out);
    out.write_all(head.as_bytes())?;
    reader.find_all(filter, |found| -> Result<(), ExportError> {
        Ok(writeln!(out, "{}", line(&found, started_ms)?)?)
    })?;
    Ok(out.flush()?)
}

/// Formats a time in ms since 1970 in ISO 8601: `2026-01-31T12:00:00.000Z`.
fn utc_at(ms: u64) -> String {
    let date = Date::since_1970(ms / 1000).to_string();
    format!("{}.{:03}Z", date.replace(' ', "T"), ms % 1000)
}

/// Returns the line of an event of a run that began at `started_ms`.
fn json_line(found: &Found, started_ms: u64) -> Result<String, ExportError> {
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
    /// Name of the next state, before which the run is held.
    #[serde(skip_serializing_if = "Option::is_none")]
    next: Option<&'f str>,
    /// Duration of a state that ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    lasted_ns: Option<u64>,
    event: &'f Event,
}

#[cfg(test)]
mod tests {
    use super::utc_at;

    #[test]
    fn programs_read_times_to_the_millisecond() {
        assert_eq!(utc_at(951_782_399_007), "2000-02-28T23:59:59.007Z");
    }
}
