//! Outline of a run: limited in size, however long the run is, and extended as the run grows. It allows drawing any part of the run
//! at any width, and finding the activity before any event, after reading few events.
//!
//! Handles records, not clients.

mod bars;
mod blocks;
mod calls;
mod counts;

pub use bars::Span;

use super::{Entry, Reader};
use crate::journal::folder::JournalError;
use crate::journal::record::{PlaceNumber, Record};
use bars::Bars;
use blocks::{Block, Blocks};
use calls::OpenCalls;
use counts::Counts;
use rafcon_model::ids::OutcomeId;
use rafcon_protocol::api::{EarlierHistory, HistoryEntry, Overview};
use rafcon_protocol::{Event, LogLevel};
use std::collections::VecDeque;
use std::ops::ControlFlow;

/// Maximum number of stored notable events. The newest are kept.
const NOTABLE_MAX: usize = 5000;
/// Maximum number of positions from which reading can continue.
const STARTS_MAX: usize = 128;
/// Initial interval between these positions, in events.
const START_EVERY: u64 = 8192;

/// Outline of a run up to the last processed event.
#[derive(Debug)]
pub struct Outline {
    sequence: u64,
    t_ns: u64,
    open: OpenCalls,
    counts: Counts,
    blocks: Blocks,
    notable: VecDeque<HistoryEntry>,
    starts: Vec<Start>,
    start_every: u64,
}

/// State of the outline after an event. Reading can continue from there.
#[derive(Debug, Clone, Default)]
struct Start {
    sequence: u64,
    open: OpenCalls,
    counts: Counts,
}

impl Default for Outline {
    fn default() -> Self {
        Self {
            sequence: 0,
            t_ns: 0,
            open: OpenCalls::default(),
            counts: Counts::default(),
            blocks: Blocks::default(),
            notable: VecDeque::new(),
            starts: vec![Start::default()],
            start_every: START_EVERY,
        }
    }
}

impl Outline {
    /// Returns the time of the last processed event, in ns since the start of the run.
    pub fn t_ns(&self) -> u64 {
        self.t_ns
    }

    /// Processes all events up to the current end of the run.
    pub fn go_on(&mut self, reader: &mut Reader) -> Result<(), JournalError> {
        let mut failed = None;
        reader.each_without_values(self.sequence + 1, |reader, entry| {
            match self.take(reader, &entry) {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    failed = Some(error);
                    ControlFlow::Break(())
                }
            }
        })?;
        failed.map_or(Ok(()), Err)
    }

    /// Returns the calls in a part of the run's time, for a drawing of a given width.
    pub fn overview(&self, reader: &mut Reader, span: Span) -> Result<Overview, JournalError> {
        let mut bars = Bars::new(span);
        let overlaps = |block: &&Block| block.to_ns >= span.from_ns && block.from_ns <= span.to_ns;
        let (many, last) = self
            .blocks
            .all()
            .filter(overlaps)
            .fold((0, 0), |(many, _), block| (many + 1, block.last));
        let first = self.blocks.all().find(overlaps).map_or(1, |block| block.first);
        let is_wide = many >= u64::from(span.pixels / 2);
        if is_wide {
            let rows = self.blocks.all().filter(overlaps).flat_map(Block::rows);
            rows.for_each(|sum| bars.sum(sum));
        } else if many > 0 {
            self.calls(reader, first, last, &mut bars)?;
        }
        // Events that were read individually have already yielded the calls that end in them.
        let untold = self.blocks.all().filter(|block| block.to_ns >= span.from_ns);
        let untold = untold.filter(|block| is_wide || many == 0 || block.first > last);
        let crossing = untold.flat_map(Block::crossing).copied();
        let is_told = |first_of: u64| is_wide || many == 0 || first_of <= last;
        crossing.filter(|call| is_told(call.first)).for_each(|call| bars.call(call));
        self.open.calls().for_each(|call| bars.call(call));
        let places = reader.known_places();
        let path = |place: &PlaceNumber| places.path(*place).to_owned();
        let concurrent = self.open.concurrent().iter().map(path).collect();
        let (rows, paths) = bars.finish(places);
        Ok(Overview { sequence: self.sequence, t_ns: self.t_ns, concurrent, paths, rows })
    }

    /// Returns the activity of states up to an event, and the notable events up to it.
    pub fn earlier(
        &self,
        reader: &mut Reader,
        sequence: u64,
    ) -> Result<EarlierHistory, JournalError> {
        let Start { sequence: from, mut counts, .. } = self.start(sequence).clone();
        if from < sequence {
            reader.each_without_values(from + 1, |_, entry| {
                if entry.sequence > sequence {
                    return ControlFlow::Break(());
                }
                counts.take(&entry);
                ControlFlow::Continue(())
            })?;
        }
        let notable = self.notable.iter().filter(|entry| entry.sequence <= sequence);
        let states = counts.told(reader.known_places());
        Ok(EarlierHistory { sequence, states, notable: notable.cloned().collect() })
    }

    /// Passes on the calls that end between two events, each once.
    fn calls(
        &self,
        reader: &mut Reader,
        first: u64,
        last: u64,
        bars: &mut Bars,
    ) -> Result<(), JournalError> {
        let Start { sequence, mut open, .. } = self.start(first.saturating_sub(1)).clone();
        reader.each_without_values(sequence + 1, |reader, entry| {
            if entry.sequence > last {
                return ControlFlow::Break(());
            }
            open.take(&entry, reader.known_places(), |call| bars.call(call));
            ControlFlow::Continue(())
        })
    }

    /// Returns the last position before or at an event from which reading can continue.
    fn start(&self, sequence: u64) -> &Start {
        let behind = self.starts.partition_point(|start| start.sequence <= sequence);
        &self.starts[behind.saturating_sub(1)]
    }

    fn take(&mut self, reader: &Reader, entry: &Entry) -> Result<(), JournalError> {
        (self.sequence, self.t_ns) = (entry.sequence, entry.t_ns);
        let blocks = &mut self.blocks;
        blocks.event(entry.sequence, entry.t_ns);
        self.open.take(entry, reader.known_places(), |call| blocks.ended(call));
        self.counts.take(entry);
        if is_notable(&entry.record) {
            self.note(reader, entry)?;
        }
        let before = self.starts.last().map_or(0, |start| start.sequence);
        if entry.sequence >= before + self.start_every {
            self.begin_here();
        }
        Ok(())
    }

    fn note(&mut self, reader: &Reader, entry: &Entry) -> Result<(), JournalError> {
        if self.notable.len() >= NOTABLE_MAX {
            self.notable.pop_front();
        }
        let event = reader.event(entry, false)?;
        self.notable.push_back(HistoryEntry { sequence: entry.sequence, t_ns: entry.t_ns, event });
        Ok(())
    }

    fn begin_here(&mut self) {
        if self.starts.len() >= STARTS_MAX {
            self.start_every *= 2;
            let mut index = 0;
            self.starts.retain(|_| {
                index += 1;
                index % 2 == 1
            });
        }
        let (open, counts) = (self.open.clone(), self.counts.clone());
        self.starts.push(Start { sequence: self.sequence, open, counts });
    }
}

/// Returns true if an event is notable.
fn is_notable(record: &Record) -> bool {
    match record {
        Record::Left { outcome, error, undoes, .. } => {
            undoes.is_none() && (error.is_some() || OutcomeId(*outcome) == OutcomeId::ABORTED)
        }
        Record::Log { level, .. } => *level >= LogLevel::Warning,
        Record::WentBack { .. } => true,
        Record::Told(event) => matches!(
            **event,
            Event::Hit { .. }
                | Event::BreakpointSet { .. }
                | Event::BreakpointRemoved { .. }
                | Event::Forced { .. }
                | Event::Root { .. }
                | Event::Commanded { .. }
                | Event::Asked { .. }
                | Event::Closed { .. }
                | Event::DeadlinePassed { .. }
                | Event::CutOff { .. }
                | Event::Resumed { .. }
                | Event::WentBack { .. }
                | Event::Damaged { .. }
        ),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_the_bound_every_second_place_to_start_from_is_dropped() {
        let mut outline = Outline::default();
        let mut begin = |numbers: std::ops::Range<usize>| {
            for number in numbers {
                outline.sequence = number as u64 * START_EVERY;
                outline.begin_here();
            }
            (outline.starts.len(), outline.start_every, outline.start(3 * START_EVERY).sequence)
        };
        assert_eq!(begin(1..STARTS_MAX), (STARTS_MAX, START_EVERY, 3 * START_EVERY));
        let halved = (STARTS_MAX / 2 + 1, 2 * START_EVERY, 2 * START_EVERY);
        assert_eq!(begin(STARTS_MAX..STARTS_MAX + 1), halved);
        let (count, _, first) = begin(STARTS_MAX + 1..10 * STARTS_MAX);
        assert!(count <= STARTS_MAX, "{count} places");
        assert_eq!(first, 0);
    }
}
