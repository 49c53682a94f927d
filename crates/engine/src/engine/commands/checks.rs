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
        scan: &BreakpointScan<D>,
        check: u64,
        condition: SmolStr,
    ) {
        let stop_point = scan.stop_point;
        let (path, node) =
            (self.stop_point_path(stop_point), self.view().stop_point_node(stop_point));
        let was = scan.was.clone();
        let inputs = match &was {
            Some(was) => Arc::clone(&was.inputs),
            None => self.inputs_to_come(stop_point, path, node),
        };
        let around = (!stop_point.is_root()).then(|| self.run.frames.get(stop_point.parent).node);
        let scoped_variables = around.map(|around| {
            self.view().scoped_variables(stop_point.parent, self.program.node(around))
        });
        self.out.effects.push(Effect::Check(Check {
            check,
            branch: scan.branch,
            path,
            node,
            condition,
            inputs,
            left: was.map(|was| (was.outputs, was.outcome)),
            scoped_variables: scoped_variables.unwrap_or_default(),
        }));
    }

    /// The inputs that a state would get now. Notes about them are dropped here, and are reported at its entry.
    fn inputs_to_come(&mut self, stop_point: StopPoint, path: PathId, id: NodeId) -> Arc<[D]> {
        let said = self.out.events.len();
        let node = self.program.node(id);
        let inputs = if stop_point.is_root() {
            self.root_inputs()
        } else if let Body::Library(content) = self.view().body(stop_point.parent) {
            self.library_root_inputs(stop_point.parent, content, node, path)
        } else {
            let error = self.run.frames.get(stop_point.parent).last_error.clone();
            self.child_inputs(stop_point.parent, node, path, error.as_ref())
        };
        self.out.events.truncate(said);
        inputs
    }
}

impl<D: Datum> View<'_, '_, D> {
    fn stop_point_node(&self, stop_point: StopPoint) -> NodeId {
        if stop_point.is_root() {
            return Program::<D>::ROOT;
        }
        let parent = self.run.frames.get(stop_point.parent).node;
        self.program.node(parent).child(stop_point.child as usize).unwrap_or(parent)
    }
}
