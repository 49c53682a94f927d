//! Locates the folders of runs, names new ones, and finds a run by a text. Knows names, but not their content.

use crate::{ProgramEnvironment, clock};
use rafcon_storage::journal::folder::{ABOUT_FILE, check_run_id};
use rafcon_storage::journal::{JournalError, Pruned, Retention, run_id};
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::DirBuilderExt as _;
use std::path::{Path, PathBuf};

/// Number of attempts to find a name for a new folder.
const TRIES: u16 = 100;

/// The folder that contains one folder per run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Runs {
    folder: PathBuf,
}

/// A run's folder cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum MakeError {
    /// The default folder is unknown.
    #[error("no folder for runs: set HOME, or name a folder with --runs")]
    NoHome,
    /// The current folder no longer exists.
    #[error(transparent)]
    Here(#[from] io::Error),
    /// The folder of all runs cannot be made.
    #[error("cannot create the folder for runs {}: name another with --runs", folder.display())]
    Runs {
        /// The folder of all runs.
        folder: PathBuf,
        /// The error of the system call.
        source: io::Error,
    },
    /// All tried names are taken.
    #[error("cannot find a free name for a run in {}", folder.display())]
    NoName {
        /// The folder of all runs.
        folder: PathBuf,
    },
    /// The folder of the run cannot be made.
    #[error(
        "cannot create the run's folder {}: name another folder with --runs, or record nothing with --keep off",
        folder.display()
    )]
    Run {
        /// The folder of the run.
        folder: PathBuf,
        /// The error of the system call.
        source: io::Error,
    },
}

/// The run was not found.
#[derive(Debug, thiserror::Error)]
pub enum FindError {
    /// The current folder no longer exists.
    #[error(transparent)]
    Here(#[from] io::Error),
    /// The runs cannot be read.
    #[error("cannot read the runs in {}", folder.display())]
    Read {
        /// The folder of all runs.
        folder: PathBuf,
        /// The error of the system call.
        source: io::Error,
    },
    /// No run has this id.
    #[error("there is no run `{text}` in {}: `rafcon runs` lists the runs", folder.display())]
    None {
        /// The requested id or text.
        text: String,
        /// The folder of all runs.
        folder: PathBuf,
    },
    /// Several ids begin with this text.
    #[error("`{text}` could mean {}: write more of the id", ids.join(" or "))]
    Many {
        /// The requested beginning of an id.
        text: String,
        /// The ids that begin with it.
        ids: Vec<String>,
    },
}

impl Runs {
    /// The folder that the user names, or the default one.
    pub fn new(named: Option<&Path>, environment: &ProgramEnvironment) -> Result<Self, MakeError> {
        let usual = || {
            let state = environment.state_home.clone();
            let state = state.or_else(|| Some(environment.home.as_ref()?.join(".local/state")));
            Some(state?.join("rafcon/runs"))
        };
        let folder = named.map(PathBuf::from).or_else(usual).ok_or(MakeError::NoHome)?;
        Ok(Self { folder: std::path::absolute(folder)? })
    }

    /// The folder of all runs. It need not exist.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Makes the folder of all runs, readable for its owner only. An existing folder keeps its permissions.
    pub fn make_folder(&self) -> io::Result<()> {
        fs::DirBuilder::new().recursive(true).mode(0o700).create(&self.folder)
    }

    /// Makes the folder of a new run of the machine with this name, readable for its owner only. Its name survives a power cut.
    pub fn make(&self, machine: &str) -> Result<PathBuf, MakeError> {
        let folder = &self.folder;
        let unmade = |source| MakeError::Runs { folder: folder.clone(), source };
        self.make_folder().map_err(unmade)?;
        let started_ms = clock::since_1970_ms();
        for attempt in 0..TRIES {
            let folder = folder.join(run_id(started_ms, machine, clock::salt(attempt)));
            match fs::DirBuilder::new().mode(0o700).create(&folder) {
                Ok(()) => {
                    File::open(&self.folder).and_then(|all| all.sync_all()).map_err(unmade)?;
                    return Ok(folder);
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(source) => return Err(MakeError::Run { folder, source }),
            }
        }
        Err(MakeError::NoName { folder: folder.clone() })
    }

    /// Deletes runs beyond the default number and size. Returns the deleted ones.
    pub fn give_up_old_ones(&self) -> Result<Vec<Pruned>, JournalError> {
        Retention::default().prune(&self.folder, clock::since_1970_ms())
    }

    /// The folder of the run that `text` names: `last`, an id, the beginning of one, or a path.
    pub fn find(&self, text: &str) -> Result<PathBuf, FindError> {
        let path = Path::new(text);
        if text.contains('/') && path.join(ABOUT_FILE).is_file() {
            return Ok(std::path::absolute(path)?);
        }
        let ids = self.ids()?;
        match meant(&ids, text).as_slice() {
            [one] => Ok(self.folder.join(one)),
            [] => Err(FindError::None { text: text.to_owned(), folder: self.folder.clone() }),
            many => Err(FindError::Many {
                text: text.to_owned(),
                ids: many.iter().map(|id| (*id).clone()).collect(),
            }),
        }
    }

    /// The ids of all runs, oldest first.
    pub fn ids(&self) -> Result<Vec<String>, FindError> {
        let entries = match fs::read_dir(&self.folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => {
                entries.map_err(|source| FindError::Read { folder: self.folder.clone(), source })?
            }
        };
        let run = |entry: fs::DirEntry| {
            let is_run = entry.path().join(ABOUT_FILE).is_file();
            entry.file_name().into_string().ok().filter(|id| is_run && check_run_id(id).is_ok())
        };
        let mut ids: Vec<String> = entries.flatten().filter_map(run).collect();
        ids.sort();
        Ok(ids)
    }
}

/// The ids that `text` names: `last`, a complete id, or a beginning. `ids` must be sorted, oldest first.
pub fn meant<'i>(ids: &'i [String], text: &str) -> Vec<&'i String> {
    if text == "last" {
        return ids.last().into_iter().collect();
    }
    if let Some(exact) = ids.iter().find(|id| *id == text) {
        return vec![exact];
    }
    ids.iter().filter(|id| !text.is_empty() && id.starts_with(text)).collect()
}

#[cfg(test)]
mod tests {
    use super::Runs;
    use expect_test::{Expect, expect};
    use std::os::unix::fs::PermissionsExt as _;

    fn check(text: &str, expect: &Expect) {
        let folder = tempfile::tempdir().unwrap();
        for id in ["20260131-120000-a-0001", "20260131-120000-a-0002", "20260201-000000-b-0001"] {
            std::fs::create_dir(folder.path().join(id)).unwrap();
            std::fs::write(folder.path().join(id).join("run.json"), "{}").unwrap();
        }
        std::fs::create_dir(folder.path().join("20260301-no-run")).unwrap();
        std::fs::create_dir(folder.path().join("20260302-a.gone")).unwrap();
        std::fs::write(folder.path().join("20260302-a.gone").join("run.json"), "{}").unwrap();
        let found = Runs { folder: folder.path().to_path_buf() }.find(text);
        let text = found.map_or_else(|error| error.to_string(), |path| path.display().to_string());
        expect.assert_eq(&text.replace(&folder.path().display().to_string(), "RUNS"));
    }

    #[test]
    fn only_the_owner_may_list_runs() {
        let place = tempfile::tempdir().unwrap();
        let runs = Runs { folder: place.path().join("state/runs") };
        let run = runs.make("pick").unwrap();
        for folder in [runs.folder(), &run] {
            let mode = folder.metadata().unwrap().permissions().mode();
            assert_eq!(mode & 0o777, 0o700, "{}", folder.display());
        }
    }

    #[test]
    fn a_run_is_named_by_what_is_enough() {
        check("last", &expect!["RUNS/20260201-000000-b-0001"]);
        check("20260201", &expect!["RUNS/20260201-000000-b-0001"]);
        check("20260131-120000-a-0002", &expect!["RUNS/20260131-120000-a-0002"]);
    }

    #[test]
    fn a_name_that_is_not_enough_is_refused_with_the_way_out() {
        check(
            "20260131",
            &expect![
                "`20260131` could mean 20260131-120000-a-0001 or 20260131-120000-a-0002: write more of the id"
            ],
        );
        check("2025", &expect!["there is no run `2025` in RUNS: `rafcon runs` lists the runs"]);
    }
}
