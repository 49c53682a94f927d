//! In which order the robot sends what the station lacks.

use super::outgoing::{Outgoing, TransmitContext};
use super::source::RunSource;
use super::values::Values;
use crate::frame::StreamId;
use crate::payload_writer::PayloadWriter;
use std::collections::BTreeMap;

/// Without an up-link, one in this many datagrams begins with files that the sent runs need, and one in `AHEAD_TURN` with
/// files for later use. Repeating a whole history has no end.
const NEEDED_TURN: u64 = 4;
const AHEAD_TURN: u64 = 16;

/// Order in which the streams are sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Rank {
    /// Descriptions of runs: a station shows a run once it has its description.
    Description,
    /// Events. Datagrams begin with one run after the other: no history waits for the end of another.
    #[default]
    Events,
    /// Files that the sent runs need.
    Needed,
    /// Files for later use. They follow the large values that people request.
    Ahead,
    /// Runs that were over long ago.
    Last,
}

/// The order of streams.
#[derive(Debug, Default)]
pub(super) struct Bulk {
    /// Rank of the next datagram without events.
    ranks: BTreeMap<StreamId, Rank>,
    /// Number of datagrams with room.
    turns: u64,
    /// The stream of events that the last datagram began with.
    served: Option<StreamId>,
}

impl Bulk {
    pub(super) fn set_rank(&mut self, stream: StreamId, rank: Rank) {
        self.ranks.insert(stream, rank);
    }

    pub(super) fn forget(&mut self, stream: StreamId) {
        self.ranks.remove(&stream);
    }

    /// Fills the rest of a datagram.
    pub(super) fn write(
        &mut self,
        (streams, values): (&mut BTreeMap<StreamId, Outgoing>, &mut Values),
        turn: TransmitContext<'_>,
        source: &mut impl RunSource,
        payload: &mut PayloadWriter,
    ) {
        self.turns += 1;
        if !turn.is_heard {
            if self.turns.is_multiple_of(AHEAD_TURN) {
                self.write_rank(Rank::Ahead, streams, turn, (source, payload));
            } else if self.turns.is_multiple_of(NEEDED_TURN) {
                self.write_rank(Rank::Needed, streams, turn, (source, payload));
            }
        }
        self.write_rank(Rank::Description, streams, turn, (source, payload));
        self.write_events(streams, turn, source, payload);
        if self.waits(Rank::Events, streams) {
            return;
        }
        self.write_rank(Rank::Needed, streams, turn, (source, payload));
        if self.waits(Rank::Needed, streams) {
            return;
        }
        if turn.is_heard {
            values.write(turn, source, payload);
        } else {
            // Without reports, large values would be sent twice.
            values.forget();
        }
        self.write_rank(Rank::Ahead, streams, turn, (source, payload));
        if !self.waits(Rank::Ahead, streams) {
            self.write_rank(Rank::Last, streams, turn, (source, payload));
        }
    }

    /// True if a stream of this rank or a more urgent one waits for the next datagram: what follows does not go ahead of it.
    fn waits(&self, rank: Rank, streams: &BTreeMap<StreamId, Outgoing>) -> bool {
        streams.iter().any(|(id, stream)| stream.waits() && self.rank(*id) <= rank)
    }

    fn write_events(
        &mut self,
        streams: &mut BTreeMap<StreamId, Outgoing>,
        turn: TransmitContext<'_>,
        source: &mut impl RunSource,
        payload: &mut PayloadWriter,
    ) {
        let is_events = |id: &&StreamId| self.rank(**id) == Rank::Events;
        let ids: Vec<_> = streams.keys().filter(is_events).copied().collect();
        let first = ids.partition_point(|id| Some(*id) <= self.served);
        let mut served = None;
        for id in ids[first..].iter().chain(&ids[..first]) {
            let Some(stream) = streams.get_mut(id) else { continue };
            let length = payload.len();
            stream.write_bulk(turn, source, payload);
            if served.is_none() && payload.len() > length {
                served = Some(*id);
            }
        }
        self.served = served.or(self.served);
    }

    fn write_rank(
        &self,
        rank: Rank,
        streams: &mut BTreeMap<StreamId, Outgoing>,
        turn: TransmitContext<'_>,
        (source, payload): (&mut impl RunSource, &mut PayloadWriter),
    ) {
        for (_, stream) in streams.iter_mut().filter(|(id, _)| self.rank(**id) == rank) {
            stream.write_bulk(turn, source, payload);
        }
    }

    fn rank(&self, stream: StreamId) -> Rank {
        self.ranks.get(&stream).copied().unwrap_or_default()
    }
}
