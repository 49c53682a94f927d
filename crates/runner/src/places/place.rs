//! Places of the machine as a run has met them: their names, flags and latest numbers. Knows no values.

use crate::Signals;
use rafcon_engine::{NodeId, PathId};
use rafcon_model::OutcomeId;
use rafcon_protocol::Keeping;
use rafcon_storage::journal::PlaceNumber;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// No place, in a field that may hold the number of one.
const NOWHERE: u32 = u32::MAX;
/// No outcome, in a field that may hold one.
const NEVER_LEFT: i64 = i64::MIN;

/// One place where a state can run.
#[derive(Debug)]
pub struct Place {
    /// Its number in the run.
    pub path: PathId,
    /// Which state stands there.
    pub node: NodeId,
    /// The place around it; `None` for the root.
    pub parent: Option<PathId>,
    /// State ids from the root, joined by `/`.
    pub text: Arc<str>,
    /// What its script is asked to do.
    pub signals: Signals,
    /// How much is kept of its state, if everything is kept of the run.
    pub keeping: Keeping,
    /// Its number in the record of the run.
    pub(crate) number: PlaceNumber,
    /// Its line in the list of active scripts, counted from 1; 0 if it has none yet.
    pub(crate) line: AtomicU32,
    entered_ns: AtomicU64,
    active: AtomicBool,
    runs: AtomicU32,
    outcome: AtomicI64,
    /// The child that was left last.
    last_left: AtomicU32,
    /// The sibling that was left last when this state was entered.
    previous: AtomicU32,
}

impl Place {
    /// A place that nothing has happened at.
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

    /// The same with another number in the record, and a choice of how much is kept.
    pub(crate) fn recorded(self, number: PlaceNumber, keeping: Keeping) -> Self {
        Self { keeping, number, ..self }
    }

    /// How often its state was entered.
    pub fn runs(&self) -> u32 {
        self.runs.load(Ordering::Relaxed)
    }

    /// Whether its state is active.
    pub fn is_active(&self) -> bool {
        self.active.load(Ordering::Relaxed)
    }

    /// The outcome by which its state was left last.
    pub fn outcome(&self) -> Option<OutcomeId> {
        let outcome = self.outcome.load(Ordering::Relaxed);
        (outcome != NEVER_LEFT).then_some(OutcomeId(outcome))
    }

    /// The sibling that ran before the state was entered last.
    pub fn previous(&self) -> Option<PathId> {
        let previous = self.previous.load(Ordering::Relaxed);
        (previous != NOWHERE).then_some(PathId(previous))
    }

    /// The child that was left last in the run of its state, if the next has not begun.
    pub fn left_last(&self) -> Option<PathId> {
        let last = self.last_left.load(Ordering::Relaxed);
        (last != NOWHERE).then_some(PathId(last))
    }

    /// When its state was entered last, in ns since the start.
    pub fn entered_ns(&self) -> u64 {
        self.entered_ns.load(Ordering::Relaxed)
    }

    /// When its state was entered last, in ms since the start.
    pub(crate) fn entered_ms(&self) -> u64 {
        self.entered_ns.load(Ordering::Relaxed) / 1_000_000
    }

    /// Its state is entered; `around` is the place around it. Only the holder of the engine writes.
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

    /// Its state is not active any more, and has no outcome.
    pub(crate) fn drop_entry(&self) {
        self.active.store(false, Ordering::Relaxed);
    }

    /// Its state is left.
    pub(crate) fn leave(&self, outcome: OutcomeId, around: Option<&Self>) {
        self.drop_entry();
        self.outcome.store(outcome.0, Ordering::Relaxed);
        if let Some(around) = around {
            around.last_left.store(self.path.0, Ordering::Relaxed);
        }
    }
}

/// How many places lie in the first block of [`Places`]; each further block is as large as all before it.
const FIRST_BLOCK: usize = 1024;
/// Enough blocks for every number that a place can have.
const BLOCKS: usize = 23;

/// One block of places.
type PlaceBlock = Box<[OnceLock<Arc<Place>>]>;

/// All places met so far, by number. Written by the holder of the engine, read by all. A place is never replaced and never moves,
/// so that readers take no lock: neither a writer nor a fork can hold them up.
#[derive(Debug, Default)]
pub struct Places {
    blocks: [OnceLock<PlaceBlock>; BLOCKS],
}

impl Places {
    /// The place with this number, if the run has met it. Never waits.
    pub fn get(&self, path: PathId) -> Option<&Arc<Place>> {
        let (block, offset, _) = position(path);
        self.blocks.get(block)?.get()?.get(offset)?.get()
    }

    /// Adds a place. The first with its number stays.
    pub(crate) fn insert(&self, place: Arc<Place>) {
        let (block, offset, length) = position(place.path);
        let Some(block) = self.blocks.get(block) else { return };
        let block = block.get_or_init(|| (0..length).map(|_| OnceLock::new()).collect());
        if let Some(entry) = block.get(offset) {
            entry.get_or_init(|| place);
        }
    }
}

/// In which block a place lies, where in it, and how many places the block has.
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
