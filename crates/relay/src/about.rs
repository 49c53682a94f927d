//! What is to be known about a run besides its events, as a stream of short parts: how it was started, then its machines.

use rafcon_storage::journal::{About, Pack};

/// The longest part, in bytes: it fits into any datagram.
const PART: usize = 400;
const ABOUT: u8 = 1;
const MACHINE: u8 = 2;
/// No record is longer, in bytes.
const RECORD_MAX: usize = 256 << 20;

/// One record.
#[derive(Debug)]
pub(crate) enum AboutRecord {
    /// How the run was started.
    About(Box<About>),
    /// A machine that it has.
    Machine(Pack),
}

/// The parts of a description.
pub(crate) fn about_parts(about: &About) -> Vec<Vec<u8>> {
    parts(ABOUT, &serde_json::to_vec(about).unwrap_or_default())
}

/// The parts of a machine.
pub(crate) fn machine_parts(pack: &Pack) -> Vec<Vec<u8>> {
    parts(MACHINE, &pack.to_bytes())
}

/// Each record begins with a part of its own: kind, then length, then its bytes, deflated.
fn parts(kind: u8, bytes: &[u8]) -> Vec<Vec<u8>> {
    let packed = rafcon_link::deflate(bytes);
    let mut record = vec![kind];
    record.extend_from_slice(&u32::try_from(packed.len()).unwrap_or(u32::MAX).to_le_bytes());
    record.extend_from_slice(&packed);
    record.chunks(PART).map(<[u8]>::to_vec).collect()
}

/// Puts records together from parts in order.
#[derive(Debug, Default)]
pub(crate) struct AboutReader {
    bytes: Vec<u8>,
}

impl AboutReader {
    /// Takes the next part; answers the record that is complete with it, if it can be read.
    pub(crate) fn take(&mut self, part: &[u8]) -> Taken {
        self.bytes.extend_from_slice(part);
        let Some((&[kind, a, b, c, d], rest)) = self.bytes.split_first_chunk() else {
            return Taken::Part;
        };
        let length = u32::from_le_bytes([a, b, c, d]) as usize;
        if rest.len() < length && length <= RECORD_MAX {
            return Taken::Part;
        }
        let bytes = rest.get(..length).and_then(|packed| rafcon_link::inflate(packed, RECORD_MAX));
        let record = bytes.and_then(|bytes| match kind {
            ABOUT => serde_json::from_slice(&bytes).ok().map(AboutRecord::About),
            MACHINE => Pack::from_bytes(&bytes).ok().map(AboutRecord::Machine),
            _ => None,
        });
        self.bytes.clear();
        Taken::Record(record)
    }
}

/// What a part has led to.
#[derive(Debug)]
pub(crate) enum Taken {
    /// There is more to come.
    Part,
    /// A record is complete; nothing if it makes no sense here.
    Record(Option<AboutRecord>),
}
