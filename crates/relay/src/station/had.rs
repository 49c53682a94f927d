//! Which runs of a robot the station once had whole: one that was deleted here since is not fetched again.

use rafcon_storage::journal::folder::replace_file;
use std::collections::BTreeMap;
use std::fs::{self, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

const HAD_FILE: &str = "had";
/// So many are remembered after a restart.
const HAD_MAX: usize = 4_096;

/// The runs by their ids, with how many events and parts they have.
#[derive(Debug)]
pub(super) struct Had {
    path: PathBuf,
    runs: BTreeMap<String, (u64, u64)>,
}

impl Had {
    /// Those that are listed in this folder.
    pub(super) fn read(folder: &Path) -> Self {
        let path = folder.join(HAD_FILE);
        // What is not listed is fetched again.
        let text = fs::read_to_string(&path).unwrap_or_default();
        let runs: BTreeMap<_, _> = text.lines().filter_map(entry).collect();
        let had = Self { path, runs };
        if text.lines().count() > HAD_MAX {
            had.write_newest();
        }
        had
    }

    pub(super) fn runs(&self) -> impl Iterator<Item = (&str, (u64, u64))> {
        self.runs.iter().map(|(id, counts)| (id.as_str(), *counts))
    }

    /// A run is here as a whole.
    pub(super) fn add(&mut self, id: &str, counts: (u64, u64)) {
        if self.runs.insert(id.to_owned(), counts) != Some(counts) {
            let file = OpenOptions::new().append(true).create(true).open(&self.path);
            // What is not listed is fetched again.
            drop(file.and_then(|mut file| file.write_all(line(id, counts).as_bytes())));
        }
    }

    /// The ids begin with the time.
    fn write_newest(&self) {
        let newest = self.runs.iter().rev().take(HAD_MAX / 2);
        let text: String = newest.map(|(id, counts)| line(id, *counts)).collect();
        drop(replace_file(&self.path, text.as_bytes()));
    }
}

fn line(id: &str, (events, parts): (u64, u64)) -> String {
    format!("{events} {parts} {id}\n")
}

fn entry(line: &str) -> Option<(String, (u64, u64))> {
    let mut words = line.splitn(3, ' ');
    let mut number = || words.next()?.parse().ok();
    let counts = (number()?, number()?);
    Some((words.next()?.to_owned(), counts))
}

#[cfg(test)]
mod tests {
    use super::Had;
    use expect_test::expect;
    use std::fs;

    #[test]
    fn what_was_here_is_known_after_a_restart() {
        let folder = tempfile::tempdir().unwrap();
        let mut had = Had::read(folder.path());
        had.add("20260101-000000-a-0001", (7, 2));
        had.add("20260101-000000-a-0001", (7, 2));
        had.add("a run with spaces", (9, 1));
        let had = Had::read(folder.path());
        expect![[r#"[("20260101-000000-a-0001", (7, 2)), ("a run with spaces", (9, 1))]"#]]
            .assert_eq(&format!("{:?}", had.runs().collect::<Vec<_>>()));
        fs::write(folder.path().join("had"), "x y\n3\n\n1 1 b\n").unwrap();
        assert_eq!(Had::read(folder.path()).runs().count(), 1);
    }
}
