//! Machines by the hash of their files, on the disk of either side of a link: parcels that never change, each a file with its hash in
//! its name. The robot sends what lies here, and the station keeps it as it comes.
//!
//! Depends on files and parcels, but not on sessions or requests.

use crate::about::{PART, machine_list_bytes, parcel_bytes, read_machine_list, read_parcel};
use crate::ids;
use rafcon_link::StreamId;
use rafcon_protocol::api::RobotMachines;
use rafcon_storage::journal::folder::replace_file;
use rafcon_storage::journal::{Hash, Manifest, Pack, Parcel};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::FileExt as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Limit of parcels that one parcel depends on.
const NEEDS_MAX: usize = 8;

/// Metadata of a parcel.
#[derive(Debug)]
pub(crate) struct Kept {
    /// The hash of its bytes.
    pub(crate) name: Hash,
    pub(crate) length: u64,
    /// It was here before this start.
    pub(crate) is_old: bool,
    /// The hash of the machine's manifest. `None` for a list of machines.
    pub(crate) machine: Option<Hash>,
    is_list: bool,
    pub(crate) needs: Vec<Hash>,
    base: Option<Hash>,
    /// The files that it brings.
    files: BTreeSet<Hash>,
    path: PathBuf,
}

/// All parcels of a side, oldest first.
#[derive(Debug)]
pub(crate) struct Parcels {
    folder: PathBuf,
    all: Vec<Arc<Kept>>,
    next: u64,
}

impl Kept {
    pub(crate) fn stream(&self) -> StreamId {
        ids::parcel(self.name)
    }

    /// Number of its parts.
    pub(crate) fn parts(&self) -> u64 {
        self.length.div_ceil(PART as u64)
    }

    /// Its part of this number, from 1.
    pub(crate) fn part(&self, number: u64) -> Option<Vec<u8>> {
        let offset = number.checked_sub(1)?.checked_mul(PART as u64)?;
        let left = self.length.checked_sub(offset).filter(|left| *left > 0)?;
        let mut part = vec![0; usize::try_from(left).unwrap_or(PART).min(PART)];
        File::open(&self.path).ok()?.read_exact_at(&mut part, offset).ok()?;
        Some(part)
    }

    fn read(&self) -> Option<Parcel> {
        let bytes = fs::read(&self.path).ok()?;
        (Hash::of(&bytes) == self.name).then(|| read_parcel(&bytes))?
    }
}

impl Parcels {
    /// Those in this folder. What is damaged goes: it is made or comes again.
    pub(crate) fn open(folder: &Path) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let mut found = BTreeMap::new();
        for (number, (hash, path)) in files(folder)? {
            let kept = fs::read(&path).ok().and_then(|bytes| kept(&bytes, &path));
            match kept.filter(|kept| kept.name == hash) {
                Some(kept) => {
                    found.insert(number, Arc::new(Kept { is_old: true, ..kept }));
                }
                None => drop(fs::remove_file(&path)),
            }
        }
        let next = found.last_key_value().map_or(1, |(number, _)| number + 1);
        Ok(Self { folder: folder.to_owned(), all: found.into_values().collect(), next })
    }

    pub(crate) fn all(&self) -> &[Arc<Kept>] {
        &self.all
    }

    pub(crate) fn bytes(&self) -> u64 {
        self.all.iter().map(|kept| kept.length).sum()
    }

    /// The parcel with this machine.
    pub(crate) fn of_machine(&self, machine: Hash) -> Option<&Arc<Kept>> {
        self.all.iter().find(|kept| kept.machine == Some(machine))
    }

    pub(crate) fn find(&self, name: Hash) -> Option<&Arc<Kept>> {
        self.all.iter().find(|kept| kept.name == name)
    }

    /// The list of machines that came last.
    pub(crate) fn machine_list(&self) -> Option<RobotMachines> {
        let Kept { name, path, .. } = &**self.newest_list()?;
        read_list_file(*name, path)
    }

    fn newest_list(&self) -> Option<&Arc<Kept>> {
        self.all.iter().rev().find(|kept| kept.is_list)
    }

    /// Stores a list of machines. `None` if it is too long.
    pub(crate) fn add_list(&mut self, list: &RobotMachines) -> io::Result<Option<Arc<Kept>>> {
        machine_list_bytes(list).map_or(Ok(None), |bytes| self.add(&bytes))
    }

    /// Drops all lists of machines but the one that came last.
    pub(crate) fn drop_old_lists(&mut self) -> Vec<Arc<Kept>> {
        let newest = self.newest_list().map(|kept| kept.name);
        let is_old = |kept: &Kept| kept.is_list && Some(kept.name) != newest;
        std::iter::from_fn(|| self.drop_oldest(is_old)).collect()
    }

    /// Stores the bytes of a parcel. `None` if they are invalid.
    pub(crate) fn add(&mut self, bytes: &[u8]) -> io::Result<Option<Arc<Kept>>> {
        let path = self.folder.join(format!("{:010}-{}", self.next, Hash::of(bytes)));
        let Some(kept) = kept(bytes, &path) else { return Ok(None) };
        if let Some(before) = self.find(kept.name) {
            return Ok(Some(Arc::clone(before)));
        }
        replace_file(&path, bytes).map_err(io::Error::other)?;
        self.next += 1;
        let kept = Arc::new(kept);
        self.all.push(Arc::clone(&kept));
        Ok(Some(kept))
    }

    /// Drops the oldest parcel that may go.
    pub(crate) fn drop_oldest(&mut self, may_go: impl Fn(&Kept) -> bool) -> Option<Arc<Kept>> {
        let place = self.all.iter().position(|kept| may_go(kept))?;
        let kept = self.all.remove(place);
        // If it stays, the next start finds it.
        drop(fs::remove_file(&kept.path));
        Some(kept)
    }

    /// Drops parcels with a missing dependency. They are created again on demand.
    pub(crate) fn drop_incomplete(&mut self) {
        let has = |parcels: &Self, name: &Hash| parcels.find(*name).is_some();
        while let Some(place) =
            self.all.iter().position(|kept| !kept.needs.iter().all(|name| has(self, name)))
        {
            drop(fs::remove_file(&self.all.remove(place).path));
        }
    }

    /// Makes a parcel of what no other has of a machine, all of whose files are in the pack; the one that is here already, if there is one.
    pub(crate) fn make(&mut self, pack: &Pack) -> io::Result<Option<Arc<Kept>>> {
        if let Some(kept) = self.of_machine(pack.manifest.hash()) {
            return Ok(Some(Arc::clone(kept)));
        }
        let (needs, fresh) = self.others(&pack.fresh);
        let base = needs.first().and_then(|name| self.find(*name));
        let base = base.map(|kept| kept.base.unwrap_or(kept.name));
        let base = base.and_then(|name| {
            let parcel = self.find(name)?.read().filter(|parcel| parcel.base.is_none())?;
            Some((name, parcel.manifest(Manifest::default())?))
        });
        let base = base.as_ref().map(|(name, manifest)| (*name, manifest));
        self.add(&parcel_bytes(&Parcel::new(&pack.manifest, base, needs, fresh)))
    }

    /// The parcels that have most of these files, and the files that they do not have.
    fn others(&self, files: &BTreeMap<Hash, Vec<u8>>) -> (Vec<Hash>, BTreeMap<Hash, Vec<u8>>) {
        let (mut needs, mut missing) = (Vec::new(), files.clone());
        let mut after_first = None;
        loop {
            let count =
                |kept: &Kept| kept.files.iter().filter(|it| missing.contains_key(it)).count();
            let best =
                self.all.iter().map(|kept| (count(kept), kept)).max_by_key(|(count, _)| *count);
            let Some((_, best)) = best.filter(|(count, _)| *count > 0) else { break };
            if needs.len() == NEEDS_MAX {
                // Many small ones: what they have becomes one.
                return after_first.unwrap_or((needs, missing));
            }
            needs.push(best.name);
            missing.retain(|hash, _| !best.files.contains(hash));
            after_first.get_or_insert_with(|| (needs.clone(), missing.clone()));
        }
        (needs, missing)
    }

    /// Returns the machine of this manifest with all files. `None` if a file is missing.
    pub(crate) fn pack(&self, machine: Hash) -> Option<Pack> {
        let parcel = self.of_machine(machine)?.read()?;
        let base = match parcel.base {
            Some(name) => {
                let base = self.find(name)?.read().filter(|parcel| parcel.base.is_none())?;
                base.manifest(Manifest::default())?
            }
            None => Manifest::default(),
        };
        let manifest = parcel.manifest(base)?;
        let mut fresh = parcel.fresh;
        let files: BTreeSet<Hash> = manifest.files().iter().map(|(_, hash)| *hash).collect();
        let is_missing = |fresh: &BTreeMap<Hash, Vec<u8>>, hash| {
            files.contains(hash) && !fresh.contains_key(hash)
        };
        for kept in &self.all {
            if kept.files.iter().any(|hash| is_missing(&fresh, hash)) {
                fresh.extend(kept.read()?.fresh);
            }
        }
        fresh.retain(|hash, _| files.contains(hash));
        (fresh.len() == files.len()).then_some(Pack { manifest, fresh })
    }
}

fn kept(bytes: &[u8], path: &Path) -> Option<Kept> {
    let mut kept = Kept {
        name: Hash::of(bytes),
        length: bytes.len() as u64,
        is_old: false,
        machine: None,
        is_list: read_machine_list(bytes).is_some(),
        needs: Vec::new(),
        base: None,
        files: BTreeSet::new(),
        path: path.to_owned(),
    };
    if kept.is_list {
        return Some(kept);
    }
    let Parcel { machine, base, needs, fresh, .. } = read_parcel(bytes)?;
    (kept.machine, kept.needs, kept.base) = (Some(machine), needs, base);
    kept.files = fresh.into_keys().collect();
    Some(kept)
}

/// The list of machines that came last into the folder of a station's parcels. Changes nothing.
pub(crate) fn stored_machine_list(folder: &Path) -> io::Result<Option<RobotMachines>> {
    let files = match files(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        files => files?,
    };
    Ok(files.values().rev().find_map(|(hash, path)| read_list_file(*hash, path)))
}

/// The list of machines in the file of a parcel with this hash.
fn read_list_file(hash: Hash, path: &Path) -> Option<RobotMachines> {
    let bytes = fs::read(path).ok().filter(|bytes| Hash::of(bytes) == hash)?;
    read_machine_list(&bytes)
}

/// The files of parcels in a folder by their numbers, each with the hash in its name.
fn files(folder: &Path) -> io::Result<BTreeMap<u64, (Hash, PathBuf)>> {
    let parcel = |entry: fs::DirEntry| {
        let (number, hash) = read_name(entry.file_name().to_str()?)?;
        Some((number, (hash, entry.path())))
    };
    Ok(fs::read_dir(folder)?.flatten().filter_map(parcel).collect())
}

fn read_name(name: &str) -> Option<(u64, Hash)> {
    let (number, hash) = name.split_once('-')?;
    Some((number.parse().ok()?, Hash::parse(hash)?))
}

#[cfg(test)]
mod tests {
    use super::{NEEDS_MAX, Parcels};
    use rafcon_storage::journal::Pack;
    use rafcon_storage::{Libraries, Packer};
    use rafcon_testkit::notation;
    use std::fs;

    /// A machine with these scripts.
    fn machine(scripts: &[String]) -> Pack {
        let state = |(number, script): (usize, &String)| {
            format!(
                "  execution STATE{number} \"S\"\n    outcome done\n    script |\n      {script}\n"
            )
        };
        let states: String = scripts.iter().enumerate().map(state).collect();
        let text = format!("hierarchy ROOT \"M\"\n  outcome success\n  start -> STATE0\n{states}");
        let machine = notation::parse(&text).unwrap();
        Packer::default().pack(&machine, None, &Libraries::default())
    }

    fn scripts(count: usize) -> Vec<String> {
        (0..count).map(|number| format!("x = {number}")).collect()
    }

    #[test]
    fn an_edit_makes_a_parcel_of_what_was_edited_and_everything_comes_back_after_a_restart() {
        let folder = tempfile::tempdir().unwrap();
        let mut parcels = Parcels::open(folder.path()).unwrap();
        let mut scripts = scripts(30);
        let mut packs = vec![machine(&scripts)];
        for edit in 0..2 * NEEDS_MAX {
            scripts[edit] += " # edited";
            packs.push(machine(&scripts));
        }
        let made = packs.iter().map(|pack| parcels.make(pack).unwrap().unwrap());
        let made: Vec<_> = made.collect();
        assert_eq!(made[1].files.len(), 1);
        assert!(made[1].length < made[0].length / 3, "{} of {}", made[1].length, made[0].length);
        // Merges many small parcels into one.
        assert_eq!(made[NEEDS_MAX].files.len(), 1);
        assert_eq!(made[NEEDS_MAX + 1].files.len(), NEEDS_MAX + 1);
        assert!(made.iter().all(|kept| kept.needs.len() <= NEEDS_MAX));
        assert_eq!(parcels.make(&packs[1]).unwrap().unwrap().name, made[1].name);
        let parcels = Parcels::open(folder.path()).unwrap();
        for pack in packs {
            assert_eq!(parcels.pack(pack.manifest.hash()), Some(pack));
        }
    }

    #[test]
    fn what_needs_a_parcel_that_is_gone_is_made_again() {
        let folder = tempfile::tempdir().unwrap();
        let mut parcels = Parcels::open(folder.path()).unwrap();
        let mut scripts = scripts(9);
        parcels.make(&machine(&scripts)).unwrap();
        scripts[3] += " # edited";
        let edited = machine(&scripts);
        parcels.make(&edited).unwrap();
        parcels.drop_oldest(|_| true).unwrap();
        parcels.drop_incomplete();
        assert_eq!(parcels.all().len(), 0);
        parcels.make(&edited).unwrap();
        assert_eq!(parcels.pack(edited.manifest.hash()), Some(edited));
    }

    #[test]
    fn a_damaged_parcel_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let mut parcels = Parcels::open(folder.path()).unwrap();
        let pack = machine(&scripts(3));
        let kept = parcels.make(&pack).unwrap().unwrap();
        let mut bytes = fs::read(&kept.path).unwrap();
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        fs::write(&kept.path, &bytes).unwrap();
        assert_eq!(parcels.pack(pack.manifest.hash()), None);
        assert_eq!(Parcels::open(folder.path()).unwrap().all().len(), 0);
        assert!(!kept.path.exists());
    }

    #[test]
    fn a_file_that_two_machines_have_is_kept_once() {
        let folder = tempfile::tempdir().unwrap();
        let mut parcels = Parcels::open(folder.path()).unwrap();
        let numbers: Vec<_> = (0..3_000).map(|number| number * 7_919 % 10_007).collect();
        let shared = format!("x = {numbers:?}");
        let first = parcels.make(&machine(&["a = 1".to_owned(), shared.clone()])).unwrap().unwrap();
        let other = machine(&["b = 2".to_owned(), "c = 3".to_owned(), shared]);
        let second = parcels.make(&other).unwrap().unwrap();
        assert_eq!(second.needs, [first.name]);
        assert!(second.length < first.length / 4, "{} of {}", second.length, first.length);
        assert_eq!(parcels.pack(other.manifest.hash()), Some(other));
    }
}
