//! What only the holder of the engine touches: the engine, its places, and who runs what.

use crate::active::Active;
use crate::branch::{Turn, Worker};
use crate::crew::Crew;
use crate::recorder::{Record, Recorder};
use crate::signals::{PAUSED, PREEMPTED, STARTED};
use crate::{Clock, Place, Places, tell};
use rafcon_engine::{
    BranchId, Datum, Engine, Event, FrameId, Job, NodeId, Outbox, PathId, Program, ScriptResult,
};
use rafcon_model::OutcomeId;
use std::collections::VecDeque;
use std::sync::Arc;
use std::thread::JoinHandle;

/// What only the holder of the lock touches.
#[derive(Debug)]
pub(crate) struct Core<D> {
    pub(crate) engine: Engine<D>,
    pub(crate) outbox: Outbox<D>,
    /// Answers for scripts that could not be run.
    pub(crate) pending: VecDeque<(FrameId, ScriptResult<D>)>,
    known: Vec<Option<Arc<Place>>>,
    /// The same, for those who do not hold the engine.
    places: Arc<Places>,
    pub(crate) crew: Crew<D>,
    pub(crate) threads: Vec<JoinHandle<()>>,
    /// The flags of every place that no script has been asked to end at.
    flags: u8,
}

/// What one input came to, for the thread that gave it.
pub(crate) type Next<D> = Option<Turn<D>>;

/// What an input comes to, for the thread that gives it.
pub(crate) struct Turning<D> {
    /// The thread's branch; none for a command from outside.
    own: Option<BranchId>,
    /// The next script of that branch.
    next: Next<D>,
    /// The thread itself, if that branch has ended.
    freed: Option<Arc<Worker<D>>>,
}

impl<D> Turning<D> {
    /// Nothing came of it yet.
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
            places,
            crew: Crew::new(active),
            threads: Vec::new(),
            flags: 0,
        }
    }

    /// Notes the events down, and makes the places that they are the first to name.
    pub(crate) fn record(&mut self, clock: Clock, recorder: &Recorder) {
        if self.outbox.events.is_empty() {
            return;
        }
        let now = clock.now_ns();
        let mut events = std::mem::take(&mut self.outbox.events);
        for event in &events {
            match event {
                Event::Entered { path, node, .. } => self.enter(*path, *node, now),
                Event::Left { path, outcome, .. } => self.leave(*path, *outcome),
                Event::Stopping => self.set_flags(0),
                _ => {}
            }
        }
        recorder.push(now, events.iter().filter_map(|event| told(&self.engine, event)));
        events.clear();
        self.outbox.events = events;
    }

    fn enter(&mut self, path: PathId, node: NodeId, now: u64) {
        let place = Arc::clone(self.place_of(path, node));
        place.enter(now, self.around(&place));
    }

    /// The place with this number, made if it is new.
    pub(crate) fn place_of(&mut self, path: PathId, node: NodeId) -> &Arc<Place> {
        let index = path.index();
        if self.known.len() <= index {
            self.known.resize(index + 1, None);
        }
        let (engine, flags, places) = (&self.engine, self.flags, &self.places);
        self.known[index].get_or_insert_with(|| {
            let text = engine.path_text(path).to_string();
            let place = Arc::new(Place::new(path, node, engine.path_parent(path), text.into()));
            place.signals.set(flags, true);
            places.insert(Arc::clone(&place));
            place
        })
    }

    /// Makes ready what the script's thread needs.
    pub(crate) fn begin(&mut self, job: Job<D>) -> Turn<D> {
        let place = Arc::clone(self.place_of(job.path, job.node));
        place.signals.begin(job.preempted);
        Turn { job, place }
    }

    /// How many threads there were.
    #[cfg(test)]
    pub(crate) fn threads(&self) -> usize {
        self.threads.len()
    }

    fn at(&self, path: PathId) -> Option<&Arc<Place>> {
        self.known.get(path.index()).and_then(Option::as_ref)
    }

    fn around(&self, place: &Place) -> Option<&Place> {
        self.at(place.parent?).map(|around| &**around)
    }

    fn leave(&self, path: PathId, outcome: OutcomeId) {
        if let Some(place) = self.at(path) {
            place.leave(outcome, self.around(place));
        }
    }

    pub(crate) fn pause(&mut self, paused: bool) {
        self.set_flags(if paused { PAUSED } else { STARTED });
    }

    fn set_flags(&mut self, flags: u8) {
        self.flags = flags;
        for place in self.known.iter().flatten() {
            place.signals.set((PAUSED | STARTED) & !flags, false);
            place.signals.set(flags, true);
        }
    }

    pub(crate) fn signal(&self, path: PathId) {
        if let Some(place) = self.at(path) {
            place.signals.set(PREEMPTED, true);
        }
    }

    pub(crate) fn dispatch(&mut self, begun: Turn<D>, turn: &mut Turning<D>) {
        if turn.own == Some(begun.job.branch) {
            self.crew.go_on(&begun);
            turn.next = Some(begun);
        } else {
            self.crew.post(begun);
        }
    }

    pub(crate) fn end_branch(&mut self, branch: BranchId, turn: &mut Turning<D>) {
        let worker = self.crew.end(branch);
        if turn.own == Some(branch) {
            turn.freed = worker;
        } else if let Some(waiting) = worker {
            self.crew.retire(waiting);
        }
    }

    /// What the thread that gave the input does next.
    pub(crate) fn settle(&mut self, turn: Turning<D>) -> Next<D> {
        match (turn.next, turn.freed, turn.own) {
            (Some(next), _, _) => Some(next),
            (None, Some(freed), _) => self.crew.take(freed),
            (None, None, Some(branch)) => {
                self.crew.rest(branch);
                None
            }
            (None, None, None) => None,
        }
    }
}

fn told<D: Datum>(engine: &Engine<D>, event: &Event<D>) -> Option<Record> {
    match event {
        Event::Entered { path, .. } => Some(Record::Entered(*path)),
        Event::Left { path, outcome, .. } => Some(Record::Left(*path, *outcome)),
        Event::Finished { .. } => None,
        event => tell::rare(event, engine),
    }
}
