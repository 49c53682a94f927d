//! The machines in the projects of a robot's server, which are likely to be run: found by their files, newest first, and packed as a
//! run would keep them.

use crate::about::PARCEL_MAX;
use crate::parcels::Parcels;
use rafcon_storage::files::HEADER;
use rafcon_storage::journal::Hash;
use rafcon_storage::{Libraries, Packer, Root, load};
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

/// Limit of machines that are sent ahead. The newest are chosen.
const MACHINES_MAX: usize = 16;
/// Limit of their files in bytes.
const BYTES_MAX: usize = PARCEL_MAX;
/// Limit of scanned files and folders.
const ENTRIES_MAX: usize = 50_000;

/// Projects of a server.
#[derive(Debug, Clone, Default)]
pub struct Projects {
    /// The folders with machines.
    pub folders: Vec<PathBuf>,
    /// The folders with libraries.
    pub libraries: Vec<Root>,
}

/// Machines in projects at the last scan.
#[derive(Debug)]
pub(super) struct ProjectMachines {
    projects: Projects,
    seen: Option<(Stamp, Vec<(Stamp, PathBuf)>)>,
    packed: BTreeMap<PathBuf, PackedMachine>,
    /// The hashes of the manifests of those that are sent.
    ahead: Vec<Hash>,
}

#[derive(Debug, Clone)]
struct PackedMachine {
    /// State of its files and of the libraries.
    stamps: (Stamp, Stamp),
    machine: Hash,
    bytes: usize,
}

/// When files changed last, and a hash of which files there are, how long, and when each of them changed.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Stamp {
    newest: (i64, i64),
    files: [u8; 32],
}

impl ProjectMachines {
    pub(super) fn new(projects: Projects) -> Self {
        Self { projects, seen: None, packed: BTreeMap::new(), ahead: Vec::new() }
    }

    /// The hashes of the manifests of those that are sent.
    pub(super) fn ahead(&self) -> &[Hash] {
        &self.ahead
    }

    /// Creates parcels of changed machines. Returns whether there are any.
    pub(super) fn scan(&mut self, parcels: &mut Parcels) -> io::Result<bool> {
        let mut left = ENTRIES_MAX;
        let roots = self.projects.libraries.iter().map(|root| root.dir.clone()).collect::<Vec<_>>();
        let libraries = stamp(&roots, &mut left);
        let mut found = Vec::new();
        for folder in &self.projects.folders {
            find_machines(folder, &roots, &mut left, &mut found);
        }
        found.sort_by(|a, b| b.cmp(a));
        found.truncate(MACHINES_MAX);
        let seen = Some((libraries.clone(), found.clone()));
        if self.seen == seen {
            return Ok(false);
        }
        let (mut room, mut ahead, mut packed) = (BYTES_MAX, Vec::new(), BTreeMap::new());
        for (files, folder) in found {
            let stamps = (files, libraries.clone());
            let before = self.packed.get(&folder).filter(|before| before.stamps == stamps);
            let Some(machine) = (match before {
                Some(before) => Some(before.clone()),
                None => self.pack(&folder, stamps, room, parcels)?,
            }) else {
                continue;
            };
            if machine.bytes <= room {
                room -= machine.bytes;
                ahead.push(machine.machine);
            }
            packed.insert(folder, machine);
        }
        (self.seen, self.packed, self.ahead) = (seen, packed, ahead);
        Ok(true)
    }

    /// Makes a parcel of a machine, if it can be read.
    fn pack(
        &self,
        folder: &Path,
        stamps: (Stamp, Stamp),
        room: usize,
        parcels: &mut Parcels,
    ) -> io::Result<Option<PackedMachine>> {
        let roots = self.projects.libraries.clone();
        let homes = roots.iter().map(|root| real(&root.dir));
        let homes = homes.chain(self.projects.folders.iter().map(|folder| real(folder))).collect();
        let libraries = Libraries::new(roots).within(homes);
        let Ok(loaded) = load(folder, &libraries) else { return Ok(None) };
        let pack = Packer::default().pack(&loaded.machine, Some(&loaded.saved), &libraries);
        let (machine, bytes) = (pack.manifest.hash(), pack.fresh.values().map(Vec::len).sum());
        if bytes <= room {
            parcels.make(&pack)?;
        }
        Ok(Some(PackedMachine { stamps, machine, bytes }))
    }
}

fn real(folder: &Path) -> PathBuf {
    fs::canonicalize(folder).unwrap_or_else(|_gone| folder.to_owned())
}

/// Adds the machines in a folder that are not in `hidden`; a link is not followed.
fn find_machines(
    folder: &Path,
    hidden: &[PathBuf],
    left: &mut usize,
    found: &mut Vec<(Stamp, PathBuf)>,
) {
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop().filter(|_| *left > 0) {
        if folder.join(HEADER).symlink_metadata().is_ok_and(|header| header.is_file()) {
            found.push((stamp(std::slice::from_ref(&folder), left), folder));
            continue;
        }
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            *left = left.saturating_sub(1);
            let name = entry.file_name();
            let is_hidden = name.as_encoded_bytes().starts_with(b".");
            let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
            if is_folder && !is_hidden && !hidden.contains(&entry.path()) {
                open.push(entry.path());
            }
        }
    }
}

/// State of the files in these folders.
fn stamp(folders: &[PathBuf], left: &mut usize) -> Stamp {
    let (mut newest, mut files) = ((0, 0), Vec::new());
    let mut open = folders.to_vec();
    while let Some(folder) = open.pop().filter(|_| *left > 0) {
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            *left = left.saturating_sub(1);
            let Ok(about) = entry.metadata() else { continue };
            if about.is_dir() {
                open.push(entry.path());
                continue;
            }
            let changed = (about.mtime(), about.mtime_nsec());
            newest = newest.max(changed);
            files.push((entry.path(), changed, about.len()));
        }
    }
    files.sort();
    let mut hasher = blake3::Hasher::new();
    for (path, (seconds, nanos), length) in files {
        hasher.update(path.as_os_str().as_encoded_bytes()).update(&[0]);
        hasher.update(&seconds.to_le_bytes()).update(&nanos.to_le_bytes());
        hasher.update(&length.to_le_bytes());
    }
    Stamp { newest, files: *hasher.finalize().as_bytes() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rafcon_storage::config::Naming;
    use rafcon_storage::save;
    use rafcon_testkit::notation;

    fn write(folder: &Path, script: &str) {
        let text = format!("execution ROOT \"M\"\n  script \"{script}\"\n");
        save(&notation::parse(&text).unwrap(), folder, None, Naming::default()).unwrap();
    }

    #[test]
    fn what_is_sent_ahead_has_a_bounded_number_and_size() {
        let place = tempfile::tempdir().unwrap();
        let (project, kept) = (place.path().join("project"), place.path().join("kept"));
        let mut parcels = Parcels::open(&kept).unwrap();
        let folders = vec![project.clone()];
        let mut machines = ProjectMachines::new(Projects { folders, libraries: Vec::new() });
        for number in 0..MACHINES_MAX {
            write(&project.join(number.to_string()), &format!("x = {number}"));
        }
        assert!(machines.scan(&mut parcels).unwrap());
        assert_eq!(machines.ahead().len(), MACHINES_MAX);
        let before = machines.ahead().to_vec();
        write(&project.join("more"), "x = 99");
        assert!(machines.scan(&mut parcels).unwrap());
        assert_eq!(machines.ahead().len(), MACHINES_MAX);
        assert!(!before.contains(&machines.ahead()[0]));
        // The newest one is too large by itself; the others are sent as before.
        write(&project.join("large"), &"#".repeat(BYTES_MAX + 1));
        assert!(machines.scan(&mut parcels).unwrap());
        assert_eq!(machines.ahead().len(), MACHINES_MAX - 1);
        assert_eq!(parcels.all().len(), MACHINES_MAX + 1);
    }

    #[test]
    fn so_many_files_and_folders_are_looked_at() {
        let place = tempfile::tempdir().unwrap();
        for number in 0..10 {
            fs::create_dir(place.path().join(number.to_string())).unwrap();
        }
        write(&place.path().join("9/machine"), "x = 1");
        let found = |left: usize| {
            let (mut left, mut found) = (left, Vec::new());
            find_machines(place.path(), &[], &mut left, &mut found);
            (found.len(), left)
        };
        let (machines, left) = found(ENTRIES_MAX);
        assert_eq!(machines, 1);
        assert_eq!(found(ENTRIES_MAX - left).0, 1);
        assert_eq!(found(10), (0, 0));
    }
}
