//! Where the folders of runs lie, how a new one is named, and which one the user means. Knows names, not what is inside.

use crate::cli;
use crate::clock;
use crate::environment::Environment;
use crate::failure::{Usage, complain};
use anyhow::{Context as _, Result, bail};
use rafcon_storage::journal::{Retention, run_id};
use std::fs;
use std::os::unix::fs::DirBuilderExt as _;
use std::path::{Path, PathBuf};

/// A folder is a run if it holds this file.
const ABOUT: &str = "run.json";
/// How many names are tried for a new folder.
const TRIES: u16 = 100;

/// The folder with one folder for each run.
#[derive(Debug, Clone)]
pub(crate) struct Runs(pub(crate) PathBuf);

impl Runs {
    /// The one that the user names, or the usual place.
    pub(crate) fn new(named: &cli::Runs, environment: &Environment) -> Result<Self> {
        let usual = || {
            let state = environment.state_home.clone();
            let state = state.or_else(|| Some(environment.home.as_ref()?.join(".local/state")));
            Some(state?.join("rafcon/runs"))
        };
        match named.runs.clone().or_else(usual) {
            Some(folder) => Ok(Self(std::path::absolute(folder)?)),
            None => bail!("there is no HOME to keep runs in: name a folder with --runs"),
        }
    }

    /// Makes the folder of a new run of the machine with this name; only its owner may look into it.
    pub(crate) fn make(&self, machine: &str) -> Result<PathBuf> {
        fs::create_dir_all(&self.0).with_context(|| {
            format!(
                "cannot make the folder for runs {}: name another with --runs",
                self.0.display()
            )
        })?;
        let started_ms = clock::since_1970_ms();
        let mut tried = 0;
        loop {
            let folder = self.0.join(run_id(started_ms, machine, clock::salt(tried)));
            match fs::DirBuilder::new().mode(0o700).create(&folder) {
                Ok(()) => return Ok(folder),
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {
                    tried += 1;
                    if tried == TRIES {
                        bail!("cannot find a free name for a run in {}", self.0.display());
                    }
                }
                Err(error) => {
                    let path = folder.display();
                    return Err(error).with_context(|| {
                        format!("cannot make the run's folder {path}: name another place with --runs, or keep nothing with --keep off")
                    });
                }
            }
        }
    }

    /// Deletes runs beyond the usual number and size. What cannot be deleted stops no run.
    pub(crate) fn give_up_old_ones(&self) {
        if let Err(error) = Retention::default().prune(&self.0, clock::since_1970_ms()) {
            complain(&format!("warning: old runs stay: {error}"));
        }
    }

    /// The folder that the user means by `last`, an id, the beginning of one, or a path.
    pub(crate) fn find(&self, text: &str) -> Result<PathBuf> {
        let path = Path::new(text);
        if text.contains('/') && path.join(ABOUT).is_file() {
            return Ok(std::path::absolute(path)?);
        }
        let ids = self.ids()?;
        let found = match text {
            "last" => ids.last().into_iter().collect(),
            _ => matching(&ids, text),
        };
        match found.as_slice() {
            [one] => Ok(self.0.join(one)),
            [] => Err(Usage(format!(
                "there is no run `{text}` in {}: `rafcon runs` lists them",
                self.0.display()
            ))
            .into()),
            many => {
                let names: Vec<&str> = many.iter().map(|id| id.as_str()).collect();
                Err(Usage(format!("`{text}` could be {}: write more of it", names.join(" or ")))
                    .into())
            }
        }
    }

    /// The ids of all runs, the oldest first.
    pub(crate) fn ids(&self) -> Result<Vec<String>> {
        let entries = match fs::read_dir(&self.0) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => {
                entries.with_context(|| format!("cannot read the runs in {}", self.0.display()))?
            }
        };
        let run = |entry: fs::DirEntry| {
            let is_run = entry.path().join(ABOUT).is_file();
            entry.file_name().into_string().ok().filter(|_| is_run)
        };
        let mut ids: Vec<String> = entries.flatten().filter_map(run).collect();
        ids.sort();
        Ok(ids)
    }
}

/// What a run says about itself; nothing if its file is missing or damaged.
pub(crate) fn about(folder: &Path) -> Option<serde_json::Value> {
    serde_json::from_slice(&fs::read(folder.join(ABOUT)).ok()?).ok()
}

fn matching<'i>(ids: &'i [String], text: &str) -> Vec<&'i String> {
    if let Some(exact) = ids.iter().find(|id| *id == text) {
        return vec![exact];
    }
    ids.iter().filter(|id| !text.is_empty() && id.starts_with(text)).collect()
}

#[cfg(test)]
mod tests {
    use super::Runs;
    use expect_test::{Expect, expect};

    fn check(text: &str, expect: &Expect) {
        let folder = tempfile::tempdir().unwrap();
        for id in ["20260131-120000-a-0001", "20260131-120000-a-0002", "20260201-000000-b-0001"] {
            std::fs::create_dir(folder.path().join(id)).unwrap();
            std::fs::write(folder.path().join(id).join("run.json"), "{}").unwrap();
        }
        std::fs::create_dir(folder.path().join("20260301-no-run")).unwrap();
        let found = Runs(folder.path().to_path_buf()).find(text);
        let text = found.map_or_else(|error| error.to_string(), |path| path.display().to_string());
        expect.assert_eq(&text.replace(&folder.path().display().to_string(), "RUNS"));
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
                "`20260131` could be 20260131-120000-a-0001 or 20260131-120000-a-0002: write more of it"
            ],
        );
        check("2025", &expect!["there is no run `2025` in RUNS: `rafcon runs` lists them"]);
    }
}
