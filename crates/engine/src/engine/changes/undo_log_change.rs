//! Moves the undo log to a changed machine. Steps across removed states, or across states whose data has another
//! layout, are dropped, and so are all older steps.

use crate::engine::changes::migrate::{Source, sources};
use crate::engine::state::frames::Children;
use crate::engine::state::step::Step;
use crate::engine::state::undo_log::{Kept, UndoEntry, UndoLog};
use crate::program::{Body, Inside, Node};
use crate::{Datum, NodeId, Program};
use std::collections::BTreeMap;
use std::collections::VecDeque;

/// The old and the new program, and the state whose undo log is moved, in both.
struct ProgramPair<'p, D> {
    before: &'p Program<D>,
    after: &'p Program<D>,
    was: &'p Node<D>,
    is: &'p Node<D>,
}

impl<D: Datum> Step<'_, D> {
    /// Moves what the children of a frame left behind. The frame already refers to the new program.
    pub(in crate::engine) fn migrate_undo_log(
        &mut self,
        slot: u32,
        before: &Program<D>,
        was: &Node<D>,
    ) {
        let frame = self.run.frames.get_mut(slot);
        let is = self.program.node(frame.node);
        let both = ProgramPair { before, after: self.program, was, is };
        match (&mut frame.children, &was.body, &is.body) {
            (Children::Hierarchy(children), Body::Hierarchy(old), Body::Hierarchy(new)) => {
                let log = std::mem::take(&mut children.undo_log);
                children.undo_log = both.carried(log, old, new);
            }
            (
                Children::Concurrency(children),
                Body::Concurrency(_, old),
                Body::Concurrency(_, new),
            ) => {
                let same = sources(before, was, old) == sources(self.program, is, new);
                for (index, child) in (0..).zip(&mut children.all) {
                    if let Some(run) = child.run.as_mut().filter(|_| !same || !both.stays(index)) {
                        run.kept = Kept::Lost;
                    }
                }
                children.base = children.base.take().filter(|_| same);
            }
            (Children::Library(root), ..) => {
                if let Some(run) = root.run.as_mut().filter(|_| !both.stays(0)) {
                    run.kept = Kept::Lost;
                }
            }
            _ => {}
        }
    }
}

impl<D: Datum> ProgramPair<'_, D> {
    /// The newest entries, up to the first one that no longer exists in the new program.
    fn carried(&self, mut trail: UndoLog<D>, old: &Inside<D>, new: &Inside<D>) -> UndoLog<D> {
        let slots = self.slots(old, new);
        let mut carried = UndoLog::default();
        (carried.logs, carried.lost) = (trail.logs, trail.lost);
        let mut entries = VecDeque::new();
        while let Some((entry, values)) = trail.pop() {
            let Some(mut entry) = self.carried_entry(entry) else {
                carried.lost = true;
                break;
            };
            let values = values.into_iter().filter_map(|(target, value)| {
                Some((slots.get(target as usize).copied().flatten()?, value))
            });
            let before = carried.undo.len();
            values.for_each(|value| carried.undo.push_front(value));
            entry.replaced = carried.undo.len() - before;
            entries.push_front(entry);
        }
        carried.undoing = trail.undoing && !entries.is_empty();
        for entry in entries {
            carried.push(entry);
        }
        carried
    }

    /// Maps each old slot to the new slot with an equal source.
    fn slots(&self, old: &Inside<D>, new: &Inside<D>) -> Vec<Option<u32>> {
        let now: BTreeMap<Source, u32> =
            sources(self.after, self.is, new).into_iter().zip(0..).collect();
        let before = sources(self.before, self.was, old).into_iter();
        before.map(|source| now.get(&source).copied()).collect()
    }

    fn carried_entry(&self, entry: UndoEntry<D>) -> Option<UndoEntry<D>> {
        let (child, outcome) = self.end(entry.child, entry.run.outcome)?;
        let last = match entry.last {
            Some((child, outcome)) => Some(self.end(child, outcome)?),
            None => None,
        };
        let mut run = entry.run;
        run.outcome = outcome;
        let is_script = self.is.child(child as usize).map(|is| self.after.node(is).is_script());
        let can = match run.kept {
            Kept::Inner(_) => self.stays(entry.child),
            Kept::Nothing => run.entry == 0 || is_script == Some(true),
            Kept::Lost => false,
        };
        if !can {
            run.kept = Kept::Lost;
        }
        Some(UndoEntry { child, run, last, ..entry })
    }

    /// The new index of a child and of its outcome.
    fn end(&self, child: u32, outcome: u32) -> Option<(u32, u32)> {
        let was = self.before.node(self.was.child(child as usize)?);
        let (index, is) = self.after.child_of(self.is, was.id())?;
        let outcome = self.after.node(is).outcome_index(was.outcome_id(outcome).0)?;
        Some((index, outcome))
    }

    /// True if a child and everything in it have an unchanged data layout.
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
