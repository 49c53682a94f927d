//! Frames as bytes and back, and whatever bytes a side may be sent.

use super::write_received;
use super::{
    Body, COMMAND_LENGTH_MAX, Command, CommandId, CommandPart, CommandState, EventHash, Frame,
    Packing, PartialEvent, PartsHere, RANGES_MAX, Received, StreamId, Terms,
};
use super::{Fetch, NoValue, ValueFrame, ValueId, ValueName, ValuePart, WatchPart, Watched};
use crate::bytes::{BrokenFrame, write_number};
use crate::coding::{ContextId, ContextName};
use crate::range_set::RangeSet;
use crate::seal::{Generation, KeyId, PairingKey};
use expect_test::expect;
use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use rafcon_events::EventBlockRef;

/// The time and the frames of a payload.
fn read_payload(
    payload: &[u8],
) -> Result<(u64, impl Iterator<Item = Result<Frame<'_>, BrokenFrame>>), BrokenFrame> {
    let (at_ms, frames) = super::read_payload(payload)?;
    Ok((at_ms, frames.map(|frame| frame.map(|(frame, _)| frame))))
}

fn bytes() -> impl Strategy<Value = Vec<u8>> {
    prop::collection::vec(any::<u8>(), 0..200)
}

fn ranges(most: usize) -> impl Strategy<Value = RangeSet> {
    let parts = prop::collection::vec((1..1_000_u64, 1..1_000_u64), 0..most);
    (0..1_000_u64, parts).prop_map(|(contiguous, parts)| {
        let (mut set, mut end) = (RangeSet::up_to(contiguous), contiguous + 1);
        for (gap, length) in parts {
            set.insert(end + gap..=end + gap + length);
            end += gap + length + 1;
        }
        set
    })
}

/// A frame whose bytes are these.
fn not_empty(bytes: &[u8]) -> &[u8] {
    if bytes.is_empty() { b"x" } else { bytes }
}

fn command(bytes: &[u8]) -> impl Strategy<Value = Frame<'_>> {
    let brief = any::<[u8; 6]>().prop_filter_map("zeros", CommandId::from_brief);
    let id = prop_oneof![any::<[u8; 16]>().prop_map(CommandId), brief];
    let state = prop::sample::select(CommandState::ALL.to_vec());
    prop_oneof![
        (id.clone(), state).prop_map(move |(id, state)| Frame::CommandState {
            id,
            state,
            reason: bytes
        }),
        (id.clone(), any::<u32>(), any::<[u64; 3]>()).prop_map(
            move |(id, start, [not_after_ms, not_before_ms, epoch])| {
                let robot_start = Generation(start);
                let not_before_ms = if start % 2 == 0 { 0 } else { not_before_ms };
                let terms = Terms { robot_start, not_after_ms, not_before_ms, epoch };
                let parts = Body::Parts(1 + start % COMMAND_LENGTH_MAX);
                let body = if epoch % 2 == 0 { Body::Whole(bytes) } else { parts };
                Frame::Command(Command { id, terms, body })
            }
        ),
        (id.clone(), 0..COMMAND_LENGTH_MAX - 200).prop_map(move |(id, offset)| {
            let bytes = not_empty(bytes);
            let length = offset + u32::try_from(bytes.len()).expect("few");
            Frame::CommandPart(CommandPart { id, length, offset, bytes })
        }),
        (id, any::<bool>(), ranges(RANGES_MAX)).prop_map(|(id, has_head, bytes)| {
            Frame::PartsHere(PartsHere { id, has_head, bytes })
        }),
    ]
}

fn frame(bytes: &[u8]) -> impl Strategy<Value = Frame<'_>> {
    let length = u32::try_from(bytes.len()).expect("few");
    let stream = any::<u32>().prop_map(StreamId);
    let part = (stream.clone(), 1..u64::MAX, any::<u64>(), 0..1_000_u32);
    let events = prop_oneof![
        (stream.clone(), 1..u64::from(u32::MAX), 1..1_000_u64, any::<u64>()).prop_map(
            move |(stream, first, count, time_before)| {
                let block = EventBlockRef { first_sequence: first, count, time_before, bytes };
                Frame::Events { stream, block }
            }
        ),
        (stream.clone(), 1..1_000_u64, any::<u32>(), any::<[u8; 3]>()).prop_map(
            move |(stream, first, length, context)| {
                let block =
                    EventBlockRef { first_sequence: first, count: 3, time_before: first, bytes };
                Frame::Coded { context: ContextId(context), length, stream, block }
            }
        ),
    ];
    prop_oneof![
        events,
        beside(bytes),
        (stream.clone(), any::<u64>(), any::<bool>(), any::<[u64; 2]>()).prop_map(
            move |(stream, head, is_over, [last, hash])| {
                let chain = (last % 2 == 1).then_some(EventHash { last, hash });
                Frame::Status { stream, head, is_over, state: bytes, chain }
            }
        ),
        part.clone().prop_map(move |(stream, sequence, _, offset)| {
            Frame::Snapshot { stream, sequence, length: offset + length, offset, bytes }
        }),
        part.prop_map(move |(stream, first, time_before, offset)| {
            let packing = match first % 3 {
                0 => Packing::Plain,
                1 => Packing::Deflated,
                _ => Packing::Coded { context: ContextId([7; 3]), length },
            };
            let length = offset + length;
            Frame::Large { stream, first, time_before, packing, length, offset, bytes }
        }),
        any::<(u8, [u8; 32])>().prop_map(|(id, key)| Frame::NewKey {
            id: KeyId(id),
            key: PairingKey::from_bytes(key)
        }),
        command(bytes),
        (any::<u32>(), any::<[u64; 4]>()).prop_map(
            |(start, [number, newest_ms, held_ms, late_ms])| {
                Frame::Heard { start: Generation(start), number, newest_ms, held_ms, late_ms }
            }
        ),
        received(),
    ]
}

fn received<'b>() -> impl Strategy<Value = Frame<'b>> {
    let offers = (prop::option::of(context()), prop::option::of(context()));
    (any::<u32>(), any::<(bool, u64)>(), ranges(40), offers).prop_map(
        |(stream, (is_over, safe), events, (context, snapshot))| {
            let (stream, events) = (StreamId(stream), newest(&events));
            let snapshot = snapshot.map(|name| ContextName { first: name.last, ..name });
            let partial = PartialEvent { first: safe, length: stream.0, here: newest(&events) };
            let partial = vec![partial; usize::try_from(safe % 5).expect("few")];
            Frame::Received(Received { stream, is_over, safe, events, context, snapshot, partial })
        },
    )
}

/// A frame about neither events nor commands.
fn beside(bytes: &[u8]) -> impl Strategy<Value = Frame<'_>> {
    prop_oneof![
        any::<u64>().prop_map(|began_ms| Frame::Calendar { began_ms }),
        value_frame(bytes).prop_map(Frame::Value),
        any::<(u32, u64, u32, [u8; 3])>().prop_map(move |(stream, sequence, length, context)| {
            let (context, stream) = (ContextId(context), StreamId(stream));
            Frame::CodedSnapshot { context, stream, sequence, length, bytes }
        }),
    ]
}

fn value_frame(bytes: &[u8]) -> impl Strategy<Value = ValueFrame<'_>> {
    let length = u32::try_from(bytes.len()).expect("few");
    let (stream, id) = (any::<u32>().prop_map(StreamId), any::<[u8; 16]>().prop_map(ValueId));
    let value = (stream.clone(), any::<u64>(), id.clone())
        .prop_map(|(stream, number, id)| ValueName { stream, number, id });
    let why = prop::sample::select(vec![NoValue::Gone, NoValue::OverBudget]);
    prop_oneof![
        (id.clone(), 0..u64::MAX / 2).prop_map(move |(id, offset)| {
            ValueFrame::ValuePart(ValuePart { id, offset, bytes })
        }),
        (id, why).prop_map(|(id, why)| ValueFrame::NoValue(id, why)),
        (stream.clone(), any::<u64>()).prop_map(move |(stream, number)| {
            ValueFrame::Watched(Watched { stream, number, values: bytes })
        }),
        (value, any::<u64>(), ranges(40)).prop_map(|(value, budget, here)| {
            ValueFrame::Fetch(Fetch { value, budget, here: newest(&here) })
        }),
        (stream, any::<u64>(), 0..1_000_u32).prop_map(move |(stream, number, offset)| {
            let length = offset + length;
            ValueFrame::Watch(WatchPart { stream, number, length, offset, bytes })
        }),
    ]
}

fn context() -> impl Strategy<Value = ContextName> {
    (1..1_000_u64, 0..1_000_u64, any::<[u8; 8]>()).prop_map(|(first, more, hash)| ContextName {
        first,
        last: first + more,
        hash,
    })
}

/// Chooses frames for bytes that are known only then.
fn runner(seed: [u8; 32]) -> TestRunner {
    TestRunner::new_with_rng(Config::default(), TestRng::from_seed(RngAlgorithm::ChaCha, &seed))
}

/// What a report has room for.
fn newest(events: &RangeSet) -> RangeSet {
    let mut some = RangeSet::up_to(events.contiguous());
    let ahead = events.ranges().filter(|range| *range.start() > 1);
    for range in ahead.rev().take(RANGES_MAX) {
        some.insert(range);
    }
    some
}

proptest! {
    #[test]
    fn frames_are_read_as_they_were_written(
        at_ms in any::<u64>(), bytes in prop::collection::vec(bytes(), 1..6), seed in any::<[u8; 32]>(),
    ) {
        let mut runner = runner(seed);
        let frames: Vec<Frame<'_>> = bytes
            .iter()
            .map(|bytes| frame(bytes).new_tree(&mut runner).expect("a frame").current())
            .collect();
        let mut payload = Vec::new();
        write_number(at_ms, &mut payload);
        for frame in &frames {
            frame.write(&mut payload);
        }
        let (read_at, read) = read_payload(&payload).expect("a time");
        prop_assert_eq!(read_at, at_ms);
        prop_assert_eq!(read.collect::<Result<Vec<_>, _>>(), Ok(frames));
    }

    #[test]
    fn whatever_is_in_a_datagram_ends_with_the_first_broken_frame(
        payload in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        if let Ok((_, frames)) = read_payload(&payload) {
            let frames: Vec<_> = frames.collect();
            prop_assert!(frames.iter().rev().skip(1).all(Result::is_ok));
        }
    }

    #[test]
    fn a_changed_byte_gives_a_frame_or_an_error(
        bytes in bytes(), at in any::<prop::sample::Index>(), to in any::<u8>(), seed in any::<[u8; 32]>(),
    ) {
        let mut runner = runner(seed);
        let frame = frame(&bytes).new_tree(&mut runner).expect("a frame").current();
        let mut payload = vec![0];
        frame.write(&mut payload);
        let at = at.index(payload.len());
        payload[at] = to;
        if let Ok((_, frames)) = read_payload(&payload) {
            let _read = frames.count();
        }
    }
}

/// What is wrong with a payload, whose time is already written.
fn broken(frame: &[u8]) -> String {
    let payload = [&[0], frame].concat();
    let (_, frames) = read_payload(&payload).expect("a time");
    match frames.collect::<Result<Vec<_>, BrokenFrame>>() {
        Ok(frames) => format!("{frames:?}"),
        Err(broken) => broken.to_string(),
    }
}

#[test]
fn a_broken_frame_says_what_is_wrong_with_it() {
    let far = [0xff; 9].as_slice();
    let cases: &[&[u8]] = &[
        &[99],
        &[1, 1],
        &[1, 1, 0, 1, 0, 0],
        &[1, 1, 1, 0, 0, 0],
        &[&[1, 1], far, &[1, 1, 0, 0]].concat(),
        &[&[1], far, far].concat(),
        &[2, 1, 5, 2, 0],
        &[3, 1, 5, 2, 1, 2, 0, 0],
        &[4, 1, 5, 0, 9, 0, 200],
        &[&[5], [0; 16].as_slice(), &[9]].concat(),
        &[18, 1, 0, 5, 5, 17],
        &[18, 1, 2, 5, 5, 0],
        &[18, 1, 0, 5, 5, 0, 1, 7, 6, 0, 0, 0, 0, 0, 0, 0, 0],
        &[12, 7, 7, 7, 1, 0, 3, 0, 9, 0],
        &[12, 7, 7],
        &[4, 1, 0, 0, 0, 0, 0],
        &[&[13], [0; 16].as_slice(), far, &[1, 1, 7]].concat(),
        &[&[14], [0; 16].as_slice(), &[2]].concat(),
        &[20, 1, 1, 3, 2, 2, 0, 0],
    ];
    let said: Vec<_> = cases.iter().map(|case| broken(case)).collect();
    expect![[r"
        a frame of the link is broken: an unknown kind
        a frame of the link is broken: it ends too early
        a frame of the link is broken: impossible numbers of events
        a frame of the link is broken: impossible numbers of events
        a frame of the link is broken: impossible numbers of events
        a frame of the link is broken: a number is too large
        a frame of the link is broken: neither yes nor no
        a frame of the link is broken: a part reaches beyond its whole
        a frame of the link is broken: an unknown packing of an event
        a frame of the link is broken: an unknown state of a command
        a frame of the link is broken: too many ranges
        a frame of the link is broken: neither yes nor no
        a frame of the link is broken: impossible numbers of events
        a frame of the link is broken: impossible numbers of events
        a frame of the link is broken: it ends too early
        a frame of the link is broken: impossible numbers of events
        a frame of the link is broken: a number is too large
        a frame of the link is broken: an unknown reason why a value does not come
        a frame of the link is broken: a part reaches beyond its whole"]]
    .assert_eq(&said.join("\n"));
}

#[test]
fn a_report_names_the_newest_ranges() {
    let mut events = RangeSet::up_to(10);
    for nth in 0..20 {
        events.insert(20 + nth * 10..=22 + nth * 10);
    }
    let mut out = Vec::new();
    let (stream, context, snapshot) = (StreamId(3), None, None);
    let partial = Vec::new();
    let received = Received { stream, is_over: true, safe: 7, events, context, snapshot, partial };
    write_received(&received, &mut out);
    expect!["[12 03 01 07 0a 10 32 02 08 02 08 02 08 02 08 02 08 02 08 02 08 02 08 02 08 02 08 02 08 02 08 02 08 02 08 02 08 02 00]"]
        .assert_eq(&format!("{out:02x?}").replace(", ", " "));
}

#[test]
fn a_report_has_the_newest_ranges_up_to_the_bound_and_one_with_more_is_broken() {
    let mut events = RangeSet::up_to(1);
    let count = RANGES_MAX as u64;
    (1..=count + 1).for_each(|nth| events.insert(nth * 10..=nth * 10));
    let received = |events: &RangeSet| {
        let (stream, events) = (StreamId(1), events.clone());
        Received {
            stream,
            is_over: false,
            safe: 0,
            events,
            context: None,
            snapshot: None,
            partial: Vec::new(),
        }
    };
    let mut payload = vec![0];
    Frame::Received(received(&events)).write(&mut payload);
    let frames = read_payload(&payload).expect("a time").1;
    events.remove(10..=10);
    assert_eq!(frames.collect::<Vec<_>>(), [Ok(Frame::Received(received(&events)))]);
    // Behind the time: the tag, the stream, whether it is over, what is safe, what is contiguous, then the number of ranges.
    assert_eq!(payload[6], 16);
    payload[6] = 17;
    let mut frames = read_payload(&payload).expect("a time").1;
    assert_eq!(frames.next(), Some(Err(BrokenFrame("too many ranges"))));
}

#[test]
fn a_brief_command_takes_24_bytes() {
    let id = CommandId::from_brief(*b"123456").expect("an id");
    let (robot_start, not_after_ms) = (Generation(127), 3 * 24 * 3_600_000);
    let terms = Terms { robot_start, not_after_ms, not_before_ms: 0, epoch: 127 };
    let mut out = Vec::new();
    Frame::Command(Command { id, terms, body: Body::Whole(b"stop, ana.") }).write(&mut out);
    assert_eq!(out.len(), 24);
}
