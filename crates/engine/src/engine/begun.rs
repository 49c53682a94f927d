//! The state that a run was begun at, told and taken up again: a run that is lost before it came there still comes there,
//! and what is to happen behind that state still happens.

use super::Engine;
use super::frames::NONE;
use super::step::Step;
use crate::program::Body;
use crate::{BegunAt, Datum, Program, Then};
use rafcon_model::{StateId, StatePath};

impl<D: Datum> Engine<D> {
    /// The state that the run was begun at; `None` if it was begun nowhere else, or that matters no more.
    pub fn begun_at(&self) -> Option<BegunAt> {
        let then = self.run.control.then.map_or(Then::GoOn, |(_, then)| then);
        let is_reached = !self.leads_on();
        if is_reached && then == Then::GoOn {
            return None;
        }
        Some(BegunAt { path: self.start_path()?, is_reached, then })
    }

    /// Whether something active leads to the state that the run was begun at, and has not come there.
    fn leads_on(&self) -> bool {
        let active = self.run.root.map(|root| self.run.frames.below(root)).unwrap_or_default();
        active.into_iter().any(|slot| {
            let frame = self.run.frames.get(slot);
            let depth = frame.start_depth.filter(|_| frame.last.is_none());
            let Some(&child) = depth.and_then(|depth| self.run.start_from.get(depth as usize))
            else {
                return false;
            };
            match &self.program.node(frame.node).body {
                Body::Concurrency(..) => {
                    let has_ended = frame.ended.get(child as usize).is_some_and(Option::is_some);
                    frame.active_child(child) == NONE && !has_ended
                }
                Body::Script | Body::Hierarchy(_) | Body::Library(_) => frame.children.is_empty(),
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
    /// Lets what is active lead to the state that the run was begun at, as it did before the run was lost.
    pub(super) fn lead_on(&mut self, begun: &BegunAt, way: Vec<u32>) {
        self.run.control.then = self.target(&way).map(|place| (place, begun.then));
        let mut slot = self.run.root.filter(|_| !begun.is_reached);
        for (depth, &step) in (0..).zip(&way) {
            let Some(on_the_way) = slot else { break };
            let frame = self.run.frames.get_mut(on_the_way);
            frame.start_depth = Some(depth);
            let is_concurrency = matches!(self.body(on_the_way), Body::Concurrency(..));
            let frame = self.run.frames.get(on_the_way);
            let child = if is_concurrency {
                frame.active_child(step)
            } else {
                frame.children.first().copied().unwrap_or(NONE)
            };
            slot = Some(child).filter(|&child| child != NONE);
        }
        self.run.start_from = way;
    }
}
