//! The data that states leave behind for stepping back: its contents and limits. `backward/` uses it.

use crate::Datum;
use crate::engine::state::frames::{Children, ConcurrentChild, Frame, Slot};
use crate::engine::state::step::{Step, View};
use crate::program::Body;
use std::collections::VecDeque;
use std::sync::Arc;

/// Default limit of the steps kept in a run. It exceeds what anyone undoes by hand. It is low enough that the values
/// kept, and the memory written for each state, do not matter.
pub(in crate::engine) const STEPS_MAX: usize = 2_000;
/// Steps kept beyond the limit before the oldest are dropped, all at once.
const SLACK: usize = 500;
/// Deepest nesting of ended containers that is kept. Deeper data is dropped, so that no stack depends on the depth of a
/// machine.
const DEPTH_MAX: u32 = 200;

/// Replaced values with their slots.
pub(in crate::engine) type ReplacedValues<D> = Vec<(u32, Slot<D>)>;

/// The ended children of a hierarchy, the oldest first.
#[derive(Debug)]
pub(in crate::engine) struct UndoLog<D> {
    pub(in crate::engine) entries: VecDeque<UndoEntry<D>>,
    /// The values that children replaced, with their slots, for all entries in sequence.
    pub(in crate::engine) undo: VecDeque<(u32, Slot<D>)>,
    /// True if older entries were dropped.
    pub(in crate::engine) lost: bool,
    /// True if replaced values are recorded.
    pub(in crate::engine) logs: bool,
    /// True while the last child is being undone.
    pub(in crate::engine) undoing: bool,
    /// Number of steps in the log, including those inside containers.
    weight: usize,
    depth: u32,
}

/// An ended child of a hierarchy, and the hierarchy's state before it began.
#[derive(Debug)]
pub(in crate::engine) struct UndoEntry<D> {
    pub(in crate::engine) child: u32,
    pub(in crate::engine) run: EndedRun<D>,
    pub(in crate::engine) last: Option<(u32, u32)>,
    /// The error that was passed to the child.
    pub(in crate::engine) error: Option<Box<D>>,
    /// Number of values that the child replaced.
    pub(in crate::engine) replaced: usize,
}

/// An ended run of a state.
#[derive(Debug)]
pub(in crate::engine) struct EndedRun<D> {
    /// Number of its entry; 0 if the state was skipped.
    pub(in crate::engine) entry: u64,
    pub(in crate::engine) outcome: u32,
    pub(in crate::engine) kept: Kept<D>,
}

/// Data of an ended state.
#[derive(Debug)]
pub(in crate::engine) enum Kept<D> {
    /// The state was a script, or was skipped.
    Nothing,
    Inner(Box<EndedContainerData<D>>),
    /// The data was dropped.
    Lost,
}

/// The data of an ended container, at its end.
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

    /// Replaces the last child's run, which ended again, and adds the number of values that it replaced.
    pub(in crate::engine) fn renew(&mut self, run: EndedRun<D>, replaced: usize) {
        let Some(mut entry) = self.entries.pop_back() else { return };
        self.weight -= entry.run.weight();
        entry.run = run;
        entry.replaced += replaced;
        self.push(entry);
    }

    /// Takes the run of the last child; its entry remains.
    pub(in crate::engine) fn take_run(&mut self) -> Option<(u32, EndedRun<D>)> {
        let entry = self.entries.back_mut()?;
        self.weight -= entry.run.weight() - 1;
        Some((entry.child, entry.run.take()))
    }

    /// Removes the last entry and returns it with the values that its child replaced, the newest first.
    pub(in crate::engine) fn pop(&mut self) -> Option<(UndoEntry<D>, ReplacedValues<D>)> {
        let entry = self.entries.pop_back()?;
        self.weight -= entry.run.weight();
        let first = self.undo.len().saturating_sub(entry.replaced);
        let values = self.undo.drain(first..).rev().collect();
        Some((entry, values))
    }

    /// True if the counters match the contents.
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

    /// Drops the oldest entries until this many steps are removed, or the log is empty. Returns the number removed.
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
    /// The run of a skipped state.
    pub(in crate::engine) fn skipped(outcome: u32) -> Self {
        Self { entry: 0, outcome, kept: Kept::Nothing }
    }

    /// The run of a state that ended before the run was resumed.
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

    /// Moves the kept data out.
    fn take(&mut self) -> Self {
        let kept = std::mem::replace(&mut self.kept, Kept::Nothing);
        Self { entry: self.entry, outcome: self.outcome, kept }
    }
}

impl<D> Children<D> {
    /// The runs of ended children, without those in the undo log of a hierarchy.
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

    /// The number of steps kept in the children.
    fn weight(&self) -> usize {
        let logged = self.in_turn().map_or(0, |children| children.undo_log.weight);
        logged + self.runs().map(EndedRun::weight).sum::<usize>()
    }

    fn depth(&self) -> u32 {
        let logged = self.in_turn().map_or(0, |children| children.undo_log.depth);
        self.runs().map(EndedRun::depth).fold(logged, u32::max)
    }

    /// True if everything the children did is known; false for what they did before the run was restored.
    fn are_known(&self) -> bool {
        let is_undoable = self.side_by_side().is_none_or(|children| children.base.is_some());
        is_undoable && !self.runs().any(EndedRun::is_lost)
    }
}

impl<D> Frame<D> {
    /// Takes the data of a container that ends.
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
    /// The data that an ending state leaves behind; `None` if the run keeps no undo log.
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

    /// Logs the end of a hierarchy's child, which replaced all values from `first` on.
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

    /// Drops the oldest steps, those of the outermost states first.
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
