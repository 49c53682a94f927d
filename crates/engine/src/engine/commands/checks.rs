//! The data for the condition of a breakpoint: that of a state about to be entered, or just left.

use crate::engine::state::step::{Step, View};
use crate::engine::state::suspended::{BreakpointScan, StopPoint};
use crate::program::Body;
use crate::{Check, Datum, Effect, NodeId, PathId, Program};
use smol_str::SmolStr;
use std::sync::Arc;

impl<D: Datum> Step<'_, D> {
    pub(in crate::engine) fn out_check(
        &mut self,
        inquiry: &BreakpointScan<D>,
        check: u64,
        condition: SmolStr,
    ) {
        let spot = inquiry.spot;
        let (path, node) = (self.spot_path(spot), self.view().spot_node(spot));
        let was = inquiry.was.clone();
        let inputs = match &was {
            Some(was) => Arc::clone(&was.inputs),
            None => self.inputs_to_come(spot, path, node),
        };
        let around = (!spot.is_root()).then(|| self.run.frames.get(spot.parent).node);
        let scoped_variables = around
            .map(|around| self.view().scoped_variables(spot.parent, self.program.node(around)));
        self.out.effects.push(Effect::Check(Check {
            check,
            branch: inquiry.branch,
            path,
            node,
            condition,
            inputs,
            left: was.map(|was| (was.outputs, was.outcome)),
            scoped_variables: scoped_variables.unwrap_or_default(),
        }));
    }

    /// The inputs that a state would get now. Notes about them are dropped here, and are reported at its entry.
    fn inputs_to_come(&mut self, spot: StopPoint, path: PathId, id: NodeId) -> Arc<[D]> {
        let said = self.out.events.len();
        let node = self.program.node(id);
        let inputs = if spot.is_root() {
            self.root_inputs()
        } else if let Body::Library(content) = self.view().body(spot.parent) {
            self.library_root_inputs(spot.parent, content, (node, path))
        } else {
            let error = self.run.frames.get(spot.parent).last_error.clone();
            self.child_inputs(spot.parent, node, (path, error.as_ref()))
        };
        self.out.events.truncate(said);
        inputs
    }
}

impl<D: Datum> View<'_, '_, D> {
    fn spot_node(&self, spot: StopPoint) -> NodeId {
        if spot.is_root() {
            return Program::<D>::ROOT;
        }
        let parent = self.run.frames.get(spot.parent).node;
        self.program.node(parent).child(spot.child as usize).unwrap_or(parent)
    }
}
