//! The machines in the projects of a robot's server, which are likely to be run: found by their files, newest first, and packed as a
//! run would keep them.

use crate::about::{PARCEL_MAX, machine_list_bytes};
use crate::parcels::Parcels;
use rafcon_protocol::api::{MachineFile, RobotMachines};
use rafcon_storage::files::HEADER;
use rafcon_storage::journal::Hash;
use rafcon_storage::{Libraries, Packer, Root, load};
use rafcon_supervisor::clock;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

/// Limit of machines that are sent ahead. The newest are chosen.
const MACHINES_MAX: usize = 16;
/// Limit of machines that are listed. The newest are chosen.
const LISTED_MAX: usize = 200;
/// Limit of the files that are sent ahead, in bytes.
const BYTES_MAX: usize = PARCEL_MAX;
/// Limit of scanned files and folders.
const ENTRIES_MAX: usize = 50_000;

/// A project of a server.
#[derive(Debug, Clone)]
pub struct ProjectFolder {
    /// Id of the project at the server.
    pub id: String,
    /// The folder with its machines.
    pub folder: PathBuf,
}

/// Projects of a server.
#[derive(Debug, Clone, Default)]
pub struct Projects {
    /// The folders with machines.
    pub folders: Vec<ProjectFolder>,
    /// The folders with libraries.
    pub libraries: Vec<Root>,
}

/// Machines in projects at the last scan.
#[derive(Debug)]
pub(super) struct ProjectMachines {
    projects: Projects,
    seen: Option<(Stamp, Vec<FoundMachine>)>,
    /// The name of the parcel with the list of all machines.
    list: Option<Hash>,
    packed: BTreeMap<PathBuf, PackedMachine>,
    /// The hashes of the manifests of those that are sent.
    ahead: Vec<Hash>,
}

/// A folder with a machine, ordered by its last change.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct FoundMachine {
    files: Stamp,
    folder: PathBuf,
    /// Id of its project.
    project: String,
    /// Path from the project's folder.
    path: String,
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
        Self { projects, seen: None, list: None, packed: BTreeMap::new(), ahead: Vec::new() }
    }

    /// The name of the parcel with the list of all machines.
    pub(super) fn list(&self) -> Option<Hash> {
        self.list
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
        for project in &self.projects.folders {
            find_machines(project, &roots, &mut left, &mut found);
        }
        found.sort_by(|a, b| b.cmp(a));
        if self.seen.as_ref().is_some_and(|(before, seen)| (before, seen) == (&libraries, &found)) {
            return Ok(false);
        }
        self.list_machines(&found, parcels)?;
        let seen = Some((libraries.clone(), found.clone()));
        found.truncate(MACHINES_MAX);
        let (mut room, mut ahead, mut packed) = (BYTES_MAX, Vec::new(), BTreeMap::new());
        for FoundMachine { files, folder, .. } in found {
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

    /// Makes a parcel of the list of these machines, if it is another one than before.
    fn list_machines(&mut self, found: &[FoundMachine], parcels: &mut Parcels) -> io::Result<()> {
        let file = |machine: &FoundMachine| MachineFile {
            project: machine.project.clone(),
            path: machine.path.clone(),
        };
        let before = parcels.machine_list().unwrap_or_default();
        let mut list = RobotMachines {
            made_ms: clock::since_1970_ms().max(before.made_ms + 1),
            machines: found.iter().take(LISTED_MAX).map(file).collect(),
            more: u32::try_from(found.len().saturating_sub(LISTED_MAX)).unwrap_or(u32::MAX),
        };
        // Long paths: fewer are listed.
        while machine_list_bytes(&list).is_none() && list.machines.pop().is_some() {
            list.more = list.more.saturating_add(1);
        }
        if (&list.machines, list.more) == (&before.machines, before.more) {
            list.made_ms = before.made_ms;
        }
        let kept = parcels.add_list(&list)?;
        self.list = kept.map(|kept| kept.name);
        parcels.drop_old_lists();
        Ok(())
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
        let projects = self.projects.folders.iter().map(|project| real(&project.folder));
        let homes = homes.chain(projects).collect();
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

/// Adds the machines in a project that are not in `hidden`; a link is not followed. A path that is no text is skipped.
fn find_machines(
    project: &ProjectFolder,
    hidden: &[PathBuf],
    left: &mut usize,
    found: &mut Vec<FoundMachine>,
) {
    let mut open = vec![project.folder.clone()];
    while let Some(folder) = open.pop().filter(|_| *left > 0) {
        if folder.join(HEADER).symlink_metadata().is_ok_and(|header| header.is_file()) {
            let files = stamp(std::slice::from_ref(&folder), left);
            let path = folder.strip_prefix(&project.folder).ok().and_then(Path::to_str);
            if let Some(path) = path.map(str::to_owned) {
                found.push(FoundMachine { files, folder, project: project.id.clone(), path });
            }
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
    use crate::about::MACHINE_LIST_MAX;
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
        let folders = vec![ProjectFolder { id: "p".to_owned(), folder: project.clone() }];
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
        let of_machines = parcels.all().iter().filter(|kept| kept.machine.is_some());
        assert_eq!(of_machines.count(), MACHINES_MAX + 1);
    }

    #[test]
    fn the_list_has_the_newest_machines_and_is_another_one_after_each_change() {
        let place = tempfile::tempdir().unwrap();
        let (project, kept) = (place.path().join("project"), place.path().join("kept"));
        let projects = || Projects {
            folders: vec![ProjectFolder { id: "p".to_owned(), folder: project.clone() }],
            libraries: Vec::new(),
        };
        let mut parcels = Parcels::open(&kept).unwrap();
        let mut scan = |machines: &mut ProjectMachines| {
            machines.scan(&mut parcels).unwrap();
            let list = parcels.machine_list().unwrap();
            assert_eq!(parcels.find(machines.list().unwrap()).unwrap().machine, None);
            list
        };
        let mut machines = ProjectMachines::new(projects());
        let none = scan(&mut machines);
        assert_eq!((none.machines.len(), none.more), (0, 0));
        write(&project.join("a/b"), "x = 1");
        let one = scan(&mut machines);
        let file = |path: &str| MachineFile { project: "p".to_owned(), path: path.to_owned() };
        assert_eq!(one.machines, [file("a/b")]);
        // A list as before is newer than the one between.
        fs::remove_dir_all(project.join("a")).unwrap();
        let none_again = scan(&mut machines);
        assert_eq!(none_again.machines, []);
        assert!(none.made_ms < one.made_ms && one.made_ms < none_again.made_ms);
        // After a restart, the list of unchanged machines is the same.
        assert_eq!(scan(&mut ProjectMachines::new(projects())), none_again);
        for number in 0..LISTED_MAX + 3 {
            write(&project.join(number.to_string()), "x = 1");
        }
        let many = scan(&mut machines);
        assert_eq!((many.machines.len(), many.more), (LISTED_MAX, 3));
    }

    #[test]
    fn of_long_paths_as_many_are_listed_as_fit() {
        let place = tempfile::tempdir().unwrap();
        let (project, kept) = (place.path().join("project"), place.path().join("kept"));
        let deep: PathBuf = ["n".repeat(200), "m".repeat(200)].iter().collect();
        for number in 0..LISTED_MAX {
            write(&project.join(&deep).join(number.to_string()), "x = 1");
        }
        let projects = || Projects {
            folders: vec![ProjectFolder { id: "p".to_owned(), folder: project.clone() }],
            libraries: Vec::new(),
        };
        let mut parcels = Parcels::open(&kept).unwrap();
        ProjectMachines::new(projects()).scan(&mut parcels).unwrap();
        let list = parcels.machine_list().unwrap();
        assert!(serde_json::to_vec(&list).unwrap().len() <= MACHINE_LIST_MAX);
        assert!(list.more > 0);
        assert_eq!(list.machines.len() + list.more as usize, LISTED_MAX);
        ProjectMachines::new(projects()).scan(&mut parcels).unwrap();
        assert_eq!(parcels.machine_list(), Some(list));
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
            let project = ProjectFolder { id: "p".to_owned(), folder: place.path().to_owned() };
            find_machines(&project, &[], &mut left, &mut found);
            (found.len(), left)
        };
        let (machines, left) = found(ENTRIES_MAX);
        assert_eq!(machines, 1);
        assert_eq!(found(ENTRIES_MAX - left).0, 1);
        assert_eq!(found(10), (0, 0));
    }
}
