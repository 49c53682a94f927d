//! What is to be known about a run besides its events, as a stream of short parts: how it was started, then its machines, which travel
//! in parcels of their own unless they are very large.

use rafcon_storage::journal::{About, Hash, Pack, Parcel};

/// The longest part, in bytes: it fits into any datagram.
pub(crate) const PART: usize = 400;
/// Before the bytes of a record: its kind and its length.
pub(crate) const HEAD: usize = 5;
const ABOUT: u8 = 1;
const MACHINE: u8 = 2;
const NAMED: u8 = 3;
const PARCEL: u8 = 4;
/// The files of a parcel have so many bytes at most, before they are deflated.
pub(crate) const PARCEL_MAX: usize = 8 << 20;
/// No record is longer, in bytes.
const RECORD_MAX: usize = 256 << 20;

/// One record.
#[derive(Debug)]
pub(crate) enum AboutRecord {
    /// How the run was started.
    About(Box<About>),
    /// A machine that it has.
    Machine(Pack),
    /// The manifest's hash of a machine that it has.
    Named(Hash),
}

/// The parts of a description.
pub(crate) fn about_parts(about: &About) -> Vec<Vec<u8>> {
    parts(ABOUT, &serde_json::to_vec(about).unwrap_or_default())
}

/// The parts of a machine.
pub(crate) fn machine_parts(pack: &Pack) -> Vec<Vec<u8>> {
    parts(MACHINE, &pack.to_bytes())
}

/// The parts of a machine that comes in parcels.
pub(crate) fn named_parts(machine: Hash) -> Vec<Vec<u8>> {
    parts(NAMED, &machine.0)
}

/// A parcel as it lies on the disk and is sent.
pub(crate) fn parcel_bytes(parcel: &Parcel) -> Vec<u8> {
    record(PARCEL, &parcel.to_bytes())
}

/// The parcel of [`parcel_bytes`].
pub(crate) fn read_parcel(record: &[u8]) -> Option<Parcel> {
    let ([PARCEL, length @ ..], rest) = record.split_first_chunk::<HEAD>()? else { return None };
    let is_whole = rest.len() == u32::from_le_bytes(*length) as usize;
    let bytes = rafcon_link::inflate(is_whole.then_some(rest)?, PARCEL_MAX * 2)?;
    Parcel::from_bytes(&bytes).ok()
}

/// The length of the record that begins like this.
pub(crate) fn record_length(part: &[u8]) -> Option<u64> {
    let ([_, length @ ..], _) = part.split_first_chunk::<HEAD>()?;
    Some(u64::from(u32::from_le_bytes(*length)) + HEAD as u64)
}

/// Each record begins with a part of its own.
fn parts(kind: u8, bytes: &[u8]) -> Vec<Vec<u8>> {
    record(kind, bytes).chunks(PART).map(<[u8]>::to_vec).collect()
}

/// Kind, then length, then the bytes, deflated.
fn record(kind: u8, bytes: &[u8]) -> Vec<u8> {
    let packed = rafcon_link::deflate(bytes);
    let mut record = vec![kind];
    record.extend_from_slice(&u32::try_from(packed.len()).unwrap_or(u32::MAX).to_le_bytes());
    record.extend_from_slice(&packed);
    record
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
            NAMED => bytes.try_into().ok().map(|hash| AboutRecord::Named(Hash(hash))),
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
