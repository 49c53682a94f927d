//! Starts a run, also again: at a state, with values, held or not, and with an action after the start state.

use crate::engine::state::frames::Seed;
use crate::engine::state::phase::Phase;
use crate::engine::state::step::{Step, View};
use crate::engine::state::suspended::{StopPoint, SuspendedBranch};
use crate::engine::{Command, Refusal, Run, Status};
use crate::program::{Body, Inside};
use crate::{BranchId, Datum, Effect, Event, NodeId, PathId, Program, Start, Then, When};
use rafcon_model::{Port, PortId};
use smol_str::SmolStr;

/// A value for a state on the start path.
#[derive(Debug)]
pub(in crate::engine) struct Given<D> {
    place: PathId,
    port: Where,
    value: D,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Where {
    /// An input port of the state.
    Input(PortId),
    /// A scoped variable of the container.
    Scoped(PortId),
}

impl<'s, D: Datum> Step<'s, D> {
    pub(in crate::engine) fn start(&mut self, start: Start<D>) -> Result<(), Refusal> {
        self.view().nothing_runs(Command::Start)?;
        let steps = match &start.start_from {
            Some(path) => self.program.descend(path)?.1,
            None => Vec::new(),
        };
        let given = self.given(&start)?;
        if self.run.status == Status::Paused {
            self.pause(false);
        }
        self.drop_all();
        self.run.status = Status::Running;
        self.run.control.then = self.target(&steps).map(|place| (place, start.then));
        self.run.control.starting = start.hold;
        self.run.branches.set_all(start.hold);
        self.run.start_from = steps;
        self.run.inputs = start.inputs;
        self.run.given = given;
        if self.passes(StopPoint::root(When::Before), BranchId(0)) {
            self.enter_root();
        }
        Ok(())
    }

    /// The place whose end triggers the action of a start inside: the start state, or the outermost concurrency state
    /// around it.
    pub(in crate::engine) fn target(&mut self, steps: &[u32]) -> Option<PathId> {
        let mut node = Program::<D>::ROOT;
        let mut depth = 0;
        while depth < steps.len() && !matches!(self.program.node(node).body, Body::Concurrency(..))
        {
            node = self.program.node(node).child(steps[depth] as usize)?;
            depth += 1;
        }
        (depth > 0).then(|| self.place_of(&steps[..depth]))
    }

    fn place_of(&mut self, steps: &[u32]) -> PathId {
        let enter = |place, &child: &u32| self.run.places.enter(place, child, self.program);
        steps.iter().fold(PathId(0), enter)
    }

    fn given(&mut self, start: &Start<D>) -> Result<Vec<Given<D>>, Refusal> {
        let values = start.given.iter().map(|(path, name, value)| {
            let (node, steps) = self.program.descend(path)?;
            let on_the_way = match &start.start_from {
                Some(from) => from.0.starts_with(&path.0),
                None => steps.is_empty(),
            };
            let port = self.view().port_named(node, name).filter(|_| on_the_way);
            let refusal = || Refusal::NoPlaceFor { path: path.clone(), name: name.clone() };
            let port = port.ok_or_else(refusal)?;
            Ok(Given { place: self.place_of(&steps), port, value: value.clone() })
        });
        values.collect()
    }

    /// Replaces the inputs of a state at its first entry with values from the start.
    pub(in crate::engine) fn give_inputs(&mut self, seed: &mut Seed<D>) {
        for (port, value) in self.run.given_to(seed.path, |port| matches!(port, Where::Input(_))) {
            let ports = self.program.node(seed.node).inputs().iter();
            let given = ports.zip(seed.inputs.iter()).map(|(own, input)| {
                if port == Where::Input(own.id) { value.clone() } else { input.clone() }
            });
            seed.inputs = given.collect();
        }
    }

    /// Replaces the scoped variables of a container at its first entry with values from the start.
    pub(in crate::engine) fn give_scoped(&mut self, slot: u32, inside: &'s Inside<D>) {
        let frame = self.run.frames.get(slot);
        let (path, first) = (frame.path, self.program.node(frame.node).inputs.len());
        for (port, value) in self.run.given_to(path, |port| matches!(port, Where::Scoped(_))) {
            let mut variables = inside.scoped.iter();
            if let Some(index) = variables.position(|own| port == Where::Scoped(own.port.id)) {
                self.put(slot, inside, crate::program::index(first + index), &value);
            }
        }
    }

    /// Applies the action after the start state. A run that is stopping continues to stop.
    pub(in crate::engine) fn target_left(&mut self) {
        let then = self.run.control.then.take();
        match then.filter(|_| self.run.status != Status::Stopping) {
            Some((_, Then::Hold)) => self.step_all(true),
            Some((_, Then::Stop)) => self.run.control.stop_next = true,
            Some((_, Then::GoOn)) | None => {}
        }
    }
}

impl<D: Datum> View<'_, '_, D> {
    fn port_named(&self, node: NodeId, name: &SmolStr) -> Option<Where> {
        let node = self.program.node(node);
        let named = |port: &&Port| port.name == *name;
        let input = node.inputs().iter().find(named).map(|port| port.id);
        let scoped = || match &node.body {
            Body::Hierarchy(inside) | Body::Concurrency(_, inside) => {
                inside.scoped.iter().map(|scoped| &scoped.port).find(named).map(|port| port.id)
            }
            Body::Script | Body::Library(_) => None,
        };
        input.map(Where::Input).or_else(|| scoped().map(Where::Scoped))
    }

    /// The child of this frame on the start path, while no child has ended.
    pub(in crate::engine) fn leads_to(&self, slot: u32) -> Option<u32> {
        let frame = self.run.frames.get(slot);
        let depth = frame.start_depth.filter(|_| frame.last.is_none())?;
        self.run.start_from.get(depth as usize).copied()
    }
}

impl<D: Datum> Run<D> {
    /// Takes the values for these ports of a state that begins.
    fn given_to(&mut self, place: PathId, wanted: impl Fn(Where) -> bool) -> Vec<(Where, D)> {
        if self.given.is_empty() {
            return Vec::new();
        }
        let taken = self.given.extract_if(.., |given| given.place == place && wanted(given.port));
        taken.map(|given| (given.port, given.value)).collect()
    }

    /// The place that these steps lead to, if its parent was entered.
    pub(in crate::engine) fn place(&self, program: &Program<D>, steps: &[u32]) -> Option<PathId> {
        let child = |place, &step: &u32| self.places.child(place, step as usize, program);
        steps.iter().try_fold(PathId(0), child)
    }
}

impl<D: Datum> Step<'_, D> {
    /// Drops all active states, parents before children, and ends their branches.
    pub(in crate::engine) fn drop_all(&mut self) {
        let frames = self.view().active();
        for SuspendedBranch { stop_point, branch, .. } in
            std::mem::take(&mut self.run.control.holds)
        {
            if self.view().is_branch(stop_point) {
                self.run.branches.end(branch);
                self.out.effects.push(Effect::EndBranch { branch });
            }
        }
        for &slot in &frames {
            self.out.events.push(Event::Dropped { path: self.run.frames.get(slot).path });
        }
        for slot in frames.into_iter().rev() {
            let (frame, branches) = (self.run.frames.get(slot), &mut self.run.branches);
            let (branch, parent) = (frame.branch, frame.parent);
            let is_own = parent != crate::engine::state::frames::NONE
                && self.run.frames.get(parent).branch != branch;
            if is_own {
                branches.end(branch);
                self.out.effects.push(Effect::EndBranch { branch });
            }
            self.run.frames.remove(slot);
        }
        self.run.root = None;
        self.run.finish = None;
        self.run.control.forget();
        self.step_all(false);
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// Refuses a command that would end a running script or check without its result.
    pub(in crate::engine) fn nothing_runs(&self, command: Command) -> Result<(), Refusal> {
        self.legal(command)?;
        if let Some(check) = self.run.control.holds.iter().find_map(SuspendedBranch::check) {
            return Err(Refusal::StillChecks { command, check });
        }
        let runs = |&slot: &u32| self.run.frames.get(slot).phase == Phase::Script;
        let Some(slot) = self.active().into_iter().find(runs) else { return Ok(()) };
        let path = self.run.places.text(self.run.frames.get(slot).path, self.program);
        Err(Refusal::StillRuns { command, path })
    }
}
