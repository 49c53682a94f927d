//! What is left of the way back when the machine changes: steps across what is gone, or holds its data in another way, are
//! given up, and all before them.

use crate::engine::changes::migrate::{Source, sources};
use crate::engine::state::step::Step;
use crate::engine::state::undo_log::{Kept, UndoEntry, UndoLog};
use crate::program::{Body, Inside, Node};
use crate::{Datum, NodeId, Program};
use std::collections::BTreeMap;
use std::collections::VecDeque;

/// Two programs, and the state whose trail is carried over: before and after.
struct ProgramPair<'p, D> {
    before: &'p Program<D>,
    after: &'p Program<D>,
    was: &'p Node<D>,
    is: &'p Node<D>,
}

impl<D: Datum> Step<'_, D> {
    /// Carries over what children of a frame left behind. The frame stands for the new program already.
    pub(in crate::engine) fn migrate_trail(
        &mut self,
        slot: u32,
        before: &Program<D>,
        was: &Node<D>,
    ) {
        let frame = self.run.frames.get_mut(slot);
        let is = self.program.node(frame.node);
        let both = ProgramPair { before, after: self.program, was, is };
        match (&was.body, &is.body) {
            (Body::Hierarchy(old), Body::Hierarchy(new)) => {
                let trail = std::mem::take(&mut frame.trail);
                frame.trail = both.carried(trail, old, new);
            }
            (Body::Concurrency(_, old), Body::Concurrency(_, new)) => {
                let same = sources(before, was, old) == sources(self.program, is, new);
                for (child, past) in (0..).zip(&mut frame.pasts) {
                    if let Some(past) = past.as_mut().filter(|_| !same || !both.stays(child)) {
                        past.kept = Kept::Lost;
                    }
                }
                if !same {
                    frame.base.clear();
                }
            }
            (Body::Library(_), Body::Library(_)) => {
                for past in frame.pasts.iter_mut().flatten().filter(|_| !both.stays(0)) {
                    past.kept = Kept::Lost;
                }
            }
            _ => {}
        }
    }
}

impl<D: Datum> ProgramPair<'_, D> {
    /// The newest traces as far as everything in them is still there.
    fn carried(&self, mut trail: UndoLog<D>, old: &Inside<D>, new: &Inside<D>) -> UndoLog<D> {
        let slots = self.slots(old, new);
        let mut carried = UndoLog::default();
        (carried.logs, carried.lost) = (trail.logs, trail.lost);
        let mut traces = VecDeque::new();
        while let Some((trace, values)) = trail.pop() {
            let Some(mut trace) = self.trace(trace) else {
                carried.lost = true;
                break;
            };
            let values = values.into_iter().filter_map(|(target, value)| {
                Some((slots.get(target as usize).copied().flatten()?, value))
            });
            let before = carried.undo.len();
            values.for_each(|value| carried.undo.push_front(value));
            trace.replaced = carried.undo.len() - before;
            traces.push_front(trace);
        }
        carried.undoing = trail.undoing && !traces.is_empty();
        for trace in traces {
            carried.push(trace);
        }
        carried
    }

    /// For each slot the one that is for the same.
    fn slots(&self, old: &Inside<D>, new: &Inside<D>) -> Vec<Option<u32>> {
        let now: BTreeMap<Source, u32> =
            sources(self.after, self.is, new).into_iter().zip(0..).collect();
        let before = sources(self.before, self.was, old).into_iter();
        before.map(|source| now.get(&source).copied()).collect()
    }

    fn trace(&self, trace: UndoEntry<D>) -> Option<UndoEntry<D>> {
        let (child, outcome) = self.end(trace.child, trace.past.outcome)?;
        let last = match trace.last {
            Some((child, outcome)) => Some(self.end(child, outcome)?),
            None => None,
        };
        let mut past = trace.past;
        past.outcome = outcome;
        let is_script = self.is.child(child as usize).map(|is| self.after.node(is).is_script());
        let can = match past.kept {
            Kept::Inner(_) => self.stays(trace.child),
            Kept::Nothing => past.entry == 0 || is_script == Some(true),
            Kept::Lost => false,
        };
        if !can {
            past.kept = Kept::Lost;
        }
        Some(UndoEntry { child, past, last, ..trace })
    }

    /// A child and the index of its outcome, as they are now.
    fn end(&self, child: u32, outcome: u32) -> Option<(u32, u32)> {
        let was = self.before.node(self.was.child(child as usize)?);
        let (index, is) = self.after.child_of(self.is, was.id())?;
        let outcome = self.after.node(is).outcome_index(was.outcome_id(outcome).0)?;
        Some((index, outcome))
    }

    /// Whether a child holds its data in the same way as before, and so does all that is in it.
    fn stays(&self, child: u32) -> bool {
        let was = self.was.child(child as usize);
        let is = was.and_then(|was| {
            self.after.child_of(self.is, self.before.node(was).id()).map(|(_, is)| is)
        });
        was.zip(is).is_some_and(|pair| self.same(pair))
    }

    fn same(&self, top: (NodeId, NodeId)) -> bool {
        let mut stack = vec![top];
        while let Some((was, is)) = stack.pop() {
            let (was, is) = (self.before.node(was), self.after.node(is));
            if !self.same_alone(was, is) {
                return false;
            }
            let children = 0..was.children();
            stack.extend(children.filter_map(|child| was.child(child).zip(is.child(child))));
        }
        true
    }

    fn same_alone(&self, was: &Node<D>, is: &Node<D>) -> bool {
        let outcomes = |node: &Node<D>| node.outcomes().iter().map(|o| o.id).collect::<Vec<_>>();
        let layout = |program: &Program<D>, node: &Node<D>| match &node.body {
            Body::Hierarchy(inside) | Body::Concurrency(_, inside) => {
                Some(sources(program, node, inside))
            }
            Body::Script | Body::Library(_) => None,
        };
        was.id() == is.id()
            && was.state().kind.name() == is.state().kind.name()
            && was.children() == is.children()
            && outcomes(was) == outcomes(is)
            && was.inputs().iter().map(|p| p.id).eq(is.inputs().iter().map(|p| p.id))
            && was.outputs().iter().map(|p| p.id).eq(is.outputs().iter().map(|p| p.id))
            && layout(self.before, was) == layout(self.after, is)
    }
}
