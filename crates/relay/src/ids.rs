//! The numbers by which both sides name runs and commands: hashes, so that no one has to agree on them.

use rafcon_link::{BriefId, CommandId, StreamId, ValueId};
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

/// The link's id of the command with this id. For `AUTHOR/` and 12 hexadecimal digits it has six bytes, from which [`own_id`] restores
/// the digits; for any other id it is a hash.
pub(crate) fn command(id: &str) -> CommandId {
    let brief = || {
        let (author, own_id) = id.rsplit_once('/')?;
        let mut brief = brief_id(own_id)?;
        mask(&mut brief, author);
        CommandId::from_brief(brief)
    };
    brief().unwrap_or_else(|| {
        let mut hash = [0; 16];
        hash.copy_from_slice(&blake3::hash(id.as_bytes()).as_bytes()[..16]);
        CommandId(hash)
    })
}

/// The part of a command's id after `AUTHOR/`. `None` if it was hashed.
pub(crate) fn own_id(command: CommandId, author: &str) -> Option<String> {
    let mut brief = command.brief()?;
    mask(&mut brief, author);
    let mut number = [0; 8];
    number[2..].copy_from_slice(&brief);
    Some(format!("{:012x}", u64::from_be_bytes(number)))
}

/// Six bytes from 12 lower-case hexadecimal digits.
fn brief_id(digits: &str) -> Option<BriefId> {
    let is_digit = |digit: u8| matches!(digit, b'0'..=b'9' | b'a'..=b'f');
    let is_brief = digits.len() == 12 && digits.bytes().all(is_digit);
    let number = u64::from_str_radix(digits, 16).ok().filter(|_| is_brief)?;
    let [_, _, brief @ ..] = number.to_be_bytes();
    Some(brief)
}

/// Distinguishes equal ids of two authors. Applied twice, it restores the id.
fn mask(brief: &mut BriefId, author: &str) {
    for (byte, mask) in brief.iter_mut().zip(blake3::hash(author.as_bytes()).as_bytes()) {
        *byte ^= mask;
    }
}

/// By what a value with this hash is asked for.
pub(crate) fn value_id(hash: ContentHash) -> ValueId {
    let mut id = [0; 16];
    id.copy_from_slice(&hash.as_bytes()[..16]);
    ValueId(id)
}

#[cfg(test)]
mod tests {
    use super::{command, own_id};

    #[test]
    fn a_brief_id_has_the_digits_of_the_author() {
        let id = command("ana/0123456789ab");
        assert_eq!(own_id(id, "ana").as_deref(), Some("0123456789ab"));
        assert_ne!(command("bo/0123456789ab"), id);
        for hashed in ["ana/0123456789AB", "ana/0123456789a", "ana/0123456789abc", "0123456789ab"] {
            assert_eq!(own_id(command(hashed), "ana"), None, "{hashed}");
        }
    }
}
