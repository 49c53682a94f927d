//! A run in formats of other programs, event by event: nothing is held in memory as a whole.
//!
//! Knows events and formats. Must never know where the bytes go.

mod csv;
mod jsonl;
mod mcap;
mod schemas;
mod states;

pub use self::mcap::{export_mcap, export_mcap_forwards};

use super::error::JournalError;
use super::filter::Filter;
use super::found::Found;
use super::reader::Reader;
use crate::calendar::Date;
use ::mcap::McapError;
use std::io::{self, BufWriter, Write};

/// So much is gathered before it is written, in bytes.
const WRITTEN_AT_ONCE: usize = 64 * 1024;

/// Why a run was not written, or not to its end.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The run cannot be read.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// An event cannot be said in the format.
    #[error("an event of the run cannot be written as JSON")]
    Json(#[from] serde_json::Error),
    /// Nobody takes what is written.
    #[error("cannot write the run: make room, or write it elsewhere")]
    Write(#[from] io::Error),
    /// The same of a recording.
    #[error("cannot write the recording: make room, or write it elsewhere")]
    Recording(#[from] McapError),
}

/// Every event that is wanted as a JSON object on a line.
pub fn export_jsonl(
    reader: &mut Reader,
    filter: &Filter,
    out: impl Write,
) -> Result<(), ExportError> {
    lines(reader, filter, out, jsonl::line, "")
}

/// A table for spreadsheets, of the events that are wanted.
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

/// A time in ms since 1970 as programs read it: `2026-01-31T12:00:00.000Z`.
fn utc_at(ms: u64) -> String {
    let date = Date::since_1970(ms / 1000).to_string();
    format!("{}.{:03}Z", date.replace(' ', "T"), ms % 1000)
}

#[cfg(test)]
mod tests {
    use super::utc_at;

    #[test]
    fn programs_read_times_to_the_millisecond() {
        assert_eq!(utc_at(951_782_399_007), "2000-02-28T23:59:59.007Z");
    }
}
