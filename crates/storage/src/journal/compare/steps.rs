//! A run as the entries and ends of its states, by branch. Determines which states ran concurrently.

use super::digest::Digests;
use crate::journal::folder::JournalError;
use crate::journal::read::{Entry, Reader, damaged};
use crate::journal::record::{PlaceNumber, Places, Record};
use rafcon_protocol::Event;
use rafcon_protocol::api::TimeTaken;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;

/// Number of a path, equal in both runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key(usize);

/// All paths that occur.
#[derive(Debug, Default)]
pub(super) struct Keys {
    paths: Vec<(String, Option<Key>)>,
    by_path: BTreeMap<String, Key>,
}

impl Keys {
    pub(super) fn path(&self, key: Key) -> &str {
        self.paths.get(key.0).map_or("", |(path, _)| path)
    }

    fn parent(&self, key: Key) -> Option<Key> {
        self.paths.get(key.0)?.1
    }

    fn of(&mut self, path: &str) -> Key {
        if let Some(known) = self.by_path.get(path) {
            return *known;
        }
        let parent = path.rsplit_once('/').map(|(parent, _)| self.of(parent));
        let key = Key(self.paths.len());
        self.paths.push((path.to_owned(), parent));
        self.by_path.insert(path.to_owned(), key);
        key
    }

    /// Returns the state at the top of the branch that a state belongs to.
    fn branch(&self, key: Key, side_by_side: &BTreeSet<Key>) -> Key {
        let mut top = key;
        while let Some(parent) = self.parent(top) {
            if side_by_side.contains(&parent) {
                return top;
            }
            top = parent;
        }
        top
    }
}

/// An entry or end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ComparedStep {
    pub(super) sequence: u64,
    pub(super) t_ns: u64,
    pub(super) key: Key,
    pub(super) did: Did,
    /// Digest of the step's values.
    pub(super) digest: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Did {
    Entered { backwards: bool },
    Left { outcome: i64, backwards: bool },
}

/// The steps of a run.
#[derive(Debug, Default)]
pub(super) struct Steps {
    all: Vec<ComparedStep>,
    /// States with several children active at a time.
    pub(super) side_by_side: BTreeSet<Key>,
    pub(super) times: BTreeMap<Key, TimeTaken>,
}

/// Steps by the state at the top of their branch.
pub(super) type Branches = BTreeMap<Key, Vec<ComparedStep>>;

impl Steps {
    pub(super) fn read(reader: &mut Reader, keys: &mut Keys) -> Result<Self, JournalError> {
        let (mut digests, mut failure) = (Digests::default(), None);
        let mut reading = Reading::new(keys);
        reader.each(1, |reader, entry| match digests.of(reader, &entry.record) {
            Ok(_) if damaged(&entry.record).is_some() => {
                let lost = damaged(&entry.record).unwrap_or_default();
                failure = Some(reader.lost(lost.0, lost.1, "the run cannot be compared"));
                ControlFlow::Break(())
            }
            Ok(digest) => {
                reading.take(&entry, digest, reader.known_places());
                ControlFlow::Continue(())
            }
            Err(error) => {
                failure = Some(error);
                ControlFlow::Break(())
            }
        })?;
        failure.map_or(Ok(reading.found), Err)
    }

    /// Returns the steps of each branch.
    pub(super) fn by_branch(&self, keys: &Keys, side_by_side: &BTreeSet<Key>) -> Branches {
        let mut tops: BTreeMap<Key, Key> = BTreeMap::new();
        let mut branches = Branches::new();
        for step in &self.all {
            let top = *tops.entry(step.key).or_insert_with(|| keys.branch(step.key, side_by_side));
            branches.entry(top).or_default().push(*step);
        }
        branches
    }
}

/// Returns the steps of both runs on each branch.
pub(super) fn both<'s>(
    one: &'s Branches,
    other: &'s Branches,
) -> Vec<(Key, &'s [ComparedStep], &'s [ComparedStep])> {
    let all: BTreeSet<Key> = one.keys().chain(other.keys()).copied().collect();
    let of = |branches: &'s Branches, key| branches.get(&key).map_or(&[][..], Vec::as_slice);
    all.into_iter().map(|key| (key, of(one, key), of(other, key))).collect()
}

/// The state while a run is read.
struct Reading<'k> {
    keys: &'k mut Keys,
    known: BTreeMap<PlaceNumber, Key>,
    /// Entry times of active states, and the number of their active children.
    active: BTreeMap<Key, (u64, u32)>,
    found: Steps,
}

impl<'k> Reading<'k> {
    fn new(keys: &'k mut Keys) -> Self {
        Self { keys, known: BTreeMap::new(), active: BTreeMap::new(), found: Steps::default() }
    }

    fn take(&mut self, entry: &Entry, digest: u64, places: &Places) {
        let (place, did) = match &entry.record {
            Record::Entered { place, undoes, .. } => {
                (place, Did::Entered { backwards: undoes.is_some() })
            }
            Record::Left { place, outcome, undoes, .. } => {
                (place, Did::Left { outcome: *outcome, backwards: undoes.is_some() })
            }
            Record::Told(event) => return self.event(event),
            _ => return,
        };
        let Some(path) = places.get(*place).map(|place| &place.path) else { return };
        let keys = &mut *self.keys;
        let key = *self.known.entry(*place).or_insert_with(|| keys.of(path));
        let (sequence, t_ns) = (entry.sequence, entry.t_ns);
        self.found.all.push(ComparedStep { sequence, t_ns, key, did, digest });
        match did {
            Did::Entered { .. } => self.entered(key, t_ns),
            Did::Left { .. } => self.left(key, t_ns),
        }
    }

    fn entered(&mut self, key: Key, t_ns: u64) {
        // A resumed run enters the interrupted states again.
        if self.active.insert(key, (t_ns, 0)).is_some() {
            return;
        }
        let Some(parent) = self.keys.parent(key) else { return };
        if let Some((_, children)) = self.active.get_mut(&parent) {
            *children += 1;
            if *children > 1 {
                self.found.side_by_side.insert(parent);
            }
        }
    }

    fn left(&mut self, key: Key, t_ns: u64) {
        if let Some(since) = self.end(key) {
            let time = self.found.times.entry(key).or_default();
            time.count += 1;
            time.total_ns += t_ns.saturating_sub(since);
        }
    }

    fn event(&mut self, event: &Event) {
        if let Event::Dropped { path } = event {
            let key = self.keys.of(path);
            self.end(key);
        }
    }

    /// Ends a state and returns its entry time.
    fn end(&mut self, key: Key) -> Option<u64> {
        let (since, _) = self.active.remove(&key)?;
        if let Some((_, children)) = self.keys.parent(key).and_then(|p| self.active.get_mut(&p)) {
            *children = children.saturating_sub(1);
        }
        Some(since)
    }
}
