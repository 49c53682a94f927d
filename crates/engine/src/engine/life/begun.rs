//! The state that a run was started at, exported and restored. A run that is lost before it reached that state still
//! reaches it, and the action planned after that state still happens.

use crate::engine::Engine;
use crate::engine::state::step::{Step, View};
use crate::{BegunAt, Datum, PathId, Program, Then};
use rafcon_model::{StateId, StatePath};

impl<D: Datum> Engine<D> {
    /// The state that the run was started at. `None` if it started at its root, or if the start no longer matters.
    pub fn begun_at(&self) -> Option<BegunAt> {
        let then = self.run.control.then.map_or(Then::GoOn, |(_, then)| then);
        let is_reached = !self.leads_on();
        if is_reached && then == Then::GoOn {
            return None;
        }
        Some(BegunAt { path: self.start_path()?, is_reached, then })
    }

    /// True if an active state still leads to the start state, which was not reached.
    fn leads_on(&self) -> bool {
        let active = self.run.root.map(|root| self.run.frames.below(root)).unwrap_or_default();
        active.into_iter().any(|slot| {
            let frame = self.run.frames.get(slot);
            let depth = frame.start_depth.filter(|_| frame.last.is_none());
            let Some(&child) = depth.and_then(|depth| self.run.start_from.get(depth as usize))
            else {
                return false;
            };
            match frame.children.side_by_side() {
                Some(children) => {
                    children.active(child).is_none() && children.ended(child).is_none()
                }
                None => !frame.children.any_active(),
            }
        })
    }

    fn start_path(&self) -> Option<StatePath> {
        let mut node = self.program.node(Program::<D>::ROOT);
        let mut path: Vec<StateId> = vec![node.id().clone()];
        for &step in &self.run.start_from {
            node = self.program.node(node.child(step as usize)?);
            path.push(node.id().clone());
        }
        (path.len() > 1).then_some(StatePath(path))
    }
}

impl<D: Datum> Step<'_, D> {
    /// Makes the active states lead to the start state again, as before the run was lost, as far as that state still
    /// exists.
    pub(in crate::engine) fn lead_on(&mut self, begun: &BegunAt) {
        let (way, is_whole) = self.view().way_to(&begun.path);
        let target = self.target(&way).filter(|_| is_whole);
        let is_ahead = |&place: &PathId| !begun.is_reached || self.view().is_active(place);
        self.run.control.then = target.filter(is_ahead).map(|place| (place, begun.then));
        let mut slot = self.run.root.filter(|_| !begun.is_reached);
        for (depth, &step) in (0..).zip(&way) {
            let Some(around) = slot.filter(|&slot| self.run.frames.get(slot).last.is_none()) else {
                break;
            };
            self.run.frames.get_mut(around).start_depth = Some(depth);
            slot = self.view().child_within(around, step);
        }
        self.run.start_from = way;
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// The steps to a state, or to the last existing state above it; true if they reach the state itself.
    fn way_to(&self, path: &StatePath) -> (Vec<u32>, bool) {
        let mut ids = path.0.clone();
        while ids.len() > 1 {
            if let Ok((_, steps)) = self.program.descend(&StatePath(ids.clone())) {
                return (steps, ids.len() == path.0.len());
            }
            ids.pop();
        }
        (Vec::new(), false)
    }

    fn is_active(&self, place: PathId) -> bool {
        self.active().into_iter().any(|slot| self.run.frames.get(slot).path == place)
    }

    /// The frame of the child at this position, or of the only active child.
    fn child_within(&self, slot: u32, child: u32) -> Option<u32> {
        let children = &self.run.frames.get(slot).children;
        match children.side_by_side() {
            Some(children) => children.active(child),
            None => children.active().next(),
        }
    }
}
