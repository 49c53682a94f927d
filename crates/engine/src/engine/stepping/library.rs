//! Library states: one frame for the state and one for the root of its content. Both have equal data and outcome.

use crate::engine::state::frames::{Ended, EndedChild, Seed};
use crate::engine::state::phase::{Cause, Phase};
use crate::engine::state::step::{Step, View, Work};
use crate::engine::state::suspended::StopPoint;
use crate::program::{ABORTED, Content, Node, PREEMPTED};
use crate::{Datum, Level, Note, PathId};
use std::sync::Arc;

impl<'s, D: Datum> Step<'s, D> {
    pub(in crate::engine) fn begin_library(&mut self, slot: u32, content: &'s Content<D>) {
        match content {
            Content::Found { .. } => {
                self.run.frames.get_mut(slot).phase = Phase::Child;
                self.run.work.push(Work::Enter { parent: slot, child: 0 });
            }
            Content::Missing { reason, error, is_library } => {
                let frame = self.run.frames.get_mut(slot);
                let path = frame.path;
                let outputs = frame.outputs.take().unwrap_or_default();
                let reason = reason.clone();
                let note = if *is_library {
                    Note::MissingLibrary { reason }
                } else {
                    Note::DamagedState { reason }
                };
                self.note(path, Level::Error, note);
                let error = error.clone();
                let ended = Ended { outcome: ABORTED, outputs, absent: Vec::new(), error };
                self.run.work.push(Work::Leave { slot, ended: Box::new(ended) });
            }
        }
    }

    /// Continues a library state that was held before or after its root.
    pub(in crate::engine) fn advance_library(&mut self, slot: u32, content: &'s Content<D>) {
        let frame = self.run.frames.get_mut(slot);
        let end = frame.children.library().and_then(|root| root.end.take());
        if let Some(ended) = end {
            self.leave(slot, *ended);
        } else if frame.preempted {
            let outputs = frame.outputs.take().unwrap_or_default();
            self.leave(
                slot,
                Ended { outcome: PREEMPTED, outputs, absent: Vec::new(), error: None },
            );
        } else if content.root().is_none() {
            // The library went missing while the state was held.
            self.begin_library(slot, content);
        } else {
            frame.phase = Phase::Child;
            self.enter_library_root(slot, content);
        }
    }

    /// Enters the root with the inputs, output defaults and error of the library state.
    pub(in crate::engine) fn enter_library_root(&mut self, parent: u32, content: &'s Content<D>) {
        let Content::Found { root, .. } = content else { return };
        let node = self.program.node(*root);
        let path = self.child_path(parent, 0);
        let entered_at = self.out.events.len();
        let inputs = self.library_root_inputs(parent, content, node, path);
        let outputs = self.view().root_outputs(parent, content, node);
        let frame = self.run.frames.get_mut(parent);
        let error = frame.error.take();
        let frame = self.run.frames.get(parent);
        let seed = Seed {
            node: *root,
            path,
            branch: frame.branch,
            parent,
            preempted: frame.preempted,
            start_depth: self.view().start_depth(parent, 0),
            inputs,
            outputs,
            error,
            entered_at,
        };
        self.begin(seed, 0, None);
    }

    /// The inputs of the root, taken from its library state.
    pub(in crate::engine) fn library_root_inputs(
        &mut self,
        library: u32,
        content: &'s Content<D>,
        root: &'s Node<D>,
        path: PathId,
    ) -> Arc<[D]> {
        let inputs = self.run.frames.get(library).inputs.clone().unwrap_or_default();
        let Content::Found { ports: Some(ports), .. } = content else { return inputs };
        let from = |port: usize| inputs.get(ports.inputs[port]? as usize).cloned();
        self.default_inputs(root, path, from)
    }

    /// Ends the library state with the outcome of its root.
    pub(in crate::engine) fn library_root_ended(
        &mut self,
        slot: u32,
        content: &'s Content<D>,
        end: EndedChild<D>,
    ) {
        let EndedChild { ended, run } = end;
        let Content::Found { ports, outcomes, .. } = content else { return };
        let free = self.run.is_free();
        let frame = self.run.frames.get_mut(slot);
        if let Some(root) = frame.children.library() {
            (root.active, root.run) = (None, run);
        }
        let outcome = outcomes.get(ended.outcome as usize).copied().unwrap_or(ABORTED);
        let ended = match ports {
            None => Ended { outcome, ..ended },
            Some(ports) => Ended {
                outcome,
                outputs: mapped(
                    &ports.outputs,
                    &ended.outputs,
                    &frame.outputs.take().unwrap_or_default(),
                ),
                absent: Vec::new(),
                error: ended.error,
            },
        };
        let branch = frame.branch;
        if free {
            return self.run.work.push(Work::Leave { slot, ended: Box::new(ended) });
        }
        if let Some(root) = frame.children.library() {
            root.end = Some(Box::new(ended));
        }
        if self.passes(StopPoint::after(slot, 0), branch) {
            self.run.frames.get_mut(slot).phase = Phase::Held;
            self.wake(&[slot], Cause::LetGo);
        }
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// The output defaults of the root, taken from its library state.
    pub(in crate::engine) fn root_outputs(
        &self,
        library: u32,
        content: &Content<D>,
        root: &Node<D>,
    ) -> Arc<[D]> {
        let outputs = self.run.frames.get(library).outputs.clone().unwrap_or_default();
        match content {
            Content::Found { ports: Some(ports), .. } => {
                mapped(&ports.defaults, &outputs, &root.outputs)
            }
            Content::Found { ports: None, .. } | Content::Missing { .. } => outputs,
        }
    }
}

/// Maps values from ports to their counterparts; ports without one take the value in `otherwise`.
fn mapped<D: Clone>(same: &[Option<u32>], values: &[D], otherwise: &[D]) -> Arc<[D]> {
    let value = |(same, otherwise): (&Option<u32>, &D)| {
        let found = same.and_then(|index| values.get(index as usize));
        found.unwrap_or(otherwise).clone()
    };
    same.iter().zip(otherwise).map(value).collect()
}
