//! The table of frames: one for each active run of a state. It knows the tree of frames, not what frames do.

use crate::engine::state::phase::Phase;
use crate::engine::state::undo_log::{EndedRun, UndoLog};
use crate::program::{Body, Inside, Node};
use crate::{BranchId, FrameId, NodeId, PathId};
use std::sync::Arc;

/// No frame: the parent of the root, and the entry of a child that is not active.
pub(in crate::engine) const NONE: u32 = u32::MAX;

/// The end of a state.
#[derive(Debug, Clone)]
pub(in crate::engine) struct Ended<D> {
    /// Index of the outcome in its node.
    pub(in crate::engine) outcome: u32,
    pub(in crate::engine) outputs: Arc<[D]>,
    /// Output ports that a script left out; no value flows from them.
    pub(in crate::engine) absent: Vec<u32>,
    pub(in crate::engine) error: Option<D>,
}

/// The end of a child, and what it leaves to undo it.
#[derive(Debug)]
pub(in crate::engine) struct EndedChild<D> {
    pub(in crate::engine) ended: Ended<D>,
    /// `None` if the run keeps no undo log.
    pub(in crate::engine) run: Option<EndedRun<D>>,
}

/// The extent of a step that holds nowhere below a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::engine) enum Marker {
    /// The step holds before the next child of the frame.
    Over,
    /// The step holds nowhere in the frame.
    Out,
}

/// A value in a container, and its age.
#[derive(Debug, Clone)]
pub(in crate::engine) struct Slot<D> {
    /// Rises with every value stored anywhere in the run; 0 for an empty slot.
    pub(in crate::engine) sequence: u64,
    pub(in crate::engine) value: Option<D>,
}

/// One active run of a state.
#[derive(Debug)]
pub(in crate::engine) struct Frame<D> {
    pub(in crate::engine) generation: u32,
    /// True while the frame is in use.
    pub(in crate::engine) live: bool,
    pub(in crate::engine) node: NodeId,
    pub(in crate::engine) path: PathId,
    pub(in crate::engine) branch: BranchId,
    pub(in crate::engine) parent: u32,
    pub(in crate::engine) phase: Phase,
    /// True if the frame was asked to end. Never reset.
    pub(in crate::engine) preempted: bool,
    /// The step that is in progress in this frame.
    pub(in crate::engine) marker: Option<Marker>,
    /// Child before which a hold was released, or [`NONE`] at the end of another child. Nothing holds the branch there
    /// again.
    pub(in crate::engine) pass: Option<u32>,
    /// True after the end of a child, until the breakpoints after it are evaluated.
    pub(in crate::engine) after: bool,
    /// Number of the frame's entry among all entries of the run.
    pub(in crate::engine) entry: u64,
    /// For a frame entered backwards: the number of the undone entry, and its outcome.
    pub(in crate::engine) undoes: Option<(u64, u32)>,
    /// Depth on the start path, while the path continues below this frame.
    pub(in crate::engine) start_depth: Option<u32>,
    /// Values of the input ports.
    pub(in crate::engine) inputs: Option<Arc<[D]>>,
    /// Default values of the outputs, until the end of the state takes them.
    pub(in crate::engine) outputs: Option<Arc<[D]>>,
    /// Error that the state received.
    pub(in crate::engine) error: Option<D>,
    /// The values of a container: its inputs, its scoped variables, then the outputs of children.
    pub(in crate::engine) slots: Vec<Slot<D>>,
    /// The child that ended last, or that decides, and the index of its outcome.
    pub(in crate::engine) last: Option<(u32, u32)>,
    /// The error of the last child, for the next one.
    pub(in crate::engine) last_error: Option<D>,
    pub(in crate::engine) children: Children<D>,
}

/// The children of an active state by the kind of the state: active children, and what ended children left behind.
#[derive(Debug)]
pub(in crate::engine) enum Children<D> {
    /// Scripts have no children.
    None,
    Library(LibraryRoot<D>),
    Hierarchy(Box<ChildrenInTurn<D>>),
    Concurrency(Box<ChildrenSideBySide<D>>),
}

/// The root of a library state's content.
#[derive(Debug)]
pub(in crate::engine) struct LibraryRoot<D> {
    /// The root's frame, while it is active.
    pub(in crate::engine) active: Option<u32>,
    /// The root's data after its end, for stepping back.
    pub(in crate::engine) run: Option<EndedRun<D>>,
    /// The pending end of the library state, while it is held.
    pub(in crate::engine) end: Option<Box<Ended<D>>>,
}

/// The children of a hierarchy, of which one is active at a time.
#[derive(Debug)]
pub(in crate::engine) struct ChildrenInTurn<D> {
    /// The frame of the active child.
    pub(in crate::engine) active: Option<u32>,
    /// The error that was passed to the active child.
    pub(in crate::engine) handed_error: Option<D>,
    pub(in crate::engine) undo_log: UndoLog<D>,
    /// The last call in which a child ended, and how many ended in it.
    pub(in crate::engine) turn: u64,
    pub(in crate::engine) steps: u32,
}

/// The children of a concurrency state.
#[derive(Debug)]
pub(in crate::engine) struct ChildrenSideBySide<D> {
    /// One entry for each child of the state, including the decider.
    pub(in crate::engine) all: Vec<ConcurrentChild<D>>,
    /// Ended children in the order of their ends.
    pub(in crate::engine) order: Vec<u32>,
    /// The values of the state before any child ended. Without them no child can be undone.
    pub(in crate::engine) base: Option<Vec<Slot<D>>>,
    /// Number of children that have not ended, started or not, without the decider.
    pub(in crate::engine) open: u32,
    /// The winner of the race.
    pub(in crate::engine) winner: Option<u32>,
}

/// One child of a concurrency state.
#[derive(Debug)]
pub(in crate::engine) struct ConcurrentChild<D> {
    /// The child's frame, while it is active.
    pub(in crate::engine) active: Option<u32>,
    pub(in crate::engine) ended: Option<Ended<D>>,
    /// The child's data after its end, for stepping back.
    pub(in crate::engine) run: Option<EndedRun<D>>,
}

impl<D> Children<D> {
    /// The children of a state that begins.
    pub(in crate::engine) fn of(body: &Body<D>) -> Self {
        match body {
            Body::Script => Self::None,
            Body::Library(_) => Self::Library(LibraryRoot { active: None, run: None, end: None }),
            Body::Hierarchy(_) => Self::Hierarchy(Box::new(ChildrenInTurn {
                active: None,
                handed_error: None,
                undo_log: UndoLog::default(),
                turn: 0,
                steps: 0,
            })),
            Body::Concurrency(_, inside) => Self::Concurrency(Box::new(ChildrenSideBySide {
                all: inside.children.iter().map(|_| ConcurrentChild::new()).collect(),
                order: Vec::new(),
                base: None,
                open: 0,
                winner: None,
            })),
        }
    }

    /// The frames of the active children, in the order of children.
    pub(in crate::engine) fn active(&self) -> impl DoubleEndedIterator<Item = u32> {
        let (one, many): (Option<u32>, &[ConcurrentChild<D>]) = match self {
            Self::None => (None, &[]),
            Self::Library(root) => (root.active, &[]),
            Self::Hierarchy(children) => (children.active, &[]),
            Self::Concurrency(children) => (None, &children.all),
        };
        one.into_iter().chain(many.iter().filter_map(|child| child.active))
    }

    pub(in crate::engine) fn any_active(&self) -> bool {
        self.active().next().is_some()
    }

    /// Sets the frame of the active child, or removes it.
    pub(in crate::engine) fn set_active(&mut self, child: u32, frame: Option<u32>) {
        match self {
            Self::None => {}
            Self::Library(root) => root.active = frame,
            Self::Hierarchy(children) => children.active = frame,
            Self::Concurrency(children) => {
                if let Some(child) = children.all.get_mut(child as usize) {
                    child.active = frame;
                }
            }
        }
    }

    pub(in crate::engine) fn library(&mut self) -> Option<&mut LibraryRoot<D>> {
        if let Self::Library(root) = self { Some(root) } else { None }
    }

    pub(in crate::engine) fn in_turn(&self) -> Option<&ChildrenInTurn<D>> {
        if let Self::Hierarchy(children) = self { Some(children) } else { None }
    }

    pub(in crate::engine) fn in_turn_mut(&mut self) -> Option<&mut ChildrenInTurn<D>> {
        if let Self::Hierarchy(children) = self { Some(children) } else { None }
    }

    pub(in crate::engine) fn side_by_side(&self) -> Option<&ChildrenSideBySide<D>> {
        if let Self::Concurrency(children) = self { Some(children) } else { None }
    }

    pub(in crate::engine) fn side_by_side_mut(&mut self) -> Option<&mut ChildrenSideBySide<D>> {
        if let Self::Concurrency(children) = self { Some(children) } else { None }
    }

    /// The child that won the race of a concurrency state.
    pub(in crate::engine) fn winner(&self) -> Option<u32> {
        self.side_by_side().and_then(|children| children.winner)
    }
}

impl<D> ChildrenSideBySide<D> {
    /// The frame of an active child.
    pub(in crate::engine) fn active(&self, child: u32) -> Option<u32> {
        self.all.get(child as usize).and_then(|child| child.active)
    }

    /// The end of a child.
    pub(in crate::engine) fn ended(&self, child: u32) -> Option<&Ended<D>> {
        self.all.get(child as usize).and_then(|child| child.ended.as_ref())
    }

    /// The ended children, each with its end.
    pub(in crate::engine) fn ends(&self) -> impl DoubleEndedIterator<Item = (u32, &Ended<D>)> {
        let all = self.all.iter().enumerate();
        all.filter_map(|(index, child)| Some((crate::program::index(index), child.ended.as_ref()?)))
    }

    /// Records the end of a child and what it left behind.
    pub(in crate::engine) fn end(&mut self, child: u32, ended: Ended<D>, run: Option<EndedRun<D>>) {
        let is_undoable = self.base.is_some();
        if let Some(child) = self.all.get_mut(child as usize) {
            child.active = None;
            child.ended = Some(ended);
            child.run = run.filter(|_| is_undoable);
        }
    }

    /// True if no child is active or has ended.
    pub(in crate::engine) fn are_at_start(&self) -> bool {
        self.all.iter().all(|child| child.active.is_none() && child.ended.is_none())
    }
}

impl<D> ConcurrentChild<D> {
    fn new() -> Self {
        Self { active: None, ended: None, run: None }
    }
}

/// All frames. The slot of an ended frame is reused.
#[derive(Debug)]
pub(in crate::engine) struct Frames<D> {
    all: Vec<Frame<D>>,
    free: Vec<u32>,
}

/// The initial contents of a frame.
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
    /// Position of the entry among the events of this call, before the notes about its inputs.
    pub(in crate::engine) entered_at: usize,
}

impl<D> Frame<D> {
    /// The sequence number of the oldest stored output of a child; 0 if none is stored.
    pub(in crate::engine) fn stored_at(
        &self,
        node: &Node<D>,
        inside: &Inside<D>,
        child: u32,
    ) -> u64 {
        let first = node.inputs().len() + inside.scoped.len();
        let slots = inside.sources.iter().zip(self.slots.iter().skip(first));
        let own = slots.filter(|((source, _), slot)| *source == child && slot.value.is_some());
        own.map(|(_, slot)| slot.sequence).min().unwrap_or_default()
    }

    fn unused() -> Self {
        Self {
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
            start_depth: None,
            inputs: None,
            outputs: None,
            error: None,
            slots: Vec::new(),
            last: None,
            last_error: None,
            children: Children::None,
        }
    }

    /// True if branches that have not begun never will: the state was asked to end, or its race is decided.
    pub(in crate::engine) fn begins_no_branch(&self) -> bool {
        self.preempted || self.children.winner().is_some()
    }
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

    /// The slot of the frame with this id, if it still exists.
    pub(in crate::engine) fn find(&self, id: FrameId) -> Option<u32> {
        let frame = self.all.get(id.slot as usize)?;
        (frame.live && frame.generation == id.generation).then_some(id.slot)
    }

    pub(in crate::engine) fn id(&self, slot: u32) -> FrameId {
        FrameId { slot, generation: self.get(slot).generation }
    }

    pub(in crate::engine) fn add(&mut self, seed: Seed<D>, children: Children<D>) -> u32 {
        let slot = self.free.pop().unwrap_or_else(|| {
            self.all.push(Frame::unused());
            u32::try_from(self.all.len() - 1).unwrap_or(NONE)
        });
        let frame = &mut self.all[slot as usize];
        *frame = Frame {
            generation: frame.generation,
            live: true,
            node: seed.node,
            path: seed.path,
            branch: seed.branch,
            parent: seed.parent,
            preempted: seed.preempted,
            start_depth: seed.start_depth,
            inputs: Some(seed.inputs),
            outputs: Some(seed.outputs),
            error: seed.error,
            children,
            ..Frame::unused()
        };
        slot
    }

    /// Frees a frame and drops its values.
    pub(in crate::engine) fn remove(&mut self, slot: u32) {
        let frame = &mut self.all[slot as usize];
        let generation = frame.generation.wrapping_add(1);
        *frame = Frame { generation, ..Frame::unused() };
        self.free.push(slot);
    }

    /// The frames in use, by rising number.
    pub(in crate::engine) fn live(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.all).filter(|(_, frame)| frame.live).map(|(slot, _)| slot)
    }

    /// True if each frame is either in use or free.
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
            stack.extend(self.get(slot).children.active().rev());
        }
        found
    }
}
