//! The log of revisions of an open machine. A revision has its author, its inverse, the resulting machine and the text for clients.
//! The log derives each user's undo and redo, the tree of steps, and the revisions that a reader has not seen. Pure.
//!
//! A node of the tree is a revision whose machine differs from those of all earlier revisions. Its parent is the node of the
//! previous revision.

use super::merge::Layouts;
use super::places::MachinePlace;
use super::refusal::OperationRefusal;
use crate::Failure;
use rafcon_locks::Mutex;
use rafcon_model::Machine;
use rafcon_model::edit::Edit;
use rafcon_protocol::api::{MachineStep, MachineSteps, Revision, RevisionKind};
use rafcon_protocol::document::{Change, changes};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

/// Capacity of the log. Older revisions are dropped.
const REVISIONS_MAX: usize = 10_000;
/// Number of stored machines besides the start. They share common parts.
const MACHINES_MAX: usize = 1000;
/// Capacity of the stored texts, in bytes.
const BYTES_MAX: usize = 16 << 20;
/// Approximate size of a page, in bytes.
const PAGE_BYTES: usize = 256 << 10;

/// The revisions of an open machine, oldest first.
#[derive(Debug)]
pub(super) struct RevisionLog {
    /// Revision of the machine as it was loaded.
    start: u64,
    revisions: VecDeque<RecordedRevision>,
    /// Machines by node, including the start.
    machines: BTreeMap<u64, RecordedMachine>,
    nodes: BTreeMap<Fingerprint, u64>,
    /// Fingerprint of the current machine.
    mark: Fingerprint,
    authors: BTreeMap<String, OwnSteps>,
    /// The first revision whose text is stored, and the total bytes of the texts from there on.
    told_from: u64,
    told_bytes: usize,
}

#[derive(Debug)]
struct RecordedRevision {
    step: MachineStep,
    /// A [`Revision`] as JSON.
    text: Option<Arc<str>>,
    /// `None` once the revision was reverted.
    inverse: Option<Inverse>,
    /// The revision that this one reverted.
    reverses: Option<u64>,
}

/// Data to revert a revision.
#[derive(Debug, Clone)]
pub(super) struct Inverse {
    /// The places that the revision changed.
    pub(super) places: Vec<MachinePlace>,
    /// The layouts as the revision set them.
    pub(super) layouts: Layouts,
    pub(super) change: InverseChange,
}

/// The change that reverts a revision.
#[derive(Debug, Clone)]
pub(super) enum InverseChange {
    /// An edit that reverts the revision.
    Edit(Edit),
    /// The machine before a reload or a jump.
    Machine(Machine),
}

#[derive(Debug)]
struct RecordedMachine {
    machine: Machine,
    mark: Fingerprint,
}

/// Revisions of one author that can be undone or redone, oldest first.
#[derive(Debug, Default)]
struct OwnSteps {
    /// Candidates for an undo.
    done: Vec<u64>,
    /// Candidates for a redo: earlier undos.
    undone: Vec<u64>,
}

/// The revisions from a cursor on.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum RevisionsPage {
    /// Consecutive revisions as JSON, empty if the reader has seen all. More may follow.
    Revisions(Vec<Arc<str>>),
    /// The first ones are no longer stored, or never existed: load the whole machine, which is now at this revision.
    Reset(u64),
}

/// Distinguishes the machines of one log without a full comparison: the sum of hashes of the parts that differ from the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) struct Fingerprint(u128);

impl Fingerprint {
    /// The fingerprint of `new`, if `self` is that of `old` and the changes `forth` lead from `old` to `new`.
    fn after(self, old: &Machine, new: &Machine, forth: &[Change]) -> Self {
        Self(self.0.wrapping_add(weight(forth)).wrapping_sub(weight(&changes(new, old))))
    }
}

/// The sum of hashes of all parts in the changes.
fn weight(changes: &[Change]) -> u128 {
    let is_there = |change: &&Change| match change {
        Change::State { .. } | Change::Header { .. } => true,
        Change::Transition { transition, .. } => transition.is_some(),
        Change::DataFlow { data_flow, .. } => data_flow.is_some(),
        Change::StateRemoved { .. } => false,
    };
    let of_one = |change: &Change| {
        let text = serde_json::to_vec(change).unwrap_or_default();
        let mut bytes = [0; 16];
        bytes.copy_from_slice(&blake3::hash(&text).as_bytes()[..16]);
        u128::from_le_bytes(bytes)
    };
    changes.iter().filter(is_there).map(of_one).fold(0, u128::wrapping_add)
}

impl RevisionLog {
    /// The log of a machine that was loaded at this revision.
    pub(super) fn of(machine: Machine, start: u64) -> Self {
        let mut history = Self {
            start,
            revisions: VecDeque::new(),
            machines: BTreeMap::new(),
            nodes: BTreeMap::new(),
            mark: Fingerprint::default(),
            authors: BTreeMap::new(),
            told_from: start + 1,
            told_bytes: 0,
        };
        history.keep(start, machine);
        history
    }

    /// The number of the last revision.
    pub(super) fn last(&self) -> u64 {
        self.revisions.back().map_or(self.start, |last| last.step.revision)
    }

    /// The fingerprint of the machine after these changes, and its node if an earlier revision had an equal machine.
    pub(super) fn place(
        &self,
        old: &Machine,
        new: &Machine,
        forth: &[Change],
    ) -> (Fingerprint, Option<u64>) {
        let mark = self.mark.after(old, new, forth);
        (mark, self.same_as(new, mark))
    }

    fn same_as(&self, machine: &Machine, mark: Fingerprint) -> Option<u64> {
        let node = *self.nodes.get(&mark)?;
        (self.machines.get(&node)?.machine == *machine).then_some(node)
    }

    /// Adds the next revision, which made this machine. It clears its author's redo steps, unless it is an undo or a redo.
    pub(super) fn push(
        &mut self,
        revision: &Revision,
        inverse: Inverse,
        machine: &Machine,
        mark: Fingerprint,
    ) {
        // All its parts came from JSON or text, so serialization cannot fail.
        let text: Arc<str> = serde_json::to_string(revision).unwrap_or_default().into();
        self.told_bytes += text.len();
        self.mark = mark;
        let reverses = self.authors.entry(revision.author.clone()).or_default().push(revision);
        if let Some(reversed) = reverses.and_then(|reversed| self.index(reversed)) {
            self.revisions[reversed].inverse = None;
        }
        let step = alone(revision);
        if step.same_as.is_none() {
            self.keep(step.revision, machine.clone());
        }
        let (text, inverse) = (Some(text), Some(inverse));
        self.revisions.push_back(RecordedRevision { step, text, inverse, reverses });
        if self.revisions.len() > REVISIONS_MAX {
            self.forget_first();
        }
        while self.told_bytes > BYTES_MAX {
            self.forget_text();
        }
    }

    fn forget_first(&mut self) {
        let Some(oldest) = self.revisions.front().map(|oldest| oldest.step.revision) else {
            return;
        };
        if self.told_from == oldest {
            self.forget_text();
        }
        self.revisions.pop_front();
        self.forget_machine(oldest);
        self.authors.values_mut().for_each(|own| own.forget(oldest));
    }

    /// Drops the oldest text.
    fn forget_text(&mut self) {
        let oldest = self.index(self.told_from).and_then(|index| self.revisions[index].text.take());
        self.told_bytes -= oldest.map_or(self.told_bytes, |text| text.len());
        self.told_from += 1;
    }

    /// Stores a machine. The start is never dropped while the machine is open.
    fn keep(&mut self, node: u64, machine: Machine) {
        self.nodes.insert(self.mark, node);
        self.machines.insert(node, RecordedMachine { machine, mark: self.mark });
        if self.machines.len() > MACHINES_MAX + 1
            && let Some(oldest) = self.machines.keys().nth(1).copied()
        {
            self.forget_machine(oldest);
        }
    }

    fn forget_machine(&mut self, node: u64) {
        if let Some(kept) = self.machines.remove(&node)
            && self.nodes.get(&kept.mark) == Some(&node)
        {
            self.nodes.remove(&kept.mark);
        }
    }

    fn index(&self, revision: u64) -> Option<usize> {
        let first = self.revisions.front()?.step.revision;
        let index = usize::try_from(revision.checked_sub(first)?).ok()?;
        (index < self.revisions.len()).then_some(index)
    }

    fn revision(&self, revision: u64) -> Option<&RecordedRevision> {
        self.index(revision).map(|index| &self.revisions[index])
    }

    /// Revisions that a reader has not seen yet; `from` is the first.
    pub(super) fn since(&self, from: u64) -> RevisionsPage {
        if from < self.told_from || from > self.last() + 1 {
            return RevisionsPage::Reset(self.last());
        }
        let mut room = PAGE_BYTES;
        let fits = |text: &&Arc<str>| {
            let is_room = room > 0;
            room = room.saturating_sub(text.len());
            is_room
        };
        let unseen = self.index(from).unwrap_or(self.revisions.len());
        let texts = self.revisions.range(unseen..).filter_map(|told| told.text.as_ref());
        RevisionsPage::Revisions(texts.take_while(fits).cloned().collect())
    }

    /// The name and the inverse of the revision that an author's undo or redo would revert.
    pub(super) fn inverse(
        &self,
        author: &str,
        kind: RevisionKind,
    ) -> Result<(&str, &Inverse), OperationRefusal> {
        let own = self.authors.get(author).and_then(|own| own.last(kind));
        let own = own.and_then(|revision| self.revision(revision));
        let own = own.and_then(|own| Some((&own.step, own.inverse.as_ref()?)));
        let (step, inverse) = own.ok_or(OperationRefusal::NoStep(kind))?;
        self.unless_built_upon(kind, step, inverse)?;
        Ok((&step.name, inverse))
    }

    fn unless_built_upon(
        &self,
        kind: RevisionKind,
        mine: &MachineStep,
        inverse: &Inverse,
    ) -> Result<(), OperationRefusal> {
        let later = self.revisions.iter().rev();
        let later = later.take_while(|later| later.step.revision > mine.revision);
        let mut others = later.filter(|later| later.step.author != mine.author);
        let built = others.find_map(|other| {
            // A later step that was itself reverted does not count.
            let is_new = other.reverses.is_none_or(|reversed| reversed <= mine.revision)
                || other.step.kind == RevisionKind::Redo;
            let theirs = other.inverse.as_ref().filter(|_| is_new)?;
            Some(OperationRefusal::BuiltUpon {
                kind,
                step: mine.name.clone(),
                by: other.step.author.clone(),
                later: other.step.name.clone(),
                place: inverse.place_under(theirs)?.to_string(),
            })
        });
        built.map_or(Ok(()), Err)
    }

    /// All steps in the log.
    pub(super) fn steps(&self) -> MachineSteps {
        let told = |told: &RecordedRevision| {
            let is_kept = self.machines.contains_key(&node(&told.step));
            MachineStep { is_kept, ..told.step.clone() }
        };
        MachineSteps { start: self.start, steps: self.revisions.iter().map(told).collect() }
    }

    /// The name of the step to a revision; `None` at the start.
    pub(super) fn name(&self, revision: u64) -> Option<&str> {
        self.revision(revision).map(|told| told.step.name.as_str())
    }

    /// The node of a revision and its machine. `None` if the machine is no longer stored.
    pub(super) fn machine(&self, revision: u64) -> Option<(u64, &Machine)> {
        let node = self.node(revision)?;
        Some((node, &self.machines.get(&node)?.machine))
    }

    /// The node of a revision in the tree.
    pub(super) fn node(&self, revision: u64) -> Option<u64> {
        if revision == self.start {
            return Some(revision);
        }
        self.revision(revision).map(|told| node(&told.step))
    }

    /// Steps of other authors that a jump between two revisions reverts, counted by author.
    pub(super) fn taken_away(&self, author: &str, from: u64, to: u64) -> BTreeMap<String, usize> {
        let stays: BTreeSet<u64> = self.way(to).map(|step| step.revision).collect();
        let goes = self.way(from).take_while(|step| !stays.contains(&step.revision));
        let mut taken = BTreeMap::new();
        for step in goes.filter(|step| step.author != author) {
            *taken.entry(step.author.clone()).or_default() += 1;
        }
        taken
    }

    /// The steps from a revision back to the start, while they are in the log.
    fn way(&self, revision: u64) -> impl Iterator<Item = &MachineStep> {
        let step_to = |revision: u64| Some(&self.revision(self.node(revision)?)?.step);
        std::iter::successors(step_to(revision), move |step| step_to(step.revision - 1))
    }
}

impl OwnSteps {
    /// Adds a revision. Returns the one that it reverts, if it is an undo or a redo.
    fn push(&mut self, revision: &Revision) -> Option<u64> {
        let (reverses, next) = match revision.kind {
            RevisionKind::Undo => (self.done.pop(), &mut self.undone),
            RevisionKind::Redo => (self.undone.pop(), &mut self.done),
            RevisionKind::Edit | RevisionKind::Reload | RevisionKind::Jump => {
                self.undone.clear();
                (None, &mut self.done)
            }
        };
        next.push(revision.revision);
        reverses
    }

    fn last(&self, kind: RevisionKind) -> Option<u64> {
        let own = if kind == RevisionKind::Redo { &self.undone } else { &self.done };
        own.last().copied()
    }

    fn forget(&mut self, oldest: u64) {
        self.done.retain(|revision| *revision > oldest);
        self.undone.retain(|revision| *revision > oldest);
    }
}

impl Inverse {
    /// The place of this revision that a later one builds upon. Layouts are excluded: merging them finds conflicts by element.
    fn place_under(&self, later: &Self) -> Option<&MachinePlace> {
        let is_upon = |place: &&MachinePlace| {
            later.places.iter().any(|later| place.is_built_upon(later) && !place.is_layout(later))
        };
        self.places.iter().find(is_upon)
    }
}

/// A revision without its changes.
fn alone(revision: &Revision) -> MachineStep {
    let Revision { revision, id, author, name, at_ms, kind, same_as, changes: _ } = revision;
    MachineStep {
        revision: *revision,
        id: id.clone(),
        author: author.clone(),
        name: name.clone(),
        at_ms: *at_ms,
        kind: *kind,
        same_as: *same_as,
        is_kept: true,
    }
}

fn node(step: &MachineStep) -> u64 {
    step.same_as.unwrap_or(step.revision)
}

#[cfg(test)]
mod tests;

/// Caches a result for the last requested revision.
#[derive(Debug)]
pub(super) struct RevisionCache<T>(Mutex<Option<(u64, T)>>);

impl<T: Clone> RevisionCache<T> {
    /// A cache with an optional initial value.
    pub(super) fn new(kept: Option<(u64, T)>) -> Self {
        Self(Mutex::new(kept))
    }

    /// The result for a revision. Concurrent callers wait for one computation.
    pub(super) fn of(
        &self,
        revision: u64,
        make: impl FnOnce() -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let mut kept = self.0.lock();
        if let Some((of, value)) = &*kept
            && *of == revision
        {
            return Ok(value.clone());
        }
        let value = make()?;
        *kept = Some((revision, value.clone()));
        Ok(value)
    }
}
