//! Leaves a state, and continues the state around it.

use crate::engine::state::frames::{Ended, EndedChild, NONE};
use crate::engine::state::phase::{Cause, Reaction, react};
use crate::engine::state::step::{Step, View, Work};
use crate::engine::state::suspended::{LeftState, StopPoint};
use crate::engine::{Refusal, Status};
use crate::program::{ABORTED, Body, Inside, Node, PREEMPTED};
use crate::{
    BranchId, Datum, Effect, Event, Finish, FrameId, Level, Note, PathId, Program, Returned,
    ScriptResult, When,
};
use rafcon_model::OutcomeId;
use smol_str::{SmolStr, format_smolstr};
use std::sync::Arc;

impl<'s, D: Datum> Step<'s, D> {
    /// Accepts the result of a script.
    pub(in crate::engine) fn script_ended(
        &mut self,
        id: FrameId,
        result: ScriptResult<D>,
    ) -> Result<(), Refusal> {
        let refusal = || Refusal::NoSuchFrame { frame: id };
        let slot = self.run.frames.find(id).ok_or_else(refusal)?;
        let frame = self.run.frames.get(slot);
        if react(&frame.phase, Cause::ScriptEnded) != Reaction::Leave {
            return Err(refusal());
        }
        if frame.undoes.is_some() {
            self.leave_back(slot);
            return Ok(());
        }
        let (node, path, preempted) = (self.program.node(frame.node), frame.path, frame.preempted);
        let outcome = self.outcome(node, path, preempted, &result.returned);
        let ended = ended(node, outcome, result.outputs, result.error);
        self.leave(slot, ended);
        Ok(())
    }

    /// The outcome that a script meant. An exception takes precedence over a preemption, and that over the returned
    /// value.
    fn outcome(
        &mut self,
        node: &Node<D>,
        path: PathId,
        preempted: bool,
        returned: &Returned,
    ) -> u32 {
        let outcome = match returned {
            Returned::Raised => Some(ABORTED),
            Returned::Id(_) | Returned::Name(_) | Returned::Other(_) if preempted => {
                Some(PREEMPTED)
            }
            Returned::Id(id) => node.outcome_index(*id),
            Returned::Name(name) => node.outcome_named(name),
            Returned::Other(_) => None,
        };
        outcome.unwrap_or_else(|| {
            let returned = shown(returned);
            self.note(path, Level::Error, Note::NoSuchOutcome { returned });
            ABORTED
        })
    }

    /// Aborts a container before anything in it runs, if part of it cannot be created.
    pub(in crate::engine) fn fails_to_begin(&mut self, slot: u32, inside: &'s Inside<D>) -> bool {
        let Some(fault) = &inside.fault else { return false };
        let frame = self.run.frames.get_mut(slot);
        let path = frame.path;
        frame.last_error.clone_from(&fault.error);
        if let Some(port) = fault.port.clone() {
            let reason = fault.reason.clone();
            self.note(path, Level::Error, Note::BadDefault { port, reason });
        }
        self.leave_container_later(slot, inside, ABORTED);
        true
    }

    /// Ends a container with this outcome, or with *preempted* if it was asked to end.
    pub(in crate::engine) fn leave_container(
        &mut self,
        slot: u32,
        inside: &Inside<D>,
        outcome: u32,
    ) {
        let ended = self.end_container(slot, inside, outcome);
        self.leave(slot, ended);
    }

    pub(in crate::engine) fn leave_container_later(
        &mut self,
        slot: u32,
        inside: &Inside<D>,
        outcome: u32,
    ) {
        let ended = self.end_container(slot, inside, outcome);
        self.run.work.push(Work::Leave { slot, ended: Box::new(ended) });
    }

    fn end_container(&mut self, slot: u32, inside: &Inside<D>, outcome: u32) -> Ended<D> {
        let outputs = self.container_outputs(slot, inside);
        let frame = self.run.frames.get_mut(slot);
        let outcome = if frame.preempted { PREEMPTED } else { outcome };
        Ended { outcome, outputs, absent: Vec::new(), error: frame.last_error.take() }
    }

    /// Ends a frame and reports its end.
    pub(in crate::engine) fn leave(&mut self, slot: u32, ended: Ended<D>) {
        let frame = self.run.frames.get(slot);
        let (node, path, parent) = (frame.node, frame.path, frame.parent);
        let about = self.program.node(node);
        self.check_outputs(path, about, &ended.outputs);
        self.out.events.push(Event::Left {
            path,
            node,
            outcome: about.outcome_id(ended.outcome),
            outputs: Arc::clone(&ended.outputs),
            absent: (!ended.absent.is_empty()).then(|| ended.absent.clone().into()),
            error: ended.error.clone().map(Box::new),
            undoes: None,
        });
        if !self.run.control.is_quiet() {
            self.note_left(slot, about.outcome_id(ended.outcome), &ended);
        }
        if parent == NONE {
            self.root_ended(slot, about, ended);
        } else {
            self.child_ended(parent, slot, about.child_index, ended);
        }
    }

    fn child_ended(&mut self, parent: u32, slot: u32, child: u32, ended: Ended<D>) {
        let branch = self.run.frames.get(slot).branch;
        let run = self.ended_run(slot, ended.outcome);
        self.run.frames.remove(slot);
        match self.view().body(parent) {
            Body::Script => {}
            Body::Library(content) => {
                self.library_root_ended(parent, content, EndedChild { ended, run });
            }
            Body::Hierarchy(inside) => {
                self.child_of_hierarchy_ended(parent, inside, child, EndedChild { ended, run });
            }
            Body::Concurrency(kind, inside) if kind.decider() == Some(child) => {
                self.decider_ended(parent, inside, child, ended);
            }
            Body::Concurrency(..) => {
                self.branch_ended(parent, child, branch, EndedChild { ended, run });
            }
        }
    }

    /// Ends the run with its root, unless it is held there.
    fn root_ended(&mut self, slot: u32, node: &'s Node<D>, ended: Ended<D>) {
        let outcome = node.outcome_at(ended.outcome);
        let names = node.outputs().iter().map(|port| port.name.clone());
        let mut outputs: Vec<_> = names.zip(ended.outputs.iter().cloned()).collect();
        outputs.extend(ended.error.map(|error| ("error".into(), error)));
        let scoped_variables = self.view().scoped_variables(slot, node);
        self.run.frames.remove(slot);
        self.run.root = None;
        self.run.finish = Some(Box::new(Finish {
            outcome: outcome.id,
            outcome_name: outcome.name.clone(),
            outputs,
            scoped_variables,
            states_run: self.run.entered,
        }));
        if self.passes(StopPoint::root(When::After), BranchId(0)) {
            self.finish();
        }
    }

    /// Finishes the run. A run that was stopped before its root began ends with *preempted*.
    pub(in crate::engine) fn finish(&mut self) {
        let finish = self.run.finish.take();
        let finish = finish.map_or_else(|| self.view().unbegun(PREEMPTED), |finish| *finish);
        self.run.status = Status::Finished;
        self.run.branches.set_all(false);
        self.out.events.push(Event::Finished { outcome: finish.outcome });
        self.out.effects.push(Effect::Finish(finish));
    }

    /// Records data for breakpoints after a state, and applies the action after the end of the start state.
    fn note_left(&mut self, slot: u32, outcome: OutcomeId, ended: &Ended<D>) {
        let frame = self.run.frames.get(slot);
        let control = &mut self.run.control;
        if !control.breakpoints.is_empty() {
            let inputs = frame.inputs.clone().unwrap_or_default();
            control.was = Some(LeftState { inputs, outputs: Arc::clone(&ended.outputs), outcome });
        }
        if control.then.is_some_and(|(place, _)| place == frame.path) {
            self.target_left();
        }
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// The end of a run whose root never began.
    pub(in crate::engine) fn unbegun(&self, outcome: u32) -> Finish<D> {
        let node = self.program.node(Program::<D>::ROOT);
        let outcome = node.outcome_at(outcome);
        let names = node.outputs().iter().map(|port| port.name.clone());
        Finish {
            outcome: outcome.id,
            outcome_name: outcome.name.clone(),
            outputs: names.zip(node.outputs.iter().cloned()).collect(),
            scoped_variables: Vec::new(),
            states_run: self.run.entered,
        }
    }

    pub(in crate::engine) fn scoped_variables(
        &self,
        slot: u32,
        node: &Node<D>,
    ) -> Vec<(SmolStr, D)> {
        let (Body::Hierarchy(inside) | Body::Concurrency(_, inside)) = &node.body else {
            return Vec::new();
        };
        let slots = self.run.frames.get(slot).slots.iter().skip(node.inputs.len());
        let variables = inside.scoped.iter().zip(slots);
        variables
            .filter_map(|(scoped, slot)| Some((scoped.port.name.clone(), slot.value.clone()?)))
            .collect()
    }
}

fn shown(returned: &Returned) -> SmolStr {
    match returned {
        Returned::Id(id) => format_smolstr!("{id}"),
        Returned::Name(name) => format_smolstr!("'{name}'"),
        Returned::Other(shown) => shown.clone(),
        Returned::Raised => SmolStr::new_static("an exception"),
    }
}

/// The end of a script. Missing outputs flow nowhere.
pub(in crate::engine) fn ended<D: Datum>(
    node: &Node<D>,
    outcome: u32,
    mut outputs: Vec<Option<D>>,
    error: Option<D>,
) -> Ended<D> {
    outputs.resize(node.outputs.len(), None);
    let missing = (0..).zip(&outputs).filter(|(_, value)| value.is_none());
    let absent = missing.map(|(index, _)| index).collect();
    let outputs = outputs.into_iter().map(|value| value.unwrap_or_else(D::none)).collect();
    Ended { outcome, outputs, absent, error }
}
