//! What states leave behind so that a run can be stepped back. Knows what is kept and how much of it; how it is used stands in
//! `backward.rs`.

use crate::Datum;
use crate::engine::state::frames::{Ended, Frame, Slot};
use crate::engine::state::step::Step;
use crate::program::Body;
use std::collections::VecDeque;
use std::sync::Arc;

/// Steps that are kept in a run, unless it is told otherwise: more than anybody goes back by hand, and few enough that the
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
    pub(in crate::engine) traces: VecDeque<UndoEntry<D>>,
    /// The values that children replaced, with their slots, for all traces one after the other.
    pub(in crate::engine) undo: VecDeque<(u32, Slot<D>)>,
    /// There was more, that is not known any more.
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
    pub(in crate::engine) past: EndedRun<D>,
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
    /// It is not known any more.
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
    pub(in crate::engine) trail: UndoLog<D>,
    /// Branches, or the root of a library.
    pub(in crate::engine) pasts: Vec<Option<EndedRun<D>>>,
    pub(in crate::engine) ended: Vec<Option<Ended<D>>>,
    pub(in crate::engine) order: Vec<u32>,
    pub(in crate::engine) base: Vec<Slot<D>>,
    depth: u32,
    weight: usize,
}

impl<D> Default for UndoLog<D> {
    fn default() -> Self {
        Self {
            traces: VecDeque::new(),
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
    /// Another frame begins.
    pub(in crate::engine) fn begin(&mut self) {
        (self.logs, self.undoing) = (false, false);
    }

    pub(in crate::engine) fn clear(&mut self) {
        if self.lost || !self.traces.is_empty() {
            self.give_up();
            self.lost = false;
        }
    }

    /// Forgets everything, but that there was something.
    pub(in crate::engine) fn give_up(&mut self) {
        self.traces.clear();
        self.undo.clear();
        (self.lost, self.weight, self.depth) = (true, 0, 0);
    }

    pub(in crate::engine) fn push(&mut self, trace: UndoEntry<D>) {
        self.weight += trace.past.weight();
        self.depth = self.depth.max(trace.past.depth());
        self.traces.push_back(trace);
    }

    /// The last child ended once more; it replaced so many values more.
    pub(in crate::engine) fn renew(&mut self, past: EndedRun<D>, replaced: usize) {
        let Some(mut trace) = self.traces.pop_back() else { return };
        self.weight -= trace.past.weight();
        trace.past = past;
        trace.replaced += replaced;
        self.push(trace);
    }

    /// Takes out what the last child left behind; its place stays.
    pub(in crate::engine) fn take_past(&mut self) -> Option<(u32, EndedRun<D>)> {
        let trace = self.traces.back_mut()?;
        self.weight -= trace.past.weight() - 1;
        Some((trace.child, trace.past.take()))
    }

    /// Takes away the last trace, with the values that its child replaced, the last one first.
    pub(in crate::engine) fn pop(&mut self) -> Option<(UndoEntry<D>, ReplacedValues<D>)> {
        let trace = self.traces.pop_back()?;
        self.weight -= trace.past.weight();
        let first = self.undo.len().saturating_sub(trace.replaced);
        let values = self.undo.drain(first..).rev().collect();
        Some((trace, values))
    }

    /// Whether what is counted is there.
    pub(in crate::engine) fn adds_up(&self) -> bool {
        let weight: usize = self.traces.iter().map(|trace| trace.past.weight()).sum();
        let replaced: usize = self.traces.iter().map(|trace| trace.replaced).sum();
        let inner = self.traces.iter().filter_map(|trace| match &trace.past.kept {
            Kept::Inner(inner) => Some(inner),
            Kept::Nothing | Kept::Lost => None,
        });
        let mut inner = inner.map(|inner| {
            let pasts = inner.pasts.iter().flatten().map(EndedRun::weight).sum::<usize>();
            inner.weight == inner.trail.weight + pasts
        });
        weight == self.weight && replaced <= self.undo.len() && inner.all(|inner| inner)
    }

    /// Gives up the oldest traces until this many steps are gone, or nothing is left.
    fn shorten(&mut self, steps: usize) -> usize {
        let before = self.weight;
        while before - self.weight < steps {
            let Some(trace) = self.traces.pop_front() else { break };
            self.weight -= trace.past.weight();
            self.undo.drain(..trace.replaced.min(self.undo.len()));
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

    /// Of a state that ended before the run was taken up.
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

impl<D> Frame<D> {
    /// Whether it is known what branches did, or the root of a library: not if the run was taken up meanwhile.
    fn knows_children(&self) -> bool {
        let is_lost = self.pasts.iter().flatten().any(EndedRun::is_lost);
        !is_lost && self.pasts.len() >= self.children.len()
    }

    /// Takes what is in the frame of a container that ends.
    fn take_inner(&mut self) -> EndedContainerData<D> {
        let pasts = std::mem::take(&mut self.pasts);
        let deepest = pasts.iter().flatten().map(EndedRun::depth).max().unwrap_or(0);
        let trail = std::mem::take(&mut self.trail);
        EndedContainerData {
            inputs: self.inputs.clone().unwrap_or_default(),
            slots: std::mem::take(&mut self.slots),
            last: self.last,
            last_error: self.last_error.take(),
            start_depth: self.start_depth,
            depth: 1 + deepest.max(trail.depth),
            weight: trail.weight + pasts.iter().flatten().map(EndedRun::weight).sum::<usize>(),
            trail,
            pasts,
            ended: std::mem::take(&mut self.ended),
            order: std::mem::take(&mut self.order),
            base: std::mem::take(&mut self.base),
        }
    }
}

impl<D: Datum> Step<'_, D> {
    pub(in crate::engine) fn keeps_trail(&self) -> bool {
        self.run.steps_max > 0
    }

    /// What a state that ends leaves behind; nothing, if the run is not to be stepped back.
    pub(in crate::engine) fn past(&mut self, slot: u32, outcome: u32) -> Option<EndedRun<D>> {
        if !self.keeps_trail() {
            return None;
        }
        let body = self.body(slot);
        let frame = self.run.frames.get_mut(slot);
        let entry = frame.undoes.map_or(frame.entry, |(entry, _)| entry);
        let kept = match body {
            Body::Script => Kept::Nothing,
            Body::Hierarchy(_) | Body::Concurrency(..) | Body::Library(_) => {
                let is_known = frame.knows_children();
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
    pub(in crate::engine) fn trace(
        &mut self,
        slot: u32,
        child: u32,
        past: EndedRun<D>,
        first: usize,
    ) {
        let frame = self.run.frames.get_mut(slot);
        let replaced = frame.trail.undo.len() - first;
        if std::mem::take(&mut frame.trail.undoing) {
            return frame.trail.renew(past, replaced);
        }
        let (last, error) = (frame.last, frame.gave.take().map(Box::new));
        frame.trail.push(UndoEntry { child, past, last, error, replaced });
        self.run.steps_kept += 1;
        if self.run.steps_kept > self.run.steps_max + SLACK {
            self.shorten_trails();
        }
    }

    /// Gives up the oldest steps, those of the outermost states first.
    fn shorten_trails(&mut self) {
        let active = self.active();
        let weights = active.iter().map(|&slot| {
            let frame = self.run.frames.get(slot);
            frame.trail.weight + frame.pasts.iter().flatten().map(EndedRun::weight).sum::<usize>()
        });
        let total = weights.sum::<usize>();
        let mut excess = total.saturating_sub(self.run.steps_max);
        self.run.steps_kept = total - excess;
        for slot in active {
            let frame = self.run.frames.get_mut(slot);
            excess = excess.saturating_sub(frame.trail.shorten(excess));
            for past in frame.pasts.iter_mut().flatten() {
                if excess > 0 {
                    excess = excess.saturating_sub(past.weight() - 1);
                    past.kept = Kept::Lost;
                }
            }
        }
    }
}
