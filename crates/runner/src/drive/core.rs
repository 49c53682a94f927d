//! State behind the engine's lock: the engine, its places and its threads.

use crate::drive::branch::{BranchTask, BranchWork, Worker};
use crate::drive::worker_pool::WorkerPool;
use crate::places::active::Active;
use crate::places::last::Last;
use crate::places::limits;
use crate::places::signals::{PAUSED, PREEMPTED, STARTED};
use crate::record::names::Numbering;
use crate::{Place, Places};
use rafcon_engine::{BranchId, Check, Datum, Engine, Input, Job, NodeId, Outbox, PathId, Program};
use rafcon_protocol::Keeping;
use std::collections::VecDeque;
use std::sync::Arc;
use std::thread::JoinHandle;

/// The state that only the holder of the engine's lock may access.
#[derive(Debug)]
pub(crate) struct Core<D> {
    pub(crate) engine: Engine<D>,
    pub(crate) outbox: Outbox<D>,
    /// Results for work that could not be done.
    pub(crate) pending: VecDeque<Input<D>>,
    pub(crate) known: Vec<Option<KnownPlace<D>>>,
    pub(crate) numbering: Numbering,
    /// Number of the program's version, counted from 1.
    pub(crate) generation: u32,
    /// The places of `known`, for threads that do not hold the engine.
    places: Arc<Places>,
    pub(crate) worker_pool: WorkerPool<D>,
    pub(crate) threads: Vec<JoinHandle<()>>,
    /// True after the engine has panicked.
    pub(crate) is_broken: bool,
    /// The pause flags of all places; a new place starts with them.
    flags: u8,
}

/// A place that the run has reached.
#[derive(Debug)]
pub(crate) struct KnownPlace<D> {
    pub(crate) place: Arc<Place>,
    /// The generation of its latest definition in the record; 0 if it has none.
    pub(crate) defined: u32,
    /// The data of the last run, for a container or library state.
    pub(crate) last: Option<Box<Last<D>>>,
}

/// The next work of the thread that passed the input.
pub(crate) type Next<D> = Option<BranchTask<D>>;

/// Results of an input for the thread that passed it.
pub(crate) struct InputOutcome<D> {
    /// The thread's branch; `None` for an input from outside.
    own: Option<BranchId>,
    /// The next work of that branch.
    next: Next<D>,
    /// The thread itself, if its branch has ended.
    freed: Option<Arc<Worker<D>>>,
}

impl<D> InputOutcome<D> {
    /// The results of an input before any effect.
    pub(crate) fn of(own: Option<BranchId>) -> Self {
        Self { own, next: None, freed: None }
    }
}

impl<D: Datum> Core<D> {
    pub(crate) fn new(program: Arc<Program<D>>, places: Arc<Places>, active: Active) -> Self {
        Self {
            engine: Engine::new(program),
            outbox: Outbox::default(),
            pending: VecDeque::new(),
            known: Vec::new(),
            numbering: Numbering::default(),
            generation: 1,
            places,
            worker_pool: WorkerPool::new(active),
            threads: Vec::new(),
            is_broken: false,
            flags: 0,
        }
    }

    /// The place with this number; created if it is new.
    pub(crate) fn place_of(&mut self, path: PathId, node: NodeId) -> &Arc<Place> {
        &self.known(path, node).place
    }

    /// The place with this number and its recorded data; created if it is new.
    pub(crate) fn known(&mut self, path: PathId, node: NodeId) -> &mut KnownPlace<D> {
        let index = path.index();
        if self.known.len() <= index {
            self.known.resize_with(index + 1, || None);
        }
        let (engine, numbering) = (&self.engine, &mut self.numbering);
        let (flags, places) = (self.flags, &self.places);
        self.known[index].get_or_insert_with(|| {
            let text = engine.path_text(path).to_string();
            let number = numbering.number(&text);
            let parent = engine.path_parent(path);
            let place = Place::new(path, node, parent, text.into());
            let place = Arc::new(place.recorded(number, level(engine, path)));
            place.signals.set(flags, true);
            places.insert(Arc::clone(&place));
            KnownPlace { place, defined: 0, last: None }
        })
    }

    /// Prepares the task of a script.
    pub(crate) fn begin(&mut self, job: Job<D>) -> BranchTask<D> {
        let place = Arc::clone(self.place_of(job.path, job.node));
        place.signals.begin(job.preempted);
        BranchTask { work: BranchWork::Script(job), place }
    }

    /// Prepares the task of a condition.
    pub(crate) fn begin_check(&mut self, check: Check<D>) -> BranchTask<D> {
        let place = Arc::clone(self.place_of(check.path, check.node));
        BranchTask { work: BranchWork::Condition(check), place }
    }

    /// The number of threads started.
    #[cfg(test)]
    pub(crate) fn threads(&self) -> usize {
        self.threads.len()
    }

    pub(crate) fn at(&self, path: PathId) -> Option<&Arc<Place>> {
        self.known.get(path.index()).and_then(Option::as_ref).map(|known| &known.place)
    }

    pub(crate) fn around(&self, place: &Place) -> Option<&Place> {
        self.at(place.parent?).map(|around| &**around)
    }

    pub(crate) fn pause(&mut self, paused: bool) {
        self.set_flags(if paused { PAUSED } else { STARTED });
    }

    pub(crate) fn set_flags(&mut self, flags: u8) {
        self.flags = flags;
        for KnownPlace { place, .. } in self.known.iter().flatten() {
            place.signals.set((PAUSED | STARTED) & !flags, false);
            place.signals.set(flags, true);
        }
    }

    pub(crate) fn signal(&self, path: PathId) {
        if let Some(place) = self.at(path) {
            place.signals.set(PREEMPTED, true);
        }
    }

    pub(crate) fn dispatch(&mut self, begun: BranchTask<D>, turn: &mut InputOutcome<D>) {
        if turn.own == Some(begun.branch()) {
            self.worker_pool.go_on(&begun);
            turn.next = Some(begun);
        } else {
            self.worker_pool.post(begun);
        }
    }

    pub(crate) fn end_branch(&mut self, branch: BranchId, turn: &mut InputOutcome<D>) {
        let worker = self.worker_pool.end(branch);
        if turn.own == Some(branch) {
            turn.freed = worker;
        } else if let Some(waiting) = worker {
            self.worker_pool.retire(waiting);
        }
    }

    /// Returns the next work of the thread that passed the input.
    pub(crate) fn settle(&mut self, turn: InputOutcome<D>) -> Next<D> {
        match (turn.next, turn.freed, turn.own) {
            (Some(next), _, _) => Some(next),
            (None, Some(freed), _) => self.worker_pool.take(freed),
            (None, None, Some(branch)) => {
                self.worker_pool.rest(branch);
                None
            }
            (None, None, None) => None,
        }
    }
}

/// The keeping level of the state at `path`, if the run keeps everything.
fn level<D: Datum>(engine: &Engine<D>, path: PathId) -> Keeping {
    let around = std::iter::successors(Some(path), |path| engine.path_parent(*path));
    let node = |path| Some(engine.program().node(engine.path_node(path)?));
    around
        .filter_map(node)
        .fold(Keeping::Full, |level, node| limits::keeping_of(node.state(), level))
}
