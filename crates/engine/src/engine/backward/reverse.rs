//! One step back: which frames can step back, and what a hierarchy does. Each branch steps back to its own start.
//! `reverse_enter.rs` and `reverse_leave.rs` enter and leave states backwards.

use crate::engine::Refusal;
use crate::engine::state::frames::{Children, ChildrenSideBySide, Frame, NONE};
use crate::engine::state::phase::Phase;
use crate::engine::state::step::{Back, Step, View, Work};
use crate::engine::state::undo_log::EndedRun;
use crate::program::{Body, Concurrency, Node};
use crate::{Datum, FrameId, PathId, When};
use rafcon_model::StatePath;
use std::sync::Arc;

/// Reason why a frame cannot step back. Of two reasons, the later variant takes precedence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Reason {
    AtStart,
    Lost,
}

impl<D: Datum> Step<'_, D> {
    /// Steps back everything that is held or waits, or one branch.
    pub(in crate::engine) fn back(&mut self, branch: Option<&StatePath>) -> Result<(), Refusal> {
        if !self.view().keeps_undo_log() {
            return Err(Refusal::NoHistory);
        }
        let place = self.view().branch_place(branch)?;
        let mut plan = Vec::new();
        let mut reason = None;
        for slot in self.view().active() {
            match self.view().can_go_back(slot, place) {
                Ok(back) => plan.extend(back),
                Err((because, path)) => reason = reason.max(Some((because, path))),
            }
        }
        if plan.is_empty() {
            return Err(self.view().cannot(reason, branch));
        }
        self.end_pause();
        self.run.control.run_to = None;
        self.run.work.extend(plan.into_iter().rev().map(Work::Back));
        Ok(())
    }

    /// Performs a planned step back, if the frame still exists.
    pub(in crate::engine) fn go_back(&mut self, back: Back) {
        let (Back::Last(id) | Back::Branches(id, _) | Back::Leave(id)) = back;
        let Some(slot) = self.run.frames.find(id) else { return };
        let branch = self.run.frames.get(slot).branch;
        self.run.branches.set(branch, true);
        match back {
            Back::Last(_) => self.undo_last(slot),
            Back::Branches(_, children) => self.branches_back(slot, &children),
            Back::Leave(_) => self.leave_back(slot),
        }
    }

    /// Undoes the last child of a hierarchy or library state.
    fn undo_last(&mut self, slot: u32) {
        let branch = self.run.frames.get(slot).branch;
        self.run.control.take_in(slot);
        let outputs = self.view().outputs_anew(slot);
        let frame = self.run.frames.get_mut(slot);
        frame.stand_ready();
        let run = match &mut frame.children {
            Children::Library(root) => {
                root.end = None;
                frame.outputs = Some(outputs);
                root.run.take().map(|run| (0, run))
            }
            Children::Hierarchy(children) => {
                children.undo_log.undoing = true;
                children.undo_log.take_run()
            }
            Children::None | Children::Concurrency(_) => None,
        };
        match run {
            Some((child, run)) if run.entry > 0 => self.enter_back(slot, child, run, branch),
            Some(_) | None => self.child_undone(slot),
        }
    }
}

impl<D: Datum> View<'_, '_, D> {
    fn cannot(&self, reason: Option<(Reason, PathId)>, branch: Option<&StatePath>) -> Refusal {
        let path = |path| self.run.places.text(path, self.program);
        match reason {
            Some((Reason::Lost, at)) => Refusal::TooFarBack { path: path(at) },
            Some((Reason::AtStart, at)) => Refusal::AtStart { path: path(at) },
            None => Refusal::NothingHeld { branch: branch.cloned() },
        }
    }

    /// The step back of a frame, if it has one.
    fn can_go_back(
        &self,
        slot: u32,
        within: Option<PathId>,
    ) -> Result<Option<Back>, (Reason, PathId)> {
        let frame = self.run.frames.get(slot);
        let here = within.is_none_or(|top| self.run.is_below(frame.path, top));
        let is_between_children = matches!(frame.phase, Phase::Held | Phase::Waiting(_));
        let id = self.run.frames.id(slot);
        if frame.preempted {
            return Ok(None);
        }
        match self.body(slot) {
            Body::Concurrency(kind, _) => self.branches_go_back(slot, *kind, within),
            Body::Hierarchy(_) if here && is_between_children => {
                let lost = frame.children.in_turn().and_then(|children| {
                    let last = children.undo_log.entries.back();
                    let last = last.map(|entry| entry.run.is_lost());
                    last.or(children.undo_log.lost.then_some(true))
                });
                let back = self.last_goes_back(slot, lost)?;
                Ok(Some(back(id)))
            }
            Body::Library(_) if here && is_between_children => {
                let Children::Library(root) = &frame.children else { return Ok(None) };
                let lost = root.run.as_ref().map(EndedRun::is_lost);
                let back = self.last_goes_back(slot, lost.or(root.end.as_ref().map(|_| true)))?;
                Ok(Some(back(id)))
            }
            Body::Script | Body::Hierarchy(_) | Body::Library(_) => Ok(None),
        }
    }

    /// The step back of a frame, given whether the data of its last child is `lost`. `None`: the frame has no last
    /// child and is left.
    fn last_goes_back(
        &self,
        slot: u32,
        lost: Option<bool>,
    ) -> Result<fn(FrameId) -> Back, (Reason, PathId)> {
        let path = self.run.frames.get(slot).path;
        match lost {
            Some(false) => Ok(Back::Last),
            Some(true) => Err((Reason::Lost, path)),
            None if self.is_outermost(slot) => Err((Reason::AtStart, path)),
            None => Ok(Back::Leave),
        }
    }

    fn branches_go_back(
        &self,
        slot: u32,
        kind: Concurrency,
        within: Option<PathId>,
    ) -> Result<Option<Back>, (Reason, PathId)> {
        let frame = self.run.frames.get(slot);
        let Some(branches) = frame.children.side_by_side() else { return Ok(None) };
        let decides = kind.decider().is_some_and(|decider| branches.active(decider).is_some());
        let is_decided = branches.open > 0 && branches.winner.is_some();
        if decides || is_decided {
            return Ok(None);
        }
        if branches.are_at_start() {
            return self.start_goes_back(slot, within);
        }
        let ended = branches.ends().map(|(child, _)| child);
        let ended = ended.filter(|&child| Some(child) != kind.decider());
        let here = |&child: &u32| within.is_none_or(|top| self.is_child_within(slot, child, top));
        let children = ended.filter(here).collect::<Vec<_>>();
        let is_known = |child: &u32| {
            let child = branches.all.get(*child as usize);
            child.and_then(|child| child.run.as_ref()).is_some_and(|run| !run.is_lost())
        };
        if !children.iter().all(is_known) {
            return Err((Reason::Lost, frame.path));
        }
        if children.is_empty() {
            let at_start = within.filter(|&top| self.begins_held(slot, top));
            return at_start.map_or(Ok(None), |top| Err((Reason::AtStart, top)));
        }
        Ok(Some(Back::Branches(self.run.frames.id(slot), children)))
    }

    /// Leaves a concurrency state whose children are all at their start.
    fn start_goes_back(
        &self,
        slot: u32,
        within: Option<PathId>,
    ) -> Result<Option<Back>, (Reason, PathId)> {
        let mut holds = self.run.control.holds.iter().filter(|hold| hold.stop_point.parent == slot);
        let checks = holds.any(|hold| hold.check().is_some());
        if checks || !within.is_none_or(|top| self.is_around(slot, top)) {
            return Ok(None);
        }
        if self.is_outermost(slot) {
            return Err((Reason::AtStart, self.run.frames.get(slot).path));
        }
        Ok(Some(Back::Leave(self.run.frames.id(slot))))
    }

    /// True if the child at this place is held before it begins.
    fn begins_held(&self, slot: u32, top: PathId) -> bool {
        let holds = self.run.control.holds.iter().filter(|hold| hold.by().is_some());
        let mut stop_points =
            holds.map(|hold| hold.stop_point).filter(|stop_point| stop_point.parent == slot);
        stop_points.any(|stop_point| {
            stop_point.when == When::Before && self.is_child_within(slot, stop_point.child, top)
        })
    }

    /// True if the branch named by `top` begins in this frame, or contains it.
    fn is_around(&self, slot: u32, top: PathId) -> bool {
        let path = self.run.frames.get(slot).path;
        self.run.places.parent(top) == Some(path) || self.run.is_below(path, top)
    }

    fn is_child_within(&self, slot: u32, child: u32, top: PathId) -> bool {
        let path = self.run.frames.get(slot).path;
        let child = self.run.places.child(path, child as usize, self.program);
        child.is_some_and(|child| self.run.is_below(child, top))
    }

    /// True if no child of a concurrency state is active or has ended.
    pub(in crate::engine) fn all_at_start(&self, slot: u32) -> bool {
        let branches = self.run.frames.get(slot).children.side_by_side();
        branches.is_some_and(ChildrenSideBySide::are_at_start)
    }

    /// True for the root of the machine, and for the root of a library state that is outermost.
    pub(in crate::engine) fn is_outermost(&self, slot: u32) -> bool {
        let parent = self.run.frames.get(slot).parent;
        let in_library = || matches!(self.body(parent), Body::Library(_));
        parent == NONE || in_library() && self.is_outermost(parent)
    }

    /// The defaults of a state's outputs, as at its entry.
    pub(in crate::engine) fn outputs_anew(&self, slot: u32) -> Arc<[D]> {
        let frame = self.run.frames.get(slot);
        self.output_defaults(frame.parent, self.program.node(frame.node))
    }

    /// Output defaults of a state in this frame. The root of a library uses those of its library state.
    pub(in crate::engine) fn output_defaults(&self, parent: u32, node: &Node<D>) -> Arc<[D]> {
        if parent != NONE
            && let Body::Library(content) = self.body(parent)
        {
            return self.root_outputs(parent, content, node);
        }
        Arc::clone(&node.outputs)
    }
}

impl<D> Frame<D> {
    /// Clears the marks of a hold.
    pub(in crate::engine) fn stand_ready(&mut self) {
        self.phase = Phase::Child;
        self.marker = None;
        self.pass = None;
        self.after = false;
    }
}

impl<D: Datum> crate::engine::Engine<D> {
    /// Limits the steps that can be undone to `steps_max`; 0 keeps none. Call it before the run starts.
    #[must_use]
    pub fn with_undo_log(mut self, steps_max: usize) -> Self {
        self.run.steps_max = steps_max;
        self
    }

    /// Disables the undo log, so that no step back is possible.
    #[must_use]
    pub fn without_undo_log(self) -> Self {
        self.with_undo_log(0)
    }
}
