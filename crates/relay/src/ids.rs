//! The numbers by which both sides name runs and commands: hashes, so that no one has to agree on them.

use rafcon_link::{CommandId, StreamId, ValueId};
use rafcon_storage::journal::{ContentHash, Hash};

/// Candidate numbers of a run: the robot takes the first unused one.
const NUMBERS: u8 = 8;

/// Candidate streams for the events of the run with this id, the usual one first.
pub(crate) fn streams_of(run: &str) -> impl Iterator<Item = StreamId> {
    (0..NUMBERS).map(move |nth| {
        let mut hasher = blake3::Hasher::new();
        hasher.update(run.as_bytes());
        if nth > 0 {
            hasher.update(&[0, nth]);
        }
        let [a, b, c, d, ..] = *hasher.finalize().as_bytes();
        StreamId(u32::from_be_bytes([a, b, c, d]) & !3 | 1)
    })
}

/// The stream that usually has the events of the run with this id.
pub(crate) fn events_of(run: &str) -> StreamId {
    streams_of(run).next().unwrap_or(StreamId(1))
}

/// True if this is a candidate stream of the run with this id.
pub(crate) fn is_of(events: StreamId, run: &str) -> bool {
    streams_of(run).any(|stream| stream == events)
}

/// Distinguishes runs with the same number.
pub(crate) fn check_of(run: &str) -> u32 {
    let [.., a, b, c, d] = *blake3::hash(run.as_bytes()).as_bytes();
    u32::from_be_bytes([a, b, c, d])
}

/// The description stream of the run with these events.
pub(crate) fn about_beside(events: StreamId) -> StreamId {
    StreamId(events.0 & !3)
}

/// The stream with the events of the run that a stream is about.
pub(crate) fn events_beside(about: StreamId) -> StreamId {
    StreamId(about.0 | 1)
}

pub(crate) fn is_about(stream: StreamId) -> bool {
    stream.0.is_multiple_of(4)
}

/// The parcel with this name.
pub(crate) fn parcel(name: Hash) -> StreamId {
    let [a, b, c, d, ..] = name.0;
    StreamId::of_files(u32::from_be_bytes([a, b, c, d]))
}

/// The command of the envelope with this id.
pub(crate) fn command(envelope: &str) -> CommandId {
    let mut id = [0; 16];
    id.copy_from_slice(&blake3::hash(envelope.as_bytes()).as_bytes()[..16]);
    CommandId(id)
}

/// By what a value with this hash is asked for.
pub(crate) fn value_id(hash: ContentHash) -> ValueId {
    let mut id = [0; 16];
    id.copy_from_slice(&hash.as_bytes()[..16]);
    ValueId(id)
}
