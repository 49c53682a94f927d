//! The report of a station about one run.

use super::{Frame, RANGES_MAX, StreamId, read_flag};
use crate::bytes::{BrokenFrame, FrameReader, write_number};
use crate::coding::ContextName;
use crate::payload_writer::PayloadWriter;
use crate::range_set::RangeSet;
use crate::station::LARGE_MAX;

pub(super) const RECEIVED: u8 = 18;

/// Events of one run at a station.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Received {
    /// The run.
    pub(crate) stream: StreamId,
    /// True if the station has received the end of the run.
    pub(crate) is_over: bool,
    /// All events up to this one are on the station's disk.
    pub(crate) safe: u64,
    /// Which events it has received, the newest ranges if they are many.
    pub(crate) events: RangeSet,
    /// From which events a coder may learn.
    pub(crate) context: Option<ContextName>,
    /// From which snapshot a coder of snapshots may learn: the number of its event is the first and the last.
    pub(crate) snapshot: Option<ContextName>,
    /// Events of which parts are missing.
    pub(crate) partial: Vec<PartialEvent>,
}

/// An event of which the station has some parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct PartialEvent {
    /// The number of the event.
    pub(crate) first: u64,
    /// The length of all its packed items, in bytes.
    pub(crate) length: u32,
    /// Received bytes, numbered from 1. The oldest ranges if they are many.
    pub(crate) here: RangeSet,
}

impl Received {
    /// Appends the frame, shortened until it fits.
    pub(crate) fn write_shortened(self, payload: &mut PayloadWriter) {
        let mut frame = Frame::Received(self);
        while !payload.try_frame(&frame)
            && let Frame::Received(received) = &mut frame
            && received.shorten()
        {}
    }

    /// Drops what the robot needs least. Returns false if nothing is left that can be dropped.
    fn shorten(&mut self) -> bool {
        if !self.partial.is_empty() {
            self.partial.clear();
        } else if self.snapshot.take().is_none() && self.context.take().is_none() {
            let before = self.events.ranges_count();
            let newest: Vec<_> = self.events.ranges().rev().take(before / 2).collect();
            let all = RangeSet::up_to(self.events.contiguous());
            self.events = newest.into_iter().fold(all, |mut events, range| {
                events.insert(range);
                events
            });
            return self.events.ranges_count() < before;
        }
        true
    }
}

/// The newest ranges, each as the distance from the end of the one before, and its length.
pub(super) fn write_received(received: &Received, out: &mut Vec<u8>) {
    out.push(RECEIVED);
    let (stream, is_over) = (u64::from(received.stream.0), u64::from(received.is_over));
    for number in [stream, is_over, received.safe] {
        write_number(number, out);
    }
    write_ranges(&received.events, out);
    let Received { context, snapshot, partial, .. } = received;
    let offers = [context.is_some(), snapshot.is_some(), !partial.is_empty()];
    let offers = (0..).zip(offers).map(|(bit, offer)| u64::from(offer) << bit).sum();
    write_number(offers, out);
    if let Some(ContextName { first, last, hash }) = context {
        write_number(*first, out);
        write_number(*last, out);
        out.extend_from_slice(hash);
    }
    if let Some(ContextName { last, hash, .. }) = snapshot {
        write_number(*last, out);
        out.extend_from_slice(hash);
    }
    if !partial.is_empty() {
        write_number(partial.len() as u64, out);
    }
    for PartialEvent { first, length, here } in partial {
        write_number(*first, out);
        write_number(u64::from(*length), out);
        write_ranges(here, out);
    }
}

pub(super) fn write_ranges(set: &RangeSet, out: &mut Vec<u8>) {
    let contiguous = set.contiguous();
    let ahead = set.ranges().filter(|range| *range.start() > 1);
    let mut ahead: Vec<_> = ahead.rev().take(RANGES_MAX).collect();
    ahead.reverse();
    for number in [contiguous, ahead.len() as u64] {
        write_number(number, out);
    }
    let mut end = contiguous;
    for range in ahead {
        write_number(range.start() - end, out);
        write_number(range.end() - range.start(), out);
        end = *range.end();
    }
}

pub(super) fn read_received(reader: &mut FrameReader<'_>) -> Result<Received, BrokenFrame> {
    let (stream, is_over) = (StreamId(reader.small()?), read_flag(reader)?);
    let (safe, events) = (reader.number()?, read_ranges(reader)?);
    let offers = reader.number()?;
    if offers > 7 {
        return Err(BrokenFrame("unknown offers"));
    }
    let context = (offers & 1 != 0).then(|| read_context(reader)).transpose()?;
    let snapshot = (offers & 2 != 0).then(|| read_snapshot_name(reader)).transpose()?;
    let count = if offers & 4 != 0 { reader.number()? } else { 0 };
    if count > LARGE_MAX as u64 {
        return Err(BrokenFrame("too many events in parts"));
    }
    let partial = (0..count).map(|_| read_partial(reader)).collect::<Result<_, _>>()?;
    Ok(Received { stream, is_over, safe, events, context, snapshot, partial })
}

fn read_partial(reader: &mut FrameReader<'_>) -> Result<PartialEvent, BrokenFrame> {
    let (first, length) = (reader.number()?, reader.small()?);
    Ok(PartialEvent { first, length, here: read_ranges(reader)? })
}

fn read_snapshot_name(reader: &mut FrameReader<'_>) -> Result<ContextName, BrokenFrame> {
    let sequence = reader.number()?;
    Ok(ContextName { first: sequence, last: sequence, hash: reader.fixed()? })
}

fn read_context(reader: &mut FrameReader<'_>) -> Result<ContextName, BrokenFrame> {
    let (first, last) = (reader.number()?, reader.number()?);
    if first == 0 || first > last {
        return Err(BrokenFrame("impossible numbers of events"));
    }
    Ok(ContextName { first, last, hash: reader.fixed()? })
}

pub(super) fn read_ranges(reader: &mut FrameReader<'_>) -> Result<RangeSet, BrokenFrame> {
    let (contiguous, count) = (reader.number()?, reader.number()?);
    if count > RANGES_MAX as u64 {
        return Err(BrokenFrame("too many ranges"));
    }
    let (mut events, mut end) = (RangeSet::up_to(contiguous), contiguous);
    for _ in 0..count {
        let far = || BrokenFrame("a number is too large");
        let first = end.checked_add(reader.number()?).ok_or_else(far)?;
        end = first.checked_add(reader.number()?).ok_or_else(far)?;
        events.insert(first..=end);
    }
    Ok(events)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::read_payload;
    use crate::session_time::SessionTime;

    #[test]
    fn a_report_becomes_as_short_as_the_room_needs() {
        let here = (0..4).map(|nth| nth * 9_000 + 1..=nth * 9_000 + 1_000).collect();
        let partial = PartialEvent { first: 1 << 40, length: 1 << 24, here };
        let name = ContextName { first: 1 << 40, last: 1 << 41, hash: [9; 8] };
        let mut received = Received {
            stream: StreamId(u32::MAX),
            is_over: true,
            safe: 1 << 40,
            events: (1..=40).map(|nth| nth << 35..=nth << 35 | 7).collect(),
            context: Some(name),
            snapshot: Some(ContextName { first: 1 << 41, ..name }),
            partial: vec![partial; LARGE_MAX],
        };
        let mut lengths = Vec::new();
        for room in [400, 300, 150, 100, 70, 40] {
            let mut out = PayloadWriter::new(SessionTime::BEGIN, 1 + room);
            received.clone().write_shortened(&mut out);
            let (_, mut frames) = read_payload(out.bytes()).expect("a time");
            let Some(Ok((Frame::Received(shortened), length))) = frames.next() else {
                panic!("no report in {room} bytes")
            };
            lengths.push((length, shortened.partial.len(), shortened.events.ranges_count()));
            received = shortened;
        }
        assert_eq!(received.events.contiguous(), 0);
        assert_eq!(lengths.last().map(|(_, partial, _)| *partial), Some(0));
    }
}
