//! One call of the engine: all effects of one input.

use crate::engine::Run;
use crate::engine::state::frames::Ended;
use crate::engine::state::phase::Phase;
use crate::program::{Body, Concurrency, Inside};
use crate::{Datum, Event, FrameId, Globals, Level, Note, Outbox, PathId, Program};

/// Queued work, last in first out. The depth of the machine becomes the length of this list, never the depth of the
/// call stack.
#[derive(Debug)]
pub(in crate::engine) enum Work<D> {
    /// Enter a child of a frame.
    Enter { parent: u32, child: u32 },
    /// Select the next step of a container.
    Advance(FrameId),
    /// Continue after the hold with this number.
    Pass(u64),
    /// Step one frame back.
    Back(Back),
    /// Leave a state with this end.
    Leave { slot: u32, ended: Box<Ended<D>> },
}

/// Read-only access to the program and the run.
#[derive(Debug)]
pub(in crate::engine) struct View<'s, 'r, D> {
    pub(in crate::engine) program: &'s Program<D>,
    pub(in crate::engine) run: &'r Run<D>,
}

impl<D> Clone for View<'_, '_, D> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<D> Copy for View<'_, '_, D> {}

/// Mutable access to the run during one call. Changes are reported in the outbox.
pub(in crate::engine) struct Step<'s, D> {
    pub(in crate::engine) program: &'s Program<D>,
    pub(in crate::engine) run: &'s mut Run<D>,
    pub(in crate::engine) globals: &'s dyn Globals<D>,
    pub(in crate::engine) out: &'s mut Outbox<D>,
}

impl<'s, D: Datum> Step<'s, D> {
    /// A read-only view of the run.
    pub(in crate::engine) fn view(&self) -> View<'s, '_, D> {
        View { program: self.program, run: self.run }
    }

    /// Works until the queue is empty.
    pub(in crate::engine) fn work(&mut self) {
        while self.work_once() {}
    }

    /// Does the next queued work; false if the queue is empty.
    pub(in crate::engine) fn work_once(&mut self) -> bool {
        let Some(work) = self.run.work.pop() else { return false };
        match work {
            Work::Enter { parent, child } => self.enter(parent, child),
            Work::Advance(frame) => self.advance(frame),
            Work::Pass(hold) => self.pass(hold),
            Work::Back(back) => self.go_back(back),
            Work::Leave { slot, ended } => self.leave(slot, *ended),
        }
        true
    }

    pub(in crate::engine) fn advance_later(&mut self, slot: u32) {
        self.run.work.push(Work::Advance(self.run.frames.id(slot)));
    }

    /// Selects the next step of a container. Does nothing while a child of it is active.
    fn advance(&mut self, frame: FrameId) {
        let Some(slot) = self.run.frames.find(frame) else { return };
        if self.view().is_held_anew(slot) {
            return;
        }
        match self.view().body(slot) {
            Body::Hierarchy(inside) => self.advance_hierarchy(slot, inside),
            Body::Concurrency(kind, inside) => self.advance_concurrency(slot, *kind, inside),
            Body::Script => self.advance_script(slot),
            Body::Library(content) => self.advance_library(slot, content),
        }
    }

    fn advance_concurrency(&mut self, slot: u32, kind: Concurrency, inside: &'s Inside<D>) {
        let Some(children) = self.run.frames.get(slot).children.side_by_side() else { return };
        let decides = kind.decider().is_some_and(|decider| children.active(decider).is_some());
        if children.open > 0 || decides {
            return;
        }
        match kind {
            Concurrency::Barrier(decider) => self.advance_barrier(slot, decider, inside),
            Concurrency::Preemptive => self.advance_preemptive(slot, inside),
        }
    }

    pub(in crate::engine) fn note(&mut self, path: PathId, level: Level, note: Note) {
        self.out.events.push(Event::Note { path, level, note: Box::new(note) });
    }
}

impl<'s, D: Datum> View<'s, '_, D> {
    pub(in crate::engine) fn body(&self, slot: u32) -> &'s Body<D> {
        &self.program.node(self.run.frames.get(slot).node).body
    }

    /// True if the frame already advanced in this call and is held again. That happens if it was asked to end twice in
    /// one call. A release removes the hold first.
    fn is_held_anew(&self, slot: u32) -> bool {
        let frame = self.run.frames.get(slot);
        let mut holds = self.run.control.holds.iter().map(|hold| hold.stop_point);
        matches!(frame.phase, Phase::Held | Phase::Checking)
            && holds.any(|stop_point| stop_point.parent == slot && !self.is_branch(stop_point))
    }
}

/// One frame's part in a step back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::engine) enum Back {
    /// Undo the last child of a hierarchy or library state, or leave the state if it has none.
    Last(FrameId),
    /// Enter these ended children of a concurrency state backwards.
    Branches(FrameId, Vec<u32>),
    /// Leave a state whose children are all at their start.
    Leave(FrameId),
}
