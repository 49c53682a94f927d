//! Where the folders of runs lie, how a new one is named, and which one is meant. Knows names, not what is inside.

use crate::{ProgramEnvironment, clock};
use rafcon_storage::journal::folder::{ABOUT_FILE, check_run_id};
use rafcon_storage::journal::{JournalError, Pruned, Retention, run_id};
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::DirBuilderExt as _;
use std::path::{Path, PathBuf};

/// How many names are tried for a new folder.
const TRIES: u16 = 100;

/// The folder with one folder for each run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Runs {
    folder: PathBuf,
}

/// Why a run has no folder.
#[derive(Debug, thiserror::Error)]
pub enum MakeError {
    /// There is no usual place.
    #[error("no folder for runs: set HOME, or name a folder with --runs")]
    NoHome,
    /// The current folder is gone.
    #[error(transparent)]
    Here(#[from] io::Error),
    /// The folder of all runs cannot be made.
    #[error("cannot create the folder for runs {}: name another with --runs", folder.display())]
    Runs {
        /// Which one.
        folder: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// Every name that was tried is taken.
    #[error("cannot find a free name for a run in {}", folder.display())]
    NoName {
        /// Where.
        folder: PathBuf,
    },
    /// The folder of the run cannot be made.
    #[error(
        "cannot create the run's folder {}: name another folder with --runs, or record nothing with --keep off",
        folder.display()
    )]
    Run {
        /// Which one.
        folder: PathBuf,
        /// Why not.
        source: io::Error,
    },
}

/// Why no run was found.
#[derive(Debug, thiserror::Error)]
pub enum FindError {
    /// The current folder is gone.
    #[error(transparent)]
    Here(#[from] io::Error),
    /// The runs cannot be read.
    #[error("cannot read the runs in {}", folder.display())]
    Read {
        /// Where.
        folder: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// There is none of that name.
    #[error("there is no run `{text}` in {}: `rafcon runs` lists the runs", folder.display())]
    None {
        /// What was asked for.
        text: String,
        /// Where.
        folder: PathBuf,
    },
    /// More than one begins like that.
    #[error("`{text}` could mean {}: write more of the id", ids.join(" or "))]
    Many {
        /// What was asked for.
        text: String,
        /// What it may mean.
        ids: Vec<String>,
    },
}

impl Runs {
    /// The one that the user names, or the usual place.
    pub fn new(named: Option<&Path>, surroundings: &ProgramEnvironment) -> Result<Self, MakeError> {
        let usual = || {
            let state = surroundings.state_home.clone();
            let state = state.or_else(|| Some(surroundings.home.as_ref()?.join(".local/state")));
            Some(state?.join("rafcon/runs"))
        };
        let folder = named.map(PathBuf::from).or_else(usual).ok_or(MakeError::NoHome)?;
        Ok(Self { folder: std::path::absolute(folder)? })
    }

    /// The folder itself; it need not be there.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Makes the folder itself, which only its owner may list. An existing folder keeps its permissions.
    pub fn make_folder(&self) -> io::Result<()> {
        fs::DirBuilder::new().recursive(true).mode(0o700).create(&self.folder)
    }

    /// Makes the folder of a new run of the machine with this name; only its owner may look into it. Its name survives a power
    /// cut.
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

    /// Deletes runs beyond the usual number and size, and says which.
    pub fn give_up_old_ones(&self) -> Result<Vec<Pruned>, JournalError> {
        Retention::default().prune(&self.folder, clock::since_1970_ms())
    }

    /// The folder that is meant by `last`, an id, the beginning of one, or a path.
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

    /// The ids of all runs, the oldest first.
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

/// Those of the ids, the oldest first, that are meant by `last`, one of them, or its beginning.
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
