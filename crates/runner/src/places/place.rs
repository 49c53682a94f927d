//! Places of the machine that a run has reached: their names, flags and latest numbers. This module knows no values.

use crate::Signals;
use rafcon_engine::{NodeId, PathId};
use rafcon_model::OutcomeId;
use rafcon_protocol::Keeping;
use rafcon_storage::journal::PlaceNumber;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// Value for no place, in a field with the number of a place.
const NOWHERE: u32 = u32::MAX;
/// Value for no outcome, in a field with an outcome.
const NEVER_LEFT: i64 = i64::MIN;

/// One place where a state can run.
#[derive(Debug)]
pub struct Place {
    /// Number of the place in the run.
    pub path: PathId,
    /// The state at this place.
    pub node: NodeId,
    /// The place around it; `None` for the root.
    pub parent: Option<PathId>,
    /// State ids from the root, joined by `/`.
    pub text: Arc<str>,
    /// Requests for its script.
    pub signals: Signals,
    /// Keeping level of its state, if the run keeps everything.
    pub keeping: Keeping,
    /// Number of the place in the record of the run.
    pub(crate) number: PlaceNumber,
    /// Line in the list of active scripts, counted from 1; 0 if it has none yet.
    pub(crate) line: AtomicU32,
    entered_ns: AtomicU64,
    active: AtomicBool,
    runs: AtomicU32,
    outcome: AtomicI64,
    /// The child that ended last.
    last_left: AtomicU32,
    /// The sibling that had ended last when this state was entered.
    previous: AtomicU32,
}

impl Place {
    /// A place without history.
    pub(crate) fn new(path: PathId, node: NodeId, parent: Option<PathId>, text: Arc<str>) -> Self {
        Self {
            path,
            node,
            parent,
            text,
            signals: Signals::default(),
            keeping: Keeping::Full,
            number: PlaceNumber(path.0),
            line: AtomicU32::new(0),
            entered_ns: AtomicU64::new(0),
            active: AtomicBool::new(false),
            runs: AtomicU32::new(0),
            outcome: AtomicI64::new(NEVER_LEFT),
            last_left: AtomicU32::new(NOWHERE),
            previous: AtomicU32::new(NOWHERE),
        }
    }

    /// This place with its number in the record and its keeping level.
    pub(crate) fn recorded(self, number: PlaceNumber, keeping: Keeping) -> Self {
        Self { keeping, number, ..self }
    }

    /// Number of entries of its state.
    pub fn runs(&self) -> u32 {
        self.runs.load(Ordering::Relaxed)
    }

    /// True if its state is active.
    pub fn is_active(&self) -> bool {
        self.active.load(Ordering::Relaxed)
    }

    /// The outcome by which its state last ended.
    pub fn outcome(&self) -> Option<OutcomeId> {
        let outcome = self.outcome.load(Ordering::Relaxed);
        (outcome != NEVER_LEFT).then_some(OutcomeId(outcome))
    }

    /// The sibling that ran before the last entry of the state.
    pub fn previous(&self) -> Option<PathId> {
        let previous = self.previous.load(Ordering::Relaxed);
        (previous != NOWHERE).then_some(PathId(previous))
    }

    /// The child that ended last in the current run of the state, if the next has not begun.
    pub fn left_last(&self) -> Option<PathId> {
        let last = self.last_left.load(Ordering::Relaxed);
        (last != NOWHERE).then_some(PathId(last))
    }

    /// Time of the state's last entry, in ns since the start.
    pub fn entered_ns(&self) -> u64 {
        self.entered_ns.load(Ordering::Relaxed)
    }

    /// Time of the state's last entry, in ms since the start.
    pub(crate) fn entered_ms(&self) -> u64 {
        self.entered_ns.load(Ordering::Relaxed) / 1_000_000
    }

    /// Notes the entry of its state; `around` is the place around it. Only the holder of the engine writes.
    pub(crate) fn enter(&self, now_ns: u64, around: Option<&Self>) {
        self.entered_ns.store(now_ns, Ordering::Relaxed);
        self.active.store(true, Ordering::Relaxed);
        self.runs.store(self.runs().wrapping_add(1), Ordering::Relaxed);
        if let Some(around) = around {
            self.previous.store(around.last_left.load(Ordering::Relaxed), Ordering::Relaxed);
        }
        self.last_left.store(NOWHERE, Ordering::Relaxed);
        self.signals.begin(false);
    }

    /// Notes that its state is no longer active, without an outcome.
    pub(crate) fn drop_entry(&self) {
        self.active.store(false, Ordering::Relaxed);
    }

    /// Notes the end of its state.
    pub(crate) fn leave(&self, outcome: OutcomeId, around: Option<&Self>) {
        self.drop_entry();
        self.outcome.store(outcome.0, Ordering::Relaxed);
        if let Some(around) = around {
            around.last_left.store(self.path.0, Ordering::Relaxed);
        }
    }
}

/// Number of places in the first block of [`Places`]. Each further block is as large as all before it.
const FIRST_BLOCK: usize = 1024;
/// Number of blocks, enough for every number that a place can have.
const BLOCKS: usize = 23;

/// One block of places.
type PlaceBlock = Box<[OnceLock<Arc<Place>>]>;

/// All places reached until now, by number. Written by the holder of the engine, read by all. A place is never replaced
/// and never moves, so that readers need no lock: neither a writer nor a fork can delay them.
#[derive(Debug, Default)]
pub struct Places {
    blocks: [OnceLock<PlaceBlock>; BLOCKS],
}

impl Places {
    /// The place with this number, if the run has reached it. Never waits.
    pub fn get(&self, path: PathId) -> Option<&Arc<Place>> {
        let (block, offset, _) = position(path);
        self.blocks.get(block)?.get()?.get(offset)?.get()
    }

    /// Adds a place, unless its number already has one.
    pub(crate) fn insert(&self, place: Arc<Place>) {
        let (block, offset, length) = position(place.path);
        let Some(block) = self.blocks.get(block) else { return };
        let block = block.get_or_init(|| (0..length).map(|_| OnceLock::new()).collect());
        if let Some(entry) = block.get(offset) {
            entry.get_or_init(|| place);
        }
    }
}

/// The block of a place, its index in the block, and the length of the block.
fn position(path: PathId) -> (usize, usize, usize) {
    let index = path.index();
    match (index / FIRST_BLOCK).checked_ilog2() {
        None => (0, index, FIRST_BLOCK),
        Some(doublings) => {
            let start = FIRST_BLOCK << doublings;
            (doublings as usize + 1, index - start, start)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_has_an_entry_of_its_own() {
        let mut expected = (0, 0);
        for index in 0..10 * FIRST_BLOCK {
            let (block, offset, length) = position(PathId(u32::try_from(index).unwrap()));
            assert_eq!((block, offset), expected);
            expected = if offset + 1 == length { (block + 1, 0) } else { (block, offset + 1) };
        }
        let (block, offset, length) = position(PathId(u32::MAX));
        assert!(block < BLOCKS && offset < length);
    }

    #[test]
    fn a_place_is_found_by_its_number_only() {
        let places = Places::default();
        for number in [0, 1023, 1024, 5000] {
            places.insert(Arc::new(Place::new(PathId(number), NodeId(0), None, "".into())));
        }
        let found = (0..6000).filter(|number| places.get(PathId(*number)).is_some());
        assert_eq!(found.collect::<Vec<_>>(), [0, 1023, 1024, 5000]);
    }
}
