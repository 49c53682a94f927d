//! A stream as one reader follows it.

use super::{EventBlock, StreamDefinitions, StreamItem};
use crate::journal::binary::Broken;
use crate::journal::found::is_about_values;
use rafcon_protocol::Event;
use std::path::PathBuf;

/// Turns blocks into events, each once, however often it was sent.
#[derive(Debug)]
pub struct StreamReader {
    definitions: StreamDefinitions,
    /// The last event that was read.
    last: u64,
    values: bool,
}

impl StreamReader {
    /// A reader that knows all events before number `from`; `values` says whether it wants values. The run's journal, if it has
    /// one, lies in `folder`.
    pub fn new(from: u64, values: bool, folder: Option<PathBuf>) -> Self {
        Self { definitions: StreamDefinitions::new(folder), last: from.saturating_sub(1), values }
    }

    /// Reads the blocks in `bytes`: shows each event that is new, with its number and its time in ns.
    pub fn read(
        &mut self,
        bytes: &[u8],
        mut show: impl FnMut(u64, u64, Event),
    ) -> Result<(), Broken> {
        EventBlock::read_all(bytes).try_for_each(|block| self.read_block(&block?, &mut show))
    }

    /// The same with one block.
    pub fn read_block(
        &mut self,
        block: &EventBlock<'_>,
        show: &mut impl FnMut(u64, u64, Event),
    ) -> Result<(), Broken> {
        for item in block.items() {
            let Some(StreamItem::Event { sequence, t_ns, record, .. }) =
                self.definitions.learn(item?)
            else {
                continue;
            };
            if sequence <= self.last {
                continue;
            }
            self.last = sequence;
            if !self.values && is_about_values(&record) {
                continue;
            }
            if let Ok(event) = self.definitions.event(sequence, record, self.values) {
                show(sequence, t_ns, event);
            }
        }
        Ok(())
    }
}
