//! The table of frames: one for each active run of a state. Knows how frames hang together, not what they do.

use crate::engine::state::phase::Phase;
use crate::engine::state::undo_log::{EndedRun, UndoLog};
use crate::{BranchId, FrameId, NodeId, PathId};
use std::sync::Arc;

/// No frame: the parent of the root, and the place of a child that does not run.
pub(in crate::engine) const NONE: u32 = u32::MAX;

/// How a state ended.
#[derive(Debug, Clone)]
pub(in crate::engine) struct Ended<D> {
    /// Index of the outcome in its node.
    pub(in crate::engine) outcome: u32,
    pub(in crate::engine) outputs: Arc<[D]>,
    /// Outputs that a script left out: they flow nowhere.
    pub(in crate::engine) absent: Vec<u32>,
    pub(in crate::engine) error: Option<D>,
}

/// A step that holds nowhere below a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::engine) enum Marker {
    /// It holds before the next child of the frame.
    Over,
    /// It holds nowhere in the frame.
    Out,
}

/// A value in a container.
#[derive(Debug, Clone)]
pub(in crate::engine) struct Slot<D> {
    /// Rises with every value that is put anywhere in the run; 0 in a slot that holds nothing.
    pub(in crate::engine) sequence: u64,
    pub(in crate::engine) value: Option<D>,
}

/// One active run of a state.
#[derive(Debug)]
pub(in crate::engine) struct Frame<D> {
    pub(in crate::engine) generation: u32,
    /// Whether the frame is in use.
    pub(in crate::engine) live: bool,
    pub(in crate::engine) node: NodeId,
    pub(in crate::engine) path: PathId,
    pub(in crate::engine) branch: BranchId,
    pub(in crate::engine) parent: u32,
    pub(in crate::engine) phase: Phase,
    /// Was asked to end. Never taken back.
    pub(in crate::engine) preempted: bool,
    /// The step that is under way here.
    pub(in crate::engine) marker: Option<Marker>,
    /// It was let go before this child, or [`NONE`] at the end of another: nothing holds it there again.
    pub(in crate::engine) pass: Option<u32>,
    /// A child was left, and breakpoints behind it have not been looked at.
    pub(in crate::engine) after: bool,
    /// The number of its entry, counted over all entries of the run.
    pub(in crate::engine) entry: u64,
    /// It was entered backwards: the number of the entry that is undone, and the outcome of then.
    pub(in crate::engine) undoes: Option<(u64, u32)>,
    /// The error that was handed to the child that is active.
    pub(in crate::engine) gave: Option<D>,
    /// What became of the children of a hierarchy.
    pub(in crate::engine) trail: UndoLog<D>,
    /// How the branches of a concurrency state ended, or the root of a library.
    pub(in crate::engine) pasts: Vec<Option<EndedRun<D>>>,
    /// The children of a concurrency state in the order in which they ended.
    pub(in crate::engine) order: Vec<u32>,
    /// The values of a concurrency state before any child ended.
    pub(in crate::engine) base: Vec<Slot<D>>,
    /// How many steps of the start path lead to here, while it leads on from here.
    pub(in crate::engine) start_depth: Option<u32>,
    /// Its inputs.
    pub(in crate::engine) inputs: Option<Arc<[D]>>,
    /// The defaults of its outputs, until its end takes them.
    pub(in crate::engine) outputs: Option<Arc<[D]>>,
    /// The error that it was given.
    pub(in crate::engine) error: Option<D>,
    /// The error that its last child left, for the next.
    pub(in crate::engine) last_error: Option<D>,
    /// The child that ended last and the index of its outcome.
    pub(in crate::engine) last: Option<(u32, u32)>,
    /// The answer in which a child of a hierarchy ended last, and how many did in it.
    pub(in crate::engine) turn: u64,
    pub(in crate::engine) steps: u32,
    /// The values in a container.
    pub(in crate::engine) slots: Vec<Slot<D>>,
    /// Active children: one entry for each child of a concurrency state, one entry for any other.
    pub(in crate::engine) children: Vec<u32>,
    /// How the children of a concurrency state ended; how a library state is about to end.
    pub(in crate::engine) ended: Vec<Option<Ended<D>>>,
    /// How many children of a concurrency state have not ended, started or not.
    pub(in crate::engine) open: u32,
    /// The child of a preemptive state that ended first.
    pub(in crate::engine) winner: Option<u32>,
}

/// All frames. Frames are used again, with the lists that they have grown.
#[derive(Debug)]
pub(in crate::engine) struct Frames<D> {
    all: Vec<Frame<D>>,
    free: Vec<u32>,
}

/// What every frame begins with.
#[derive(Debug)]
pub(in crate::engine) struct Seed<D> {
    pub(in crate::engine) node: NodeId,
    pub(in crate::engine) path: PathId,
    pub(in crate::engine) branch: BranchId,
    pub(in crate::engine) parent: u32,
    pub(in crate::engine) preempted: bool,
    pub(in crate::engine) start_depth: Option<u32>,
    pub(in crate::engine) inputs: Arc<[D]>,
    pub(in crate::engine) outputs: Arc<[D]>,
    pub(in crate::engine) error: Option<D>,
    /// Where among the events of this answer the state is entered: before the notes about its inputs.
    pub(in crate::engine) entered_at: usize,
}

impl<D> Frames<D> {
    pub(in crate::engine) fn new() -> Self {
        Self { all: Vec::new(), free: Vec::new() }
    }

    pub(in crate::engine) fn get(&self, slot: u32) -> &Frame<D> {
        &self.all[slot as usize]
    }

    pub(in crate::engine) fn get_mut(&mut self, slot: u32) -> &mut Frame<D> {
        &mut self.all[slot as usize]
    }

    /// The place of a frame that is still the one with this id.
    pub(in crate::engine) fn find(&self, id: FrameId) -> Option<u32> {
        let frame = self.all.get(id.slot as usize)?;
        (frame.live && frame.generation == id.generation).then_some(id.slot)
    }

    pub(in crate::engine) fn id(&self, slot: u32) -> FrameId {
        FrameId { slot, generation: self.get(slot).generation }
    }

    pub(in crate::engine) fn add(&mut self, seed: Seed<D>) -> u32 {
        let slot = self.free.pop().unwrap_or_else(|| self.grow());
        let frame = &mut self.all[slot as usize];
        frame.live = true;
        frame.node = seed.node;
        frame.path = seed.path;
        frame.branch = seed.branch;
        frame.parent = seed.parent;
        frame.phase = Phase::Begun;
        frame.preempted = seed.preempted;
        frame.marker = None;
        frame.pass = None;
        frame.after = false;
        frame.undoes = None;
        frame.trail.begin();
        frame.start_depth = seed.start_depth;
        frame.inputs = Some(seed.inputs);
        frame.outputs = Some(seed.outputs);
        frame.error = seed.error;
        slot
    }

    fn grow(&mut self) -> u32 {
        let slot = u32::try_from(self.all.len()).unwrap_or(NONE);
        self.all.push(Frame {
            generation: 0,
            live: false,
            node: NodeId(0),
            path: PathId(0),
            branch: BranchId(0),
            parent: NONE,
            phase: Phase::Begun,
            preempted: false,
            marker: None,
            pass: None,
            after: false,
            entry: 0,
            undoes: None,
            gave: None,
            trail: UndoLog::default(),
            pasts: Vec::new(),
            order: Vec::new(),
            base: Vec::new(),
            start_depth: None,
            inputs: None,
            outputs: None,
            error: None,
            last_error: None,
            last: None,
            turn: 0,
            steps: 0,
            slots: Vec::new(),
            children: Vec::new(),
            ended: Vec::new(),
            open: 0,
            winner: None,
        });
        slot
    }

    /// Ends the use of a frame and drops its values.
    pub(in crate::engine) fn remove(&mut self, slot: u32) {
        let frame = &mut self.all[slot as usize];
        frame.live = false;
        frame.generation = frame.generation.wrapping_add(1);
        frame.inputs = None;
        frame.outputs = None;
        frame.error = None;
        frame.last_error = None;
        frame.last = None;
        frame.gave = None;
        frame.trail.clear();
        frame.pasts.clear();
        frame.order.clear();
        frame.base.clear();
        frame.steps = 0;
        frame.slots.clear();
        frame.children.clear();
        frame.ended.clear();
        frame.open = 0;
        frame.winner = None;
        self.free.push(slot);
    }

    /// The frames in use, by rising number.
    pub(in crate::engine) fn live(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.all).filter(|(_, frame)| frame.live).map(|(slot, _)| slot)
    }

    /// Whether each frame is either in use or free.
    pub(in crate::engine) fn are_accounted_for(&self) -> bool {
        let is_free = |slot: &u32| self.all.get(*slot as usize).is_some_and(|frame| !frame.live);
        self.free.iter().all(is_free) && self.live().count() + self.free.len() == self.all.len()
    }

    /// The active frames at and below `top`: parents before children, children in their order.
    pub(in crate::engine) fn below(&self, top: u32) -> Vec<u32> {
        let mut found = Vec::new();
        let mut stack = vec![top];
        while let Some(slot) = stack.pop() {
            found.push(slot);
            let children = self.get(slot).children.iter().rev();
            stack.extend(children.copied().filter(|&child| child != NONE));
        }
        found
    }
}
