//! Completed runs of a robot. They are neither read at the start nor fetched again after a deletion here. In memory a run is a few
//! numbers; its id stays in the file.

use crate::ids;
use rafcon_link::StreamId;
use rafcon_storage::journal::folder::replace_file;
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{BufRead as _, BufReader, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

const COMPLETED_FILE: &str = "had";
/// Capacity. Beyond it, the older half is dropped at the next start: a robot that still has such a run sends it again.
const COMPLETED_MAX: usize = 1 << 19;

/// A completed run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct CompletedRun {
    pub(super) events: u64,
    pub(super) parts: u64,
    check: u32,
    /// Offset of its line.
    offset: u64,
}

/// The runs by the stream of their events.
#[derive(Debug)]
pub(super) struct CompletedRuns {
    path: PathBuf,
    runs: BTreeMap<StreamId, CompletedRun>,
    length: u64,
}

impl CompletedRuns {
    /// Those that are listed in this folder.
    pub(super) fn read(folder: &Path) -> Self {
        Self::read_at_most(folder, COMPLETED_MAX)
    }

    fn read_at_most(folder: &Path, most: usize) -> Self {
        let path = folder.join(COMPLETED_FILE);
        // A run without an entry is fetched again.
        let mut text = fs::read_to_string(&path).unwrap_or_default();
        let lines = text.lines().count();
        if lines > most {
            let newest = text.lines().skip(lines - most / 2);
            text = newest.flat_map(|line| [line, "\n"]).collect();
            drop(replace_file(&path, text.as_bytes()));
        }
        let (mut runs, mut offset) = (BTreeMap::new(), 0);
        for line in text.split_inclusive('\n') {
            if let Some(entry) = Entry::read(line.trim_end_matches('\n')) {
                entry.insert(offset, &mut runs);
            }
            offset += line.len() as u64;
        }
        Self { path, runs, length: offset }
    }

    /// All of them.
    pub(super) fn runs(&self) -> impl Iterator<Item = (StreamId, CompletedRun)> {
        self.runs.iter().map(|(stream, run)| (*stream, *run))
    }

    /// The run with this id, and its stream.
    pub(super) fn find(&self, id: &str) -> Option<(StreamId, CompletedRun)> {
        let check = ids::check_of(id);
        let found = |stream| Some((stream, *self.runs.get(&stream)?));
        ids::streams_of(id).filter_map(found).find(|(_, run)| run.check == check)
    }

    pub(super) fn get(&self, stream: StreamId) -> Option<CompletedRun> {
        self.runs.get(&stream).copied()
    }

    /// The id of the run with this stream.
    pub(super) fn id_of(&self, stream: StreamId) -> Option<String> {
        let run = self.runs.get(&stream)?;
        let mut file = BufReader::new(File::open(&self.path).ok()?);
        file.seek(SeekFrom::Start(run.offset)).ok()?;
        let mut line = String::new();
        file.read_line(&mut line).ok()?;
        let entry = Entry::read(line.trim_end_matches('\n'))?;
        (ids::check_of(entry.id) == run.check).then(|| entry.id.to_owned())
    }

    /// A run is here as a whole.
    pub(super) fn add(&mut self, id: &str, stream: StreamId, events: u64, parts: u64) {
        let is_known = |run: &CompletedRun| (run.events, run.parts) == (events, parts);
        if self.find(id).is_some_and(|(_, run)| is_known(&run)) {
            return;
        }
        let nth = ids::streams_of(id).position(|other| other == stream).unwrap_or(0);
        let entry = Entry { events, parts, nth, id };
        let line = entry.line();
        let file = OpenOptions::new().append(true).create(true).open(&self.path);
        // A run without an entry is fetched again.
        if file.and_then(|mut file| file.write_all(line.as_bytes())).is_ok() {
            entry.insert(self.length, &mut self.runs);
            self.length += line.len() as u64;
        }
    }
}

/// A line: how many events, `@` and which of its numbers the run has unless it is the first, how many parts, the id.
#[derive(Clone, Copy)]
struct Entry<'t> {
    events: u64,
    parts: u64,
    nth: usize,
    id: &'t str,
}

impl<'t> Entry<'t> {
    fn read(line: &'t str) -> Option<Self> {
        let mut words = line.splitn(3, ' ');
        let (events, parts) = (words.next()?, words.next()?.parse().ok()?);
        let (events, nth) = events.split_once('@').unwrap_or((events, "0"));
        Some(Self {
            events: events.parse().ok()?,
            parts,
            nth: nth.parse().ok()?,
            id: words.next()?,
        })
    }

    fn line(&self) -> String {
        let Self { events, parts, nth, id } = self;
        let nth = if *nth == 0 { String::new() } else { format!("@{nth}") };
        format!("{events}{nth} {parts} {id}\n")
    }

    /// A run without events may be fetched again.
    fn insert(&self, offset: u64, runs: &mut BTreeMap<StreamId, CompletedRun>) {
        let Some(stream) = ids::streams_of(self.id).nth(self.nth) else { return };
        let (Self { events, parts, .. }, check) = (*self, ids::check_of(self.id));
        if events == 0 {
            runs.remove(&stream);
        } else {
            runs.insert(stream, CompletedRun { events, parts, check, offset });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::CompletedRuns;
    use crate::ids;
    use std::fs;

    #[test]
    fn what_was_here_is_known_after_a_restart() {
        let folder = tempfile::tempdir().unwrap();
        let mut completed = CompletedRuns::read(folder.path());
        let (first, second) = ("20260101-000000-a-0001", "a run with spaces");
        completed.add(first, ids::events_of(first), 7, 2);
        completed.add(first, ids::events_of(first), 7, 2);
        // Another run of the robot has its first number.
        let other = ids::streams_of(second).nth(1).unwrap();
        completed.add(second, other, 9, 1);
        let is_right = |completed: &CompletedRuns| {
            let counts =
                |id| completed.find(id).map(|(stream, run)| (stream, run.events, run.parts));
            assert_eq!(counts(first), Some((ids::events_of(first), 7, 2)));
            assert_eq!(counts(second), Some((other, 9, 1)));
            assert_eq!(completed.id_of(other).as_deref(), Some(second));
            assert_eq!((completed.runs().count(), completed.find("c").is_none()), (2, true));
        };
        is_right(&completed);
        let mut completed = CompletedRuns::read(folder.path());
        is_right(&completed);
        completed.add(first, ids::events_of(first), 0, 0);
        assert!(completed.find(first).is_none());
        assert!(CompletedRuns::read(folder.path()).find(first).is_none());
        fs::write(folder.path().join("had"), "x y\n3\n\n1 1 b\n").unwrap();
        let completed = CompletedRuns::read(folder.path());
        assert_eq!(completed.id_of(ids::events_of("b")).as_deref(), Some("b"));
    }

    #[test]
    fn of_more_runs_than_the_file_may_list_the_newer_half_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let mut completed = CompletedRuns::read(folder.path());
        for number in 0..9 {
            let id = format!("run-{number}");
            completed.add(&id, ids::events_of(&id), 4, 1);
        }
        let completed = CompletedRuns::read_at_most(folder.path(), 8);
        let known = |number: u32| completed.find(&format!("run-{number}")).is_some();
        assert_eq!((0..9).filter(|number| known(*number)).collect::<Vec<_>>(), [5, 6, 7, 8]);
        assert_eq!(completed.id_of(ids::events_of("run-7")).as_deref(), Some("run-7"));
        assert_eq!(CompletedRuns::read(folder.path()).runs().count(), 4);
    }
}
