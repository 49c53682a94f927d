//! The parcels of one robot on its station's disk: those that came as a whole, and those that are coming. Whatever the robot sends, they
//! take no more than so much of the disk.

use crate::about::{HEAD, PARCEL_MAX, PART, record_length};
use crate::ids;
use crate::parcels::Parcels;
use rafcon_link::StreamId;
use rafcon_protocol::api::RobotMachines;
use rafcon_storage::journal::{EventBlock, Hash, Pack};
use std::collections::BTreeMap;
use std::fs::{self, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Capacity of a station for each robot: twice that of a robot.
const BOUNDS: ParcelBounds = ParcelBounds { whole: 64, bytes: 32 << 20, coming: 32 };
/// The name of one that is coming begins like this; the number of its stream follows.
const COMING: &str = "coming-";

/// Limits beyond which the oldest parcels are dropped.
#[derive(Debug, Clone, Copy)]
struct ParcelBounds {
    whole: usize,
    bytes: u64,
    /// Limit of parcels in transfer.
    coming: usize,
}

/// The parcels of one robot.
#[derive(Debug)]
pub(super) struct StationParcels {
    folder: PathBuf,
    bounds: ParcelBounds,
    parcels: Parcels,
    /// Received bytes of parcels in transfer.
    coming: BTreeMap<StreamId, u64>,
}

/// A parcel that was here before this start.
#[derive(Debug)]
pub(super) struct RestoredParcel {
    pub(super) stream: StreamId,
    pub(super) parts: u64,
    pub(super) is_whole: bool,
}

/// Result of adding a part.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct TakenPart {
    /// A parcel is here as a whole.
    pub(super) is_whole: bool,
    /// Nothing of these is here any more.
    pub(super) gone: Vec<StreamId>,
}

impl StationParcels {
    pub(super) fn open(folder: &Path) -> io::Result<Self> {
        let parcels = Parcels::open(folder)?;
        let mut coming = BTreeMap::new();
        for entry in fs::read_dir(folder)?.flatten() {
            let name = entry.file_name();
            let number = name.to_str().and_then(|name| name.strip_prefix(COMING));
            let Some(number) = number else { continue };
            let stream = u32::from_str_radix(number, 16).map(StreamId);
            match (stream, entry.metadata()) {
                (Ok(stream), Ok(about)) if coming.len() < BOUNDS.coming => {
                    coming.insert(stream, about.len());
                }
                _ => drop(fs::remove_file(entry.path())),
            }
        }
        let mut parcels = Self { folder: folder.to_owned(), bounds: BOUNDS, parcels, coming };
        // The end of a write may be missing.
        for (stream, bytes) in parcels.coming.clone() {
            let whole = bytes - bytes % PART as u64;
            parcels.coming.insert(stream, whole);
            let file = OpenOptions::new().write(true).open(parcels.path(stream));
            if file.and_then(|file| file.set_len(whole)).is_err() {
                parcels.drop_coming(stream);
            }
        }
        Ok(parcels)
    }

    /// Complete parcels.
    pub(super) fn restored(&self) -> Vec<RestoredParcel> {
        let whole = self.parcels.all().iter().map(|kept| {
            let (stream, parts) = (kept.stream(), kept.parts());
            RestoredParcel { stream, parts, is_whole: true }
        });
        let coming = self.coming.iter().map(|(stream, bytes)| {
            let parts = bytes / PART as u64;
            RestoredParcel { stream: *stream, parts, is_whole: false }
        });
        whole.chain(coming).collect()
    }

    /// Returns the machine of this manifest. `None` if a parcel is missing.
    pub(super) fn pack(&self, machine: Hash) -> Option<Pack> {
        self.parcels.pack(machine)
    }

    /// The list of the robot's machines that came last.
    pub(super) fn machine_list(&self) -> Option<RobotMachines> {
        self.parcels.machine_list()
    }

    /// Takes the next part of a parcel. What makes no sense is not kept.
    pub(super) fn take(&mut self, stream: StreamId, part: &EventBlock) -> io::Result<TakenPart> {
        let mut taken = TakenPart::default();
        let here = self.coming.get(&stream).copied().unwrap_or(0);
        let is_next = (part.first_sequence - 1).checked_mul(PART as u64) == Some(here);
        let least = if part.first_sequence == 1 { HEAD } else { 1 };
        let fits = part.count == 1 && (least..=PART).contains(&part.bytes.len());
        let is_known = self.parcels.all().iter().any(|kept| kept.stream() == stream);
        if is_known || !is_next || !fits {
            return Ok(taken);
        }
        if !self.make_room(stream, part.bytes.len() as u64, &mut taken.gone) {
            self.drop_coming(stream);
            return Ok(taken);
        }
        let path = self.path(stream);
        let mut file = OpenOptions::new().create(true).append(true).open(&path)?;
        if let Err(error) = file.write_all(&part.bytes) {
            // A piece of the part may be there: it is written again as a whole.
            file.set_len(here)?;
            return Err(error);
        }
        let here = here + part.bytes.len() as u64;
        self.coming.insert(stream, here);
        let head = if part.first_sequence == 1 { part.bytes.clone() } else { read_head(&path)? };
        let length = record_length(&head).filter(|length| *length <= 2 * PARCEL_MAX as u64);
        if length.is_some_and(|length| here < length && part.bytes.len() == PART) {
            return Ok(taken);
        }
        if length == Some(here) {
            let bytes = fs::read(&path)?;
            let is_it = ids::parcel(Hash::of(&bytes)) == stream;
            taken.is_whole = is_it && self.parcels.add(&bytes)?.is_some();
            taken.gone.extend(self.parcels.drop_old_lists().iter().map(|kept| kept.stream()));
        }
        self.drop_coming(stream);
        if !taken.is_whole {
            taken.gone.push(stream);
        }
        Ok(taken)
    }

    /// Drops the oldest parcels until this many bytes fit. Returns false if they cannot fit.
    fn make_room(&mut self, stream: StreamId, bytes: u64, gone: &mut Vec<StreamId>) -> bool {
        let bounds = self.bounds;
        while !self.coming.contains_key(&stream) && self.coming.len() >= bounds.coming
            || self.parcels.all().len() >= bounds.whole
            || self.parcels.bytes() + self.coming.values().sum::<u64>() + bytes > bounds.bytes
        {
            let other = self.coming.keys().find(|other| **other != stream).copied();
            if self.coming.len() < bounds.coming
                && let Some(kept) = self.parcels.drop_oldest(|_| true)
            {
                gone.push(kept.stream());
            } else if let Some(other) = other {
                self.drop_coming(other);
                gone.push(other);
            } else {
                return false;
            }
        }
        true
    }

    fn drop_coming(&mut self, stream: StreamId) {
        self.coming.remove(&stream);
        drop(fs::remove_file(self.path(stream)));
    }

    fn path(&self, stream: StreamId) -> PathBuf {
        self.folder.join(format!("{COMING}{:08x}", stream.0))
    }
}

fn read_head(path: &Path) -> io::Result<Vec<u8>> {
    use std::io::Read as _;
    let mut head = vec![0; HEAD];
    fs::File::open(path)?.read_exact(&mut head)?;
    Ok(head)
}

#[cfg(test)]
mod tests {
    use super::{ParcelBounds, RestoredParcel, StationParcels, TakenPart};
    use crate::about::{HEAD, PART};
    use crate::parcels::Parcels;
    use rafcon_link::StreamId;
    use rafcon_protocol::api::{MachineFile, RobotMachines};
    use rafcon_storage::journal::{EventBlock, Pack};
    use rafcon_storage::{Libraries, Packer};
    use rafcon_testkit::notation;
    use std::fs;
    use std::path::Path;

    fn part(first: u64, bytes: Vec<u8>) -> EventBlock {
        EventBlock { first_sequence: first, count: 1, time_before: 0, bytes }
    }

    /// A machine with this number in it, and the parts of its parcel.
    fn machine(number: u64) -> (Pack, StreamId, Vec<EventBlock>) {
        let numbers: Vec<_> = (0..200).map(|at| (number + at) * 7_919 % 10_007).collect();
        let text =
            format!("execution ROOT \"M\"\n  outcome success\n  script |\n    x = {numbers:?}\n");
        let machine = notation::parse(&text).unwrap();
        let pack = Packer::default().pack(&machine, None, &Libraries::default());
        let folder = tempfile::tempdir().unwrap();
        let kept = Parcels::open(folder.path()).unwrap().make(&pack).unwrap().unwrap();
        let parts = (1..=kept.parts()).map(|number| part(number, kept.part(number).unwrap()));
        (pack, kept.stream(), parts.collect())
    }

    fn bytes(folder: &Path) -> u64 {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().metadata().unwrap().len()).sum()
    }

    #[test]
    fn a_parcel_goes_on_after_a_restart_and_is_whole_with_its_last_part() {
        let folder = tempfile::tempdir().unwrap();
        let (pack, stream, parts) = machine(1);
        assert!(parts.len() > 2);
        let mut here = StationParcels::open(folder.path()).unwrap();
        // Parts out of order are dropped.
        assert_eq!(here.take(stream, &parts[1]).unwrap(), TakenPart::default());
        assert_eq!(here.take(stream, &parts[0]).unwrap(), TakenPart::default());
        let mut here = StationParcels::open(folder.path()).unwrap();
        let [RestoredParcel { stream: restored, parts: 1, is_whole: false }] = here.restored()[..]
        else {
            panic!("{:?}", here.restored());
        };
        assert_eq!(restored, stream);
        assert_eq!(here.pack(pack.manifest.hash()), None);
        let taken: Vec<_> =
            parts[1..].iter().map(|part| here.take(stream, part).unwrap()).collect();
        assert_eq!(taken.iter().filter(|taken| taken.is_whole).count(), 1);
        assert_eq!(here.pack(pack.manifest.hash()).as_ref(), Some(&pack));
        let here = StationParcels::open(folder.path()).unwrap();
        assert!(here.restored()[0].is_whole);
        assert_eq!(here.pack(pack.manifest.hash()), Some(pack));
    }

    #[test]
    fn the_list_of_machines_is_the_one_that_came_last() {
        let (folder, robot) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let mut here = StationParcels::open(folder.path()).unwrap();
        let mut at_robot = Parcels::open(robot.path()).unwrap();
        assert_eq!(here.machine_list(), None);
        let mut streams = Vec::new();
        for made_ms in [7, 5] {
            let file = MachineFile { project: "missions".to_owned(), path: "drive".to_owned() };
            let list = RobotMachines { made_ms, machines: vec![file], more: 0 };
            let kept = at_robot.add_list(&list).unwrap().unwrap();
            let taken = here.take(kept.stream(), &part(1, kept.part(1).unwrap())).unwrap();
            assert_eq!(taken, TakenPart { is_whole: true, gone: streams.clone() });
            streams.push(kept.stream());
            assert_eq!(here.machine_list().as_ref(), Some(&list));
            assert_eq!(StationParcels::open(folder.path()).unwrap().machine_list(), Some(list));
        }
    }

    #[test]
    fn what_is_not_what_its_name_says_is_not_kept() {
        let folder = tempfile::tempdir().unwrap();
        let (pack, stream, mut parts) = machine(1);
        parts[1].bytes[7] ^= 1;
        let mut here = StationParcels::open(folder.path()).unwrap();
        let taken: Vec<_> = parts.iter().map(|part| here.take(stream, part).unwrap()).collect();
        assert_eq!(taken.last().unwrap().gone, [stream]);
        assert_eq!(here.pack(pack.manifest.hash()), None);
        let long = [vec![4], u32::MAX.to_le_bytes().to_vec(), vec![7; PART - HEAD]].concat();
        assert_eq!(here.take(StreamId(2), &part(1, long)).unwrap().gone, [StreamId(2)]);
        assert_eq!(bytes(folder.path()), 0);
    }

    #[test]
    fn a_robot_that_sends_without_end_fills_no_disk() {
        let folder = tempfile::tempdir().unwrap();
        let mut here = StationParcels::open(folder.path()).unwrap();
        let bounds = ParcelBounds { whole: 4, bytes: 20_000, coming: 3 };
        here.bounds = bounds;
        // Whole ones: the oldest go.
        let mut all_gone = Vec::new();
        let streams: Vec<_> = (0..6)
            .map(|number| {
                let (_, stream, parts) = machine(number * 1_000);
                all_gone
                    .extend(parts.iter().flat_map(|part| here.take(stream, part).unwrap().gone));
                stream
            })
            .collect();
        assert_eq!(all_gone, streams[..2]);
        // Many that never end, then a few that are long.
        let head = [vec![4], (15_u32 << 20).to_le_bytes().to_vec(), vec![7; PART - HEAD]].concat();
        for number in 0..9 {
            here.take(StreamId(number * 4 + 2), &part(1, head.clone())).unwrap();
            assert!(here.coming.len() <= bounds.coming);
        }
        for number in 0..4 {
            let stream = StreamId(number * 4 + 1_000_002);
            here.take(stream, &part(1, head.clone())).unwrap();
            for first in 2..=60 {
                here.take(stream, &part(first, vec![7; PART])).unwrap();
                assert!(bytes(folder.path()) <= bounds.bytes);
            }
        }
    }
}
