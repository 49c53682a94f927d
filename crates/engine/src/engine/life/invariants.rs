//! Invariants between two inputs: frames, holds, branches and undo logs agree with each other. Tests and the simulation
//! check them after every input.

use crate::engine::state::frames::{Children, ChildrenSideBySide, ConcurrentChild, Frame, NONE};
use crate::engine::state::phase::Phase;
use crate::engine::state::suspended::SuspendedBranch;
use crate::engine::state::undo_log::UndoLog;
use crate::engine::{Engine, Status};
use crate::program::{Body, Concurrency, Inside};
use crate::{Datum, When};
use std::collections::BTreeSet;

/// Result of a check; the error describes the broken invariant.
type Checked = Result<(), String>;

fn holds(kept: bool, slot: u32, what: &str) -> Checked {
    if kept { Ok(()) } else { Err(format!("frame {slot}: {what}")) }
}

impl<D: Datum> Engine<D> {
    /// Checks that the engine's tables agree with each other, as they must between two inputs. An error describes a bug
    /// of the engine.
    pub fn check(&self) -> Result<(), String> {
        let run = &self.run;
        let none = |kept: bool, what: &str| holds(kept, NONE, what);
        none(run.work.is_empty(), "work is left")?;
        let reached = run.root.map(|root| run.frames.below(root)).unwrap_or_default();
        let known: BTreeSet<_> = reached.iter().copied().collect();
        none(known.len() == reached.len(), "a frame is reached twice")?;
        none(run.frames.live().eq(known.iter().copied()), "a live frame is not reached")?;
        none(run.frames.are_accounted_for(), "a frame is neither live nor free, or both")?;
        let over = matches!(run.status, Status::Idle | Status::Finished);
        none(!over || run.root.is_none() && run.control.holds.is_empty(), "it is over, and not")?;
        none(run.finish.is_none() || run.root.is_none(), "it ended, and its root is active")?;
        for hold in &run.control.holds {
            let parent = hold.stop_point.parent;
            holds(parent == NONE || known.contains(&parent), parent, "a hold in no frame")?;
            holds(run.branches.has(hold.branch), parent, "a hold on a removed branch")?;
        }
        reached.iter().try_for_each(|&slot| self.check_frame(slot))?;
        let forked = reached.iter().filter(|&&slot| self.begins_branch(slot)).count();
        let waits = run.control.holds.iter().filter(|hold| self.is_branch_hold(hold)).count();
        none(run.branches.live() == 1 + forked + waits, "a branch is lost")?;
        none(run.branches.counts(), "branches that go step by step are counted wrongly")
    }

    fn check_frame(&self, slot: u32) -> Checked {
        let frame = self.run.frames.get(slot);
        let node = self.program.node(frame.node);
        holds(self.run.branches.has(frame.branch), slot, "its branch does not exist")?;
        holds(frame.phase != Phase::Begun, slot, "it has begun and does nothing")?;
        let place = self.run.places.node(frame.path);
        holds(place == Some(frame.node), slot, "another state is_suspended at its place")?;
        for child in frame.children.active() {
            let inner = self.run.frames.get(child);
            holds(inner.parent == slot, child, "another frame is around it")?;
            let index = self.program.node(inner.node).child_index;
            let there = node.child(index as usize) == Some(inner.node);
            holds(there, child, "its state is not in the state around it")?;
            let same = self.run.places.parent(inner.path) == Some(frame.path);
            holds(same, child, "its place is not in the place around it")?;
            let forks = self.begins_branch(child);
            holds(forks == (inner.branch != frame.branch), child, "it is on a wrong branch")?;
        }
        match (&node.body, &frame.children) {
            (Body::Script, Children::None) => self.check_script(slot, frame),
            (Body::Library(_), Children::Library(root)) => {
                let waits = root.end.is_none() || root.active.is_none();
                holds(waits, slot, "its root runs, and it is about to end")?;
                self.check_single(slot, frame)
            }
            (Body::Hierarchy(inside), Children::Hierarchy(children)) => {
                Self::check_undo_log(slot, frame, &children.undo_log)?;
                self.check_single(slot, frame)?;
                self.check_data(slot, frame, inside)
            }
            (Body::Concurrency(kind, inside), Children::Concurrency(children)) => {
                self.check_branches(slot, children, *kind, inside)?;
                self.check_data(slot, frame, inside)
            }
            _ => holds(false, slot, "its children are those of another kind of state"),
        }
    }

    fn check_script(&self, slot: u32, frame: &Frame<D>) -> Checked {
        let held = self.held_itself(slot) == usize::from(frame.phase == Phase::Held);
        let does = matches!(frame.phase, Phase::Script | Phase::Held | Phase::Waiting(_));
        holds(does && held, slot, "a script does what it cannot")
    }

    /// A hierarchy or library state has one active child, or is held or waits for one reason.
    fn check_single(&self, slot: u32, frame: &Frame<D>) -> Checked {
        let is_suspended = matches!(frame.phase, Phase::Held | Phase::Checking);
        let held = self.held_itself(slot) == usize::from(is_suspended);
        holds(held, slot, "it is held without a hold, or has one and is not")?;
        let runs = frame.children.any_active() == (frame.phase == Phase::Child);
        holds(runs, slot, "it runs a child that is not there, or does not run one that is")
    }

    fn check_branches(
        &self,
        slot: u32,
        children: &ChildrenSideBySide<D>,
        kind: Concurrency,
        inside: &Inside<D>,
    ) -> Checked {
        let frame = self.run.frames.get(slot);
        let count = inside.children.len();
        holds(children.all.len() == count, slot, "it has no place for each child")?;
        let is_branch = |child: &u32| Some(*child) != kind.decider();
        let active = |child: &u32| children.active(*child).is_some();
        let branches = (0..inside.count()).filter(is_branch);
        let waits = self.run.control.holds.iter().filter(|hold| hold.stop_point.parent == slot);
        let waits = waits.filter(|hold| self.is_branch_hold(hold)).count();
        let open = branches.clone().filter(active).count() + waits;
        holds(children.open as usize == open, slot, "open branches are counted wrongly")?;
        let both = |child: u32| active(&child) && children.ended(child).is_some();
        holds(!branches.clone().any(both), slot, "a branch is active and has ended")?;
        let ran = |child: &ConcurrentChild<D>| child.run.is_none() || child.ended.is_some();
        holds(children.all.iter().all(ran), slot, "a branch left something and has not ended")?;
        let base = children.base.as_ref().is_none_or(|base| base.len() == frame.slots.len());
        holds(base, slot, "it began with too few or many values")?;
        let races = kind == Concurrency::Preemptive;
        holds(children.winner.is_none() || races, slot, "a barrier has a winner")?;
        let decides = kind.decider().is_some_and(|decider| active(&decider));
        holds(!decides || children.open == 0, slot, "it decides while branches are open")?;
        let is_suspended = matches!(frame.phase, Phase::Held | Phase::Checking);
        holds(self.held_itself(slot) == usize::from(is_suspended), slot, "it is held wrongly")
    }

    fn check_data(&self, slot: u32, frame: &Frame<D>, inside: &Inside<D>) -> Checked {
        holds(frame.slots.len() == inside.slots as usize, slot, "it has too few or many values")?;
        let rising = frame.slots.iter().all(|value| value.sequence <= self.run.sequence);
        holds(rising, slot, "it has a value from the future")?;
        let ends = |(child, outcome): (u32, u32)| {
            let node = inside.children.get(child as usize).map(|&child| self.program.node(child));
            node.is_some_and(|node| (outcome as usize) < node.outcomes().len())
        };
        holds(frame.last.is_none_or(ends), slot, "its last child cannot have ended so")
    }

    fn check_undo_log(slot: u32, frame: &Frame<D>, log: &UndoLog<D>) -> Checked {
        holds(log.adds_up(), slot, "its undo log does not add up")?;
        let known = log.undo.iter().all(|(target, _)| (*target as usize) < frame.slots.len());
        holds(known, slot, "its undo log names a value that it does not have")
    }

    /// The number of holds of the frame itself, without those of its branches.
    fn held_itself(&self, slot: u32) -> usize {
        let inside = self.run.control.holds.iter().filter(|hold| hold.stop_point.parent == slot);
        inside.filter(|hold| !self.is_branch_hold(hold)).count()
    }

    fn is_branch_hold(&self, hold: &SuspendedBranch<D>) -> bool {
        let parent = hold.stop_point.parent;
        parent != NONE
            && match &self.program.node(self.run.frames.get(parent).node).body {
                Body::Concurrency(kind, _) => {
                    // No child is next before the end of a barrier without a decider.
                    kind.decider() != Some(hold.stop_point.child)
                        && (hold.stop_point.child != NONE || hold.stop_point.when == When::After)
                }
                Body::Script | Body::Hierarchy(_) | Body::Library(_) => false,
            }
    }

    /// True if a frame is the child of a concurrency state, on a branch of its own.
    fn begins_branch(&self, slot: u32) -> bool {
        let frame = self.run.frames.get(slot);
        frame.parent != NONE
            && match &self.program.node(self.run.frames.get(frame.parent).node).body {
                Body::Concurrency(kind, _) => {
                    kind.decider() != Some(self.program.node(frame.node).child_index)
                }
                Body::Script | Body::Hierarchy(_) | Body::Library(_) => false,
            }
    }
}
