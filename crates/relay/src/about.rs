//! The description of a run as a stream of short parts: how it was started, then its machines, which travel
//! in parcels of their own unless they are very large.

use rafcon_protocol::Beginning;
use rafcon_protocol::api::RobotMachines;
use rafcon_storage::journal::{About, Hash, Pack, Parcel};

/// The longest part, in bytes: it fits into any datagram.
pub(crate) const PART: usize = 400;
/// Before the bytes of a record: its kind and its length.
pub(crate) const HEAD: usize = 5;
const ABOUT: u8 = 1;
const MACHINE: u8 = 2;
const NAMED: u8 = 3;
const PARCEL: u8 = 4;
const MACHINE_LIST: u8 = 5;
/// Longest content of a parcel in bytes, before compression.
pub(crate) const PARCEL_MAX: usize = 8 << 20;
/// Maximum length of a list of machines in bytes, inflated: 200 paths of usual length fit.
pub(crate) const MACHINE_LIST_MAX: usize = 64 << 10;
/// Maximum length of a description in bytes, deflated and inflated.
const ABOUT_MAX: usize = 64 << 10;
/// Maximum length of a machine outside parcels, deflated and inflated.
pub(crate) const MACHINE_MAX: usize = 64 << 20;

/// One record.
#[derive(Debug)]
pub(crate) enum AboutRecord {
    /// Start parameters of the run.
    About(Box<About>),
    /// A machine that it has.
    Machine(Pack),
    /// The manifest's hash of a machine that it has.
    Named(Hash),
}

/// Parts of a description, without the inputs of the run: they may be long, and no replica is resumed.
pub(crate) fn about_parts(about: &About) -> Vec<Vec<u8>> {
    let about = About { beginning: Beginning::default(), ..about.clone() };
    parts(ABOUT, &serde_json::to_vec(&about).unwrap_or_default())
}

/// Parts of a machine; `None` if it is too long for any station.
pub(crate) fn machine_parts(pack: &Pack) -> Option<Vec<Vec<u8>>> {
    let bytes = pack.to_bytes();
    (bytes.len() <= MACHINE_MAX).then(|| parts(MACHINE, &bytes))
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
    Parcel::from_bytes(&content(PARCEL, record, PARCEL_MAX * 2)?).ok()
}

/// A list of machines as it lies on the disk and is sent; `None` if it is too long.
pub(crate) fn machine_list_bytes(list: &RobotMachines) -> Option<Vec<u8>> {
    let json = serde_json::to_vec(list).ok()?;
    (json.len() <= MACHINE_LIST_MAX).then(|| record(MACHINE_LIST, &json))
}

/// The list of [`machine_list_bytes`].
pub(crate) fn read_machine_list(record: &[u8]) -> Option<RobotMachines> {
    serde_json::from_slice(&content(MACHINE_LIST, record, MACHINE_LIST_MAX)?).ok()
}

/// The inflated content of a complete record of this kind.
fn content(kind: u8, record: &[u8], max: usize) -> Option<Vec<u8>> {
    let ([own_kind, length @ ..], rest) = record.split_first_chunk::<HEAD>()?;
    let is_whole = rest.len() == u32::from_le_bytes(*length) as usize;
    rafcon_link::inflate((*own_kind == kind && is_whole).then_some(rest)?, max)
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
    /// Adds the next part. Returns the record that it completes, if it can be parsed.
    pub(crate) fn take(&mut self, part: &[u8]) -> Taken {
        self.bytes.extend_from_slice(part);
        let Some((&[kind, a, b, c, d], rest)) = self.bytes.split_first_chunk() else {
            return Taken::Part;
        };
        let length = u32::from_le_bytes([a, b, c, d]) as usize;
        let (what, most) = match kind {
            ABOUT => ("description of a run", ABOUT_MAX),
            NAMED => ("name of a machine", PART),
            _ => ("machine of a run", MACHINE_MAX),
        };
        if length > most {
            self.bytes.clear();
            return Taken::TooLong(what, most);
        }
        if rest.len() < length {
            return Taken::Part;
        }
        let Some(bytes) = rest.get(..length).and_then(|packed| rafcon_link::inflate(packed, most))
        else {
            self.bytes.clear();
            return Taken::TooLong(what, most);
        };
        let record = match kind {
            ABOUT => serde_json::from_slice(&bytes).ok().map(AboutRecord::About),
            MACHINE => Pack::from_bytes(&bytes).ok().map(AboutRecord::Machine),
            NAMED => bytes.try_into().ok().map(|hash| AboutRecord::Named(Hash(hash))),
            _ => None,
        };
        self.bytes.clear();
        Taken::Record(record)
    }
}

/// Result of adding a part.
#[derive(Debug)]
pub(crate) enum Taken {
    /// There is more to come.
    Part,
    /// A record of this kind exceeds this many bytes, or cannot be inflated.
    TooLong(&'static str, usize),
    /// A record is complete. `None` if it cannot be parsed.
    Record(Option<AboutRecord>),
}

#[cfg(test)]
mod tests {
    use super::{
        ABOUT, ABOUT_MAX, AboutReader, AboutRecord, MACHINE, MACHINE_MAX, PARCEL_MAX, Taken,
        about_parts, machine_parts, parcel_bytes, parts, read_parcel,
    };
    use rafcon_protocol::Beginning;
    use rafcon_storage::journal::{About, Hash, Manifest, Pack, Parcel};
    use std::collections::BTreeMap;

    fn read(parts: &[Vec<u8>]) -> Taken {
        let mut reader = AboutReader::default();
        let mut taken = parts.iter().map(|part| reader.take(part));
        taken.find(|taken| !matches!(taken, Taken::Part)).unwrap_or(Taken::Part)
    }

    #[test]
    fn a_description_that_inflates_to_more_than_it_may_is_refused() {
        let bomb = parts(ABOUT, &vec![b' '; ABOUT_MAX + 1]);
        assert!(bomb.len() < 3, "{} parts", bomb.len());
        assert!(matches!(read(&bomb), Taken::TooLong(_, ABOUT_MAX)));
        let mut said = bomb;
        said[0][1..5].copy_from_slice(&u32::try_from(ABOUT_MAX + 1).unwrap().to_le_bytes());
        assert!(matches!(read(&said[..1]), Taken::TooLong(_, ABOUT_MAX)));
    }

    #[test]
    fn however_much_a_run_began_with_its_description_is_short() {
        let inputs = vec![("map".to_owned(), vec![0.5; 100_000].into())];
        let beginning = Beginning { inputs, ..Beginning::default() };
        let about = About { id: "a".to_owned(), beginning, ..About::default() };
        let parts = about_parts(&about);
        assert!(parts.len() < 4, "{} parts", parts.len());
        assert!(
            matches!(read(&parts), Taken::Record(Some(AboutRecord::About(read))) if read.id == "a")
        );
    }

    #[test]
    fn a_machine_that_is_too_long_is_neither_sent_nor_taken() {
        let file = vec![0; MACHINE_MAX];
        let fresh = [(Hash::of(b""), file)].into();
        let pack = Pack { manifest: Manifest::default(), fresh };
        assert!(machine_parts(&pack).is_none());
        assert!(machine_parts(&Pack { fresh: BTreeMap::new(), ..pack }).is_some());
        let said = |length: usize| {
            let length = u32::try_from(length).unwrap().to_le_bytes();
            read(&[[&[MACHINE], &length[..]].concat()])
        };
        assert!(matches!(said(MACHINE_MAX), Taken::Part));
        assert!(matches!(said(MACHINE_MAX + 1), Taken::TooLong(_, MACHINE_MAX)));
    }

    #[test]
    fn a_parcel_that_inflates_to_more_than_it_may_is_none() {
        let parcel = |bytes: usize| {
            let fresh = [(Hash::of(b""), vec![0; bytes])].into();
            parcel_bytes(&Parcel::new(&Manifest::default(), None, Vec::new(), fresh))
        };
        let (fits, bomb) = (parcel(PARCEL_MAX), parcel(2 * PARCEL_MAX));
        assert!(bomb.len() < PARCEL_MAX / 100, "{} bytes", bomb.len());
        assert!(read_parcel(&fits).is_some());
        assert!(read_parcel(&bomb).is_none());
    }
}
