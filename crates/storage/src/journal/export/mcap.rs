//! Exports a run as an MCAP recording: the topics `/events`, `/log`, `/states` and `/values`, each message in JSON.

use super::states::States;
use super::{ExportError, csv, schemas};
use crate::journal::read::{Filter, Found, Reader, kind_of, path_of};
use ::mcap::records::MessageHeader;
use ::mcap::write::NoSeek;
use ::mcap::{WriteOptions, Writer};
use rafcon_protocol::{Event, LogLevel};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{Seek, Write};

/// Writes a recording for Foxglove and Lichtblick.
pub fn export_mcap(reader: &mut Reader, out: impl Write + Seek) -> Result<(), ExportError> {
    write(reader, out, true)
}

/// Writes a recording without seeking. Its readers have to find the index themselves.
pub fn export_mcap_forwards(reader: &mut Reader, out: impl Write) -> Result<(), ExportError> {
    write(reader, NoSeek::new(out), false)
}

fn write(reader: &mut Reader, out: impl Write + Seek, can_seek: bool) -> Result<(), ExportError> {
    let options = WriteOptions::new()
        .compression(None)
        .library(concat!("rafcon ", env!("CARGO_PKG_VERSION")))
        .disable_seeking(!can_seek);
    let writer = options.create(out)?;
    let mut recording = Recording::new(writer, reader.about().started_ms)?;
    reader.find_all(&Filter::default(), |found| recording.event(&found))?;
    recording.writer.finish()?;
    Ok(())
}

struct Recording<W: Write + Seek> {
    writer: Writer<W>,
    channels: Channels,
    started_ns: u64,
    states: States,
}

#[derive(Debug, Clone, Copy)]
struct Channels {
    events: u16,
    log: u16,
    states: u16,
    values: u16,
}

impl<W: Write + Seek> Recording<W> {
    fn new(mut writer: Writer<W>, started_ms: u64) -> Result<Self, ExportError> {
        let mut channel = |topic: &str, schema: &Value| -> Result<u16, ExportError> {
            let name = schema["title"].as_str().unwrap_or_default();
            let schema = writer.add_schema(name, "jsonschema", &serde_json::to_vec(schema)?)?;
            Ok(writer.add_channel(schema, topic, "json", &BTreeMap::new())?)
        };
        let channels = Channels {
            events: channel("/events", &schemas::events())?,
            log: channel("/log", &schemas::log())?,
            states: channel("/states", &schemas::states())?,
            values: channel("/values", &schemas::values())?,
        };
        let started_ns = started_ms.saturating_mul(1_000_000);
        Ok(Self { writer, channels, started_ns, states: States::default() })
    }

    fn event(&mut self, found: &Found) -> Result<(), ExportError> {
        let kind = kind_of(&found.event);
        let channels = self.channels;
        let message = json!({
            "sequence": found.sequence, "kind": kind, "state": found.names, "event": found.event,
        });
        self.put(channels.events, found, message)?;
        if let Event::Log { level, message, .. } = &found.event {
            let message = json!({
                "level": level_number(*level), "message": message, "name": found.names,
                "file": "", "line": 0,
            });
            self.put(channels.log, found, message)?;
        }
        self.state(found)?;
        self.values(found)
    }

    fn state(&mut self, found: &Found) -> Result<(), ExportError> {
        let path = path_of(&found.event);
        let outcome = match &found.event {
            Event::Entered { .. } => {
                self.states.entered(path, &found.names);
                ""
            }
            Event::Left { outcome, .. } => {
                self.states.left(path);
                &outcome.name
            }
            Event::Dropped { .. } => {
                self.states.left(path);
                ""
            }
            Event::Damaged { .. } => {
                self.states = States::default();
                return Ok(());
            }
            _ => return Ok(()),
        };
        let message = json!({
            "kind": kind_of(&found.event), "state": found.names, "path": path, "outcome": outcome,
            "active": self.states.innermost(),
        });
        self.put(self.channels.states, found, message)
    }

    fn values(&mut self, found: &Found) -> Result<(), ExportError> {
        let kind = match &found.event {
            Event::Entered { .. } => "input",
            Event::Left { .. } | Event::Finished { .. } => "output",
            other => kind_of(other),
        };
        let Value::Object(values) = csv::values(&found.event) else { return Ok(()) };
        for (name, value) in values {
            let number = number_in(&value);
            let mut message = json!({
                "kind": kind, "state": found.names, "name": name, "value": value,
            });
            if let Some(number) = number {
                message["number"] = number.into();
            }
            self.put(self.channels.values, found, message)?;
        }
        Ok(())
    }

    fn put(
        &mut self,
        channel_id: u16,
        found: &Found,
        mut message: Value,
    ) -> Result<(), ExportError> {
        let log_time = self.started_ns.saturating_add(found.t_ns);
        let (sec, nsec) = (log_time / 1_000_000_000, log_time % 1_000_000_000);
        message["timestamp"] = json!({ "sec": sec, "nsec": nsec });
        // MCAP numbers messages with 32 bits.
        let sequence = u32::try_from(found.sequence).unwrap_or(u32::MAX);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        let message = serde_json::to_vec(&message)?;
        Ok(self.writer.write_to_known_channel(&header, &message)?)
    }
}

/// Returns a number for plots, which need less precision than the value has.
fn number_in(value: &Value) -> Option<f64> {
    let tagged = || value.get("__int__").or_else(|| value.get("__float__"));
    value.as_f64().or_else(|| tagged()?.as_str()?.parse().ok())
}

fn level_number(level: LogLevel) -> u8 {
    match level {
        LogLevel::Verbose | LogLevel::Debug => 1,
        LogLevel::Info => 2,
        LogLevel::Warning => 3,
        LogLevel::Error => 4,
    }
}
