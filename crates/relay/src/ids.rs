//! The numbers by which both sides name runs and commands: hashes, so that no one has to agree on them.

use rafcon_link::{CommandId, StreamId, ValueId};
use rafcon_storage::journal::{ContentHash, Hash};

/// The events of the run with this id.
pub(crate) fn events_of(run: &str) -> StreamId {
    StreamId(hash(run) & !3 | 1)
}

/// What is to be known about the run with this id: a stream that comes before that of its events.
pub(crate) fn about_of(run: &str) -> StreamId {
    StreamId(hash(run) & !3)
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

fn hash(run: &str) -> u32 {
    let [a, b, c, d, ..] = *blake3::hash(run.as_bytes()).as_bytes();
    u32::from_be_bytes([a, b, c, d])
}
