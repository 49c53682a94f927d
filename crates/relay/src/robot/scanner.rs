//! Scans the folders of a robot's runs: which there are, whether a runner has them, and what is new in them. Blocks on the disk.

use rafcon_storage::journal::{About, EventSource, JournalError, Pack, run_folders, writer_of};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Files of a run that is to be sent.
#[derive(Debug)]
pub(super) struct RunFiles {
    pub(super) about: About,
    /// Number of its last event.
    pub(super) head: u64,
}

impl RunFiles {
    pub(super) fn read(folder: &Path) -> Result<Self, JournalError> {
        let about = About::read(folder)?;
        let head = EventSource::open(folder)?.last()?;
        Ok(Self { about, head })
    }
}

/// A run in the folder.
#[derive(Debug)]
pub(super) struct FoundRun {
    pub(super) id: String,
    /// A runner has it.
    pub(super) is_live: bool,
    /// Its files, at the first scan that can read them.
    pub(super) files: Option<RunFiles>,
    /// Machines that a live run has stored since the scan before.
    pub(super) machines: FoundMachines,
}

/// Machines of a run, from one of them on.
#[derive(Debug, Default)]
pub(super) struct FoundMachines {
    /// Number of the machines before these.
    pub(super) before: usize,
    pub(super) packs: Vec<Pack>,
}

impl FoundMachines {
    /// Machines of the run in this folder beyond this number.
    pub(super) fn read(folder: &Path, before: usize) -> Self {
        // A journal that cannot be read now is read again.
        Self { before, packs: Pack::read_after(folder, before).unwrap_or_default() }
    }
}

/// The folder of the runs.
#[derive(Debug)]
pub(super) struct RunScanner {
    folder: PathBuf,
    tell: fn(&str),
    /// Runs whose files were reported.
    known: BTreeSet<String>,
    /// Number of the reported machines of live runs.
    machines: BTreeMap<String, usize>,
}

impl RunScanner {
    /// The files of runs that are `known` are not read.
    pub(super) fn new(folder: &Path, known: BTreeSet<String>, tell: fn(&str)) -> Self {
        Self { folder: folder.to_owned(), tell, known, machines: BTreeMap::new() }
    }

    /// All runs in the folder.
    pub(super) fn scan(&mut self) -> Vec<FoundRun> {
        let folders = run_folders(&self.folder).unwrap_or_default();
        let found: Vec<_> = folders.iter().map(|folder| self.scan_one(folder)).collect();
        let there: BTreeSet<_> = found.iter().map(|run| &*run.id).collect();
        self.known.retain(|id| there.contains(&**id));
        self.machines.retain(|id, _| there.contains(&**id));
        found
    }

    fn scan_one(&mut self, folder: &Path) -> FoundRun {
        let id = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let is_live = matches!(writer_of(folder), Ok(Some(_)));
        let files = if self.known.contains(&id) { None } else { self.read(&id, folder, is_live) };
        let machines = if is_live {
            self.new_machines(&id, folder)
        } else {
            self.machines.remove(&id);
            FoundMachines::default()
        };
        FoundRun { id, is_live, files, machines }
    }

    /// The files of a new run. One that is not readable yet may be about to start: it is read again.
    fn read(&mut self, id: &str, folder: &Path, is_live: bool) -> Option<RunFiles> {
        match RunFiles::read(folder) {
            Ok(files) => {
                self.known.insert(id.to_owned());
                return Some(files);
            }
            // The runner has just locked the folder, and writes its files now.
            Err(JournalError::NoRun { .. }) => {}
            Err(error) if is_live => {
                (self.tell)(&format!("run {id} is not sent to the station: {error}"));
            }
            Err(_) => {}
        }
        None
    }

    fn new_machines(&mut self, id: &str, folder: &Path) -> FoundMachines {
        let before = self.machines.get(id).copied().unwrap_or(0);
        let machines = FoundMachines::read(folder, before);
        if !machines.packs.is_empty() {
            self.machines.insert(id.to_owned(), before + machines.packs.len());
        }
        machines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::short_journal::{begun, ended};
    use std::fs;

    fn about(id: &str) -> About {
        About { id: id.to_owned(), ..About::default() }
    }

    #[test]
    fn the_files_of_a_run_are_reported_once_and_again_if_it_was_deleted() {
        let folder = tempfile::tempdir().unwrap();
        let run = |id: &str| folder.path().join(id);
        ended(&run("old"), &about("old"), 1);
        let mut scanner = RunScanner::new(folder.path(), ["old".to_owned()].into(), |problem| {
            panic!("{problem}")
        });
        let mut scan = || {
            let found = scanner.scan();
            let of = |run: FoundRun| (run.id, run.is_live, run.files.map(|files| files.head));
            found.into_iter().map(of).collect::<Vec<_>>()
        };
        let live = begun(&run("new"), &about("new"), 1);
        let [new, old] = ["new", "old"].map(str::to_owned);
        assert_eq!(scan(), [(new.clone(), true, Some(1)), (old.clone(), false, None)]);
        drop(live);
        fs::remove_dir_all(run("old")).unwrap();
        assert_eq!(scan(), [(new.clone(), false, None)]);
        ended(&run("old"), &about("old"), 3);
        assert_eq!(scan(), [(new, false, None), (old, false, Some(4))]);
    }
}
