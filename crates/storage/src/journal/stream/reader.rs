//! Reader for a stream of events.

use super::{StreamBlock, StreamDefinitions, StreamItem};
use crate::journal::read::is_about_values;
use crate::journal::record::Broken;
use rafcon_protocol::{Event, FrameError, FrameKind, ToViewer, decode};
use std::path::PathBuf;

/// A frame of a runner that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum BadFrame {
    /// The message cannot be decoded.
    #[error(transparent)]
    Message(#[from] FrameError),
    /// The events cannot be decoded.
    #[error(transparent)]
    Events(#[from] Broken),
}

/// Converts blocks to events. Events that the runner sends repeatedly are read once.
#[derive(Debug)]
pub struct StreamReader {
    definitions: StreamDefinitions,
    /// Number of the last event that was read.
    last: u64,
    values: bool,
}

impl StreamReader {
    /// Creates a reader that has all events before number `from`, with or without `values`. `folder` contains the run's journal, if
    /// it has one.
    pub fn new(from: u64, values: bool, folder: Option<PathBuf>) -> Self {
        Self { definitions: StreamDefinitions::new(folder), last: from.saturating_sub(1), values }
    }

    /// Reads a frame of a runner, and passes on its message or each new event. Ignores frames of unknown kinds.
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

    /// Reads the blocks in `bytes`, and passes on each new event with its number and its time in ns.
    pub fn read(
        &mut self,
        bytes: &[u8],
        mut show: impl FnMut(u64, u64, Event),
    ) -> Result<(), Broken> {
        StreamBlock::read_all(bytes).try_for_each(|block| self.read_block(&block?, &mut show))
    }

    /// Reads one block of events.
    pub fn read_block(
        &mut self,
        block: &StreamBlock<'_>,
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
