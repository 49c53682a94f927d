//! What states leave behind so that a run can be stepped back. Knows what is kept and how much of it; how it is used stands in
//! `backward/`.

use crate::Datum;
use crate::engine::state::frames::{Children, ConcurrentChild, Frame, Slot};
use crate::engine::state::step::{Step, View};
use crate::program::Body;
use std::collections::VecDeque;
use std::sync::Arc;

/// Steps that are kept in a run by default: more than anyone goes back by hand, and few enough that the
/// values that they hold on to, and the memory that is written for each state, do not matter.
pub(in crate::engine) const STEPS_MAX: usize = 2_000;
/// Steps that are kept beyond the limit before the oldest are given up, all at once.
const SLACK: usize = 500;
/// How deep containers that ended are kept; what is deeper is given up, so that no stack depends on the depth of a machine.
const DEPTH_MAX: u32 = 200;

/// Values that were replaced, with their slots.
pub(in crate::engine) type ReplacedValues<D> = Vec<(u32, Slot<D>)>;

/// What became of the children of a hierarchy, the oldest first.
#[derive(Debug)]
pub(in crate::engine) struct UndoLog<D> {
    pub(in crate::engine) entries: VecDeque<UndoEntry<D>>,
    /// The values that children replaced, with their slots, for all entries one after the other.
    pub(in crate::engine) undo: VecDeque<(u32, Slot<D>)>,
    /// Older entries were dropped.
    pub(in crate::engine) lost: bool,
    /// Values that children replace are kept.
    pub(in crate::engine) logs: bool,
    /// The last child is active backwards.
    pub(in crate::engine) undoing: bool,
    /// All steps in it, with those inside of containers.
    weight: usize,
    depth: u32,
}

/// One child that ended, and how the hierarchy stood before it began.
#[derive(Debug)]
pub(in crate::engine) struct UndoEntry<D> {
    pub(in crate::engine) child: u32,
    pub(in crate::engine) run: EndedRun<D>,
    pub(in crate::engine) last: Option<(u32, u32)>,
    /// The error that was handed to the child.
    pub(in crate::engine) error: Option<Box<D>>,
    /// How many values it replaced.
    pub(in crate::engine) replaced: usize,
}

/// A run of a state that ended.
#[derive(Debug)]
pub(in crate::engine) struct EndedRun<D> {
    /// The number of its entry; 0 if it was skipped.
    pub(in crate::engine) entry: u64,
    pub(in crate::engine) outcome: u32,
    pub(in crate::engine) kept: Kept<D>,
}

/// What was in a state when it ended.
#[derive(Debug)]
pub(in crate::engine) enum Kept<D> {
    /// It was a script, or was skipped.
    Nothing,
    Inner(Box<EndedContainerData<D>>),
    /// It was dropped.
    Lost,
}

/// The data of a container that ended, as it was then.
#[derive(Debug)]
pub(in crate::engine) struct EndedContainerData<D> {
    pub(in crate::engine) inputs: Arc<[D]>,
    pub(in crate::engine) slots: Vec<Slot<D>>,
    pub(in crate::engine) last: Option<(u32, u32)>,
    pub(in crate::engine) last_error: Option<D>,
    pub(in crate::engine) start_depth: Option<u32>,
    pub(in crate::engine) children: Children<D>,
    depth: u32,
    weight: usize,
}

impl<D> Default for UndoLog<D> {
    fn default() -> Self {
        Self {
            entries: VecDeque::new(),
            undo: VecDeque::new(),
            lost: false,
            logs: false,
            undoing: false,
            weight: 0,
            depth: 0,
        }
    }
}

impl<D> UndoLog<D> {
    pub(in crate::engine) fn push(&mut self, entry: UndoEntry<D>) {
        self.weight += entry.run.weight();
        self.depth = self.depth.max(entry.run.depth());
        self.entries.push_back(entry);
    }

    /// The last child ended once more; it replaced so many values more.
    pub(in crate::engine) fn renew(&mut self, run: EndedRun<D>, replaced: usize) {
        let Some(mut entry) = self.entries.pop_back() else { return };
        self.weight -= entry.run.weight();
        entry.run = run;
        entry.replaced += replaced;
        self.push(entry);
    }

    /// Takes out what the last child left behind; its place stays.
    pub(in crate::engine) fn take_run(&mut self) -> Option<(u32, EndedRun<D>)> {
        let entry = self.entries.back_mut()?;
        self.weight -= entry.run.weight() - 1;
        Some((entry.child, entry.run.take()))
    }

    /// Takes away the last entry, with the values that its child replaced, the last one first.
    pub(in crate::engine) fn pop(&mut self) -> Option<(UndoEntry<D>, ReplacedValues<D>)> {
        let entry = self.entries.pop_back()?;
        self.weight -= entry.run.weight();
        let first = self.undo.len().saturating_sub(entry.replaced);
        let values = self.undo.drain(first..).rev().collect();
        Some((entry, values))
    }

    /// Whether what is counted is there.
    pub(in crate::engine) fn adds_up(&self) -> bool {
        let weight: usize = self.entries.iter().map(|entry| entry.run.weight()).sum();
        let replaced: usize = self.entries.iter().map(|entry| entry.replaced).sum();
        let inner = self.entries.iter().filter_map(|entry| match &entry.run.kept {
            Kept::Inner(inner) => Some(inner),
            Kept::Nothing | Kept::Lost => None,
        });
        let mut inner = inner.map(|inner| inner.weight == inner.children.weight());
        weight == self.weight && replaced <= self.undo.len() && inner.all(|inner| inner)
    }

    /// Gives up the oldest entries until this many steps are gone, or nothing is left.
    fn shorten(&mut self, steps: usize) -> usize {
        let before = self.weight;
        while before - self.weight < steps {
            let Some(entry) = self.entries.pop_front() else { break };
            self.weight -= entry.run.weight();
            self.undo.drain(..entry.replaced.min(self.undo.len()));
            self.lost = true;
        }
        before - self.weight
    }
}

impl<D> EndedRun<D> {
    /// Of a state that was passed without being entered.
    pub(in crate::engine) fn skipped(outcome: u32) -> Self {
        Self { entry: 0, outcome, kept: Kept::Nothing }
    }

    /// Of a state that ended before the run was resumed.
    pub(in crate::engine) fn unknown(outcome: u32) -> Self {
        Self { entry: 0, outcome, kept: Kept::Lost }
    }

    fn weight(&self) -> usize {
        match &self.kept {
            Kept::Nothing | Kept::Lost => 1,
            Kept::Inner(inner) => 1 + inner.weight,
        }
    }

    fn depth(&self) -> u32 {
        match &self.kept {
            Kept::Nothing | Kept::Lost => 0,
            Kept::Inner(inner) => inner.depth,
        }
    }

    pub(in crate::engine) fn is_lost(&self) -> bool {
        matches!(self.kept, Kept::Lost)
    }

    /// Moves everything out that is heavy.
    fn take(&mut self) -> Self {
        let kept = std::mem::replace(&mut self.kept, Kept::Nothing);
        Self { entry: self.entry, outcome: self.outcome, kept }
    }
}

impl<D> Children<D> {
    /// What those that ended left behind, other than in the undo log of a hierarchy.
    fn runs(&self) -> impl Iterator<Item = &EndedRun<D>> {
        let (one, many): (Option<&EndedRun<D>>, &[ConcurrentChild<D>]) = match self {
            Self::None | Self::Hierarchy(_) => (None, &[]),
            Self::Library(root) => (root.run.as_ref(), &[]),
            Self::Concurrency(children) => (None, &children.all),
        };
        one.into_iter().chain(many.iter().filter_map(|child| child.run.as_ref()))
    }

    fn runs_mut(&mut self) -> impl Iterator<Item = &mut EndedRun<D>> {
        let (one, many): (Option<&mut EndedRun<D>>, &mut [ConcurrentChild<D>]) = match self {
            Self::None | Self::Hierarchy(_) => (None, &mut []),
            Self::Library(root) => (root.run.as_mut(), &mut []),
            Self::Concurrency(children) => (None, &mut children.all),
        };
        one.into_iter().chain(many.iter_mut().filter_map(|child| child.run.as_mut()))
    }

    /// Steps kept in them.
    fn weight(&self) -> usize {
        let logged = self.in_turn().map_or(0, |children| children.undo_log.weight);
        logged + self.runs().map(EndedRun::weight).sum::<usize>()
    }

    fn depth(&self) -> u32 {
        let logged = self.in_turn().map_or(0, |children| children.undo_log.depth);
        self.runs().map(EndedRun::depth).fold(logged, u32::max)
    }

    /// Whether it is known what all of them did: not what they did before the run was restored.
    fn are_known(&self) -> bool {
        let is_undoable = self.side_by_side().is_none_or(|children| children.base.is_some());
        is_undoable && !self.runs().any(EndedRun::is_lost)
    }
}

impl<D> Frame<D> {
    /// Takes what is in the frame of a container that ends.
    fn take_inner(&mut self) -> EndedContainerData<D> {
        let children = std::mem::replace(&mut self.children, Children::None);
        EndedContainerData {
            inputs: self.inputs.clone().unwrap_or_default(),
            slots: std::mem::take(&mut self.slots),
            last: self.last,
            last_error: self.last_error.take(),
            start_depth: self.start_depth,
            depth: 1 + children.depth(),
            weight: children.weight(),
            children,
        }
    }
}

impl<D: Datum> Step<'_, D> {
    /// What a state that ends leaves behind; nothing, if the run is not to be stepped back.
    pub(in crate::engine) fn ended_run(&mut self, slot: u32, outcome: u32) -> Option<EndedRun<D>> {
        if !self.view().keeps_undo_log() {
            return None;
        }
        let body = self.view().body(slot);
        let frame = self.run.frames.get_mut(slot);
        let entry = frame.undoes.map_or(frame.entry, |(entry, _)| entry);
        let kept = match body {
            Body::Script => Kept::Nothing,
            Body::Hierarchy(_) | Body::Concurrency(..) | Body::Library(_) => {
                let is_known = frame.children.are_known();
                let inner = frame.take_inner();
                if !is_known || inner.depth > DEPTH_MAX {
                    Kept::Lost
                } else {
                    Kept::Inner(Box::new(inner))
                }
            }
        };
        Some(EndedRun { entry, outcome, kept })
    }

    /// Notes that a child of a hierarchy ended, which replaced all values from `first` on.
    pub(in crate::engine) fn log_end(
        &mut self,
        slot: u32,
        child: u32,
        run: EndedRun<D>,
        first: usize,
    ) {
        let frame = self.run.frames.get_mut(slot);
        let last = frame.last;
        let Some(children) = frame.children.in_turn_mut() else { return };
        let replaced = children.undo_log.undo.len() - first;
        if std::mem::take(&mut children.undo_log.undoing) {
            return children.undo_log.renew(run, replaced);
        }
        let error = children.handed_error.take().map(Box::new);
        children.undo_log.push(UndoEntry { child, run, last, error, replaced });
        self.run.steps_kept += 1;
        if self.run.steps_kept > self.run.steps_max + SLACK {
            self.shorten_undo_logs();
        }
    }

    /// Gives up the oldest steps, those of the outermost states first.
    fn shorten_undo_logs(&mut self) {
        let active = self.view().active();
        let weights = active.iter().map(|&slot| self.run.frames.get(slot).children.weight());
        let total = weights.sum::<usize>();
        let mut excess = total.saturating_sub(self.run.steps_max);
        self.run.steps_kept = total - excess;
        for slot in active {
            let children = &mut self.run.frames.get_mut(slot).children;
            if let Some(children) = children.in_turn_mut() {
                excess = excess.saturating_sub(children.undo_log.shorten(excess));
            }
            for run in children.runs_mut() {
                if excess > 0 {
                    excess = excess.saturating_sub(run.weight() - 1);
                    run.kept = Kept::Lost;
                }
            }
        }
    }
}

impl<D: Datum> View<'_, '_, D> {
    pub(in crate::engine) fn keeps_undo_log(&self) -> bool {
        self.run.steps_max > 0
    }
}
