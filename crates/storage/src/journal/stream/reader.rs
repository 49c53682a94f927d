//! A stream as one reader follows it.

use super::{EventBlock, StreamDefinitions, StreamItem};
use crate::journal::binary::Broken;
use crate::journal::found::is_about_values;
use rafcon_protocol::{Event, FrameError, FrameKind, ToViewer, decode};
use std::path::PathBuf;

/// A frame of a runner that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum BadFrame {
    /// It holds something else than a message.
    #[error(transparent)]
    Message(#[from] FrameError),
    /// It holds something else than events.
    #[error(transparent)]
    Events(#[from] Broken),
}

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

    /// Reads what a frame of a runner holds: shows its message, or each of its events that is new. A frame of no known kind holds
    /// nothing.
    pub fn read_frame(
        &mut self,
        kind: FrameKind,
        content: &[u8],
        mut show: impl FnMut(ToViewer),
    ) -> Result<(), BadFrame> {
        match kind {
            FrameKind::Message => show(decode(&String::from_utf8_lossy(content))?),
            FrameKind::Events => self.read(content, |sequence, t_ns, event| {
                show(ToViewer::Event { sequence, t_ns, event });
            })?,
            FrameKind::Unknown => {}
        }
        Ok(())
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
