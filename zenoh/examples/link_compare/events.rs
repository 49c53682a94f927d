//! The events that all ways carry, as `link_events` prints them.

use anyhow::{Context as _, Result};
use std::path::Path;
use std::time::Duration;

/// Events of a mission.
#[derive(Debug)]
pub(crate) struct Events {
    pub(crate) list: Vec<Event>,
    /// The state of the mission, which the link sends besides.
    pub(crate) state: Vec<u8>,
}

/// One event.
#[derive(Debug)]
pub(crate) struct Event {
    pub(crate) time: Duration,
    /// As in a journal.
    pub(crate) items: Vec<u8>,
    pub(crate) path: String,
    pub(crate) names: String,
}

impl Events {
    pub(crate) fn read(file: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(file)?;
        let mut lines = text.lines();
        let state = lines.next().and_then(bytes).context("its first line is no state")?;
        let list = lines.map(|line| event(line).with_context(|| format!("no event: {line}")));
        Ok(Self { list: list.collect::<Result<_>>()?, state })
    }

    /// The bytes of an event with its number, for those who do not number what they carry.
    pub(crate) fn numbered(&self, number: usize) -> Vec<u8> {
        [&(number as u32).to_le_bytes()[..], &self.list[number].items].concat()
    }

    /// When the event before this one happened, in ns.
    pub(crate) fn before(&self, number: usize) -> u64 {
        let before = number.checked_sub(1).map(|before| self.list[before].time);
        u64::try_from(before.unwrap_or_default().as_nanos()).unwrap_or(u64::MAX)
    }
}

/// The number that [`Events::numbered`] gave.
pub(crate) fn number(bytes: &[u8]) -> Option<usize> {
    Some(u32::from_le_bytes(bytes.get(..4)?.try_into().ok()?) as usize)
}

fn event(line: &str) -> Option<Event> {
    let mut parts = line.split('\t');
    Some(Event {
        time: Duration::from_nanos(parts.next()?.parse().ok()?),
        items: bytes(parts.next()?)?,
        path: parts.next()?.to_owned(),
        names: parts.next()?.to_owned(),
    })
}

fn bytes(hex: &str) -> Option<Vec<u8>> {
    let digits = (0..hex.len()).step_by(2);
    digits.map(|at| u8::from_str_radix(hex.get(at..at + 2)?, 16).ok()).collect()
}
