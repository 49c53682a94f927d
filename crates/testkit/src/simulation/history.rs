//! State of a run reconstructed from its events alone, as from a journal.

use rafcon_engine::{
    ActiveStateData, ChildEnd, Engine, Event, NodeId, PathId, ScopedValue, Stopping,
};
use rafcon_model::{KindName, OutcomeId, PortId, Value};
use std::collections::BTreeMap;

/// State after the events until now. Supports forward steps only.
#[derive(Debug, Default)]
pub(crate) struct History {
    active: BTreeMap<PathId, ActiveStateData<Value>>,
    events: u64,
    /// The last request to stop, and a flag for earlier ones.
    stop: Option<Stopping>,
}

impl History {
    pub(crate) fn event(&mut self, event: &Event<Value>, engine: &Engine<Value>) {
        self.events += 1;
        match event {
            Event::Entered { path, node, inputs, .. } => {
                let entered = self.entered(engine, *path, *node, inputs);
                self.active.insert(*path, entered);
            }
            Event::Left { path, node, outcome, outputs, absent, error, .. } => {
                let absent = absent.as_deref().unwrap_or_default();
                let end = ChildEnd {
                    outputs: given(engine, *node, outputs, absent),
                    error: error.as_deref().cloned(),
                    ..self.ended(engine, *node, *outcome)
                };
                self.left(*path, end, engine);
            }
            Event::Scoped { path, port, value } => {
                let Some(around) = self.active.get_mut(path) else { return };
                around.scoped.retain(|variable| variable.port != *port);
                let (port, value, order) = (*port, value.clone(), self.events);
                around.scoped.push(ScopedValue { port, value, order });
            }
            Event::Dropped { path } => {
                self.active.remove(path);
            }
            Event::Stopping => {
                self.stop = Some(Stopping { order: self.events, twice: self.stop.is_some() });
            }
            _ => {}
        }
    }

    fn entered(
        &self,
        engine: &Engine<Value>,
        path: PathId,
        node: NodeId,
        inputs: &[Value],
    ) -> ActiveStateData<Value> {
        let about = engine.program().node(node);
        let ports = about.inputs().iter().map(|port| port.id);
        ActiveStateData {
            state: about.id().clone(),
            inputs: ports.zip(inputs.iter().cloned()).collect(),
            order: self.events,
            error: self.handed_on(engine, path),
            preempted: None,
            scoped: Vec::new(),
            ended: Vec::new(),
            last: None,
            children: Vec::new(),
        }
    }

    /// The error of the previous state, or of the library state around a root.
    fn handed_on(&self, engine: &Engine<Value>, path: PathId) -> Option<Value> {
        let parent = engine.path_parent(path)?;
        let node = engine.program().node(engine.path_node(parent)?);
        let around = self.active.get(&parent)?;
        let last = around.ended.iter().rfind(|end| Some(&end.state) == around.last.as_ref());
        match last {
            Some(end) if end.outcome == OutcomeId::ABORTED => end.error.clone(),
            None if node.state().kind.name() == KindName::Library => around.error.clone(),
            Some(_) | None => None,
        }
    }

    fn ended(&self, engine: &Engine<Value>, node: NodeId, outcome: OutcomeId) -> ChildEnd<Value> {
        let state = engine.program().node(node).id().clone();
        ChildEnd { state, outcome, outputs: Vec::new(), error: None, order: self.events }
    }

    fn left(&mut self, path: PathId, end: ChildEnd<Value>, engine: &Engine<Value>) {
        self.active.remove(&path);
        let around = engine.path_parent(path).and_then(|around| self.active.get_mut(&around));
        if let Some(around) = around {
            around.last = Some(end.state.clone());
            // Keep earlier outputs of a state that its last end left out.
            for other in around.ended.iter_mut().filter(|other| other.state == end.state) {
                other.outputs.retain(|(id, _)| !end.outputs.iter().any(|(given, _)| given == id));
            }
            around.ended.retain(|other| other.state != end.state || !other.outputs.is_empty());
            around.ended.push(end);
        }
    }

    /// The stop request of the run, if any.
    pub(crate) fn stopping(&self) -> Option<Stopping> {
        self.stop
    }

    /// The active states with all their data.
    pub(crate) fn configuration(&self, engine: &Engine<Value>) -> Option<ActiveStateData<Value>> {
        let mut made: BTreeMap<PathId, Vec<ActiveStateData<Value>>> = BTreeMap::new();
        // The number of a place is higher than that of its parent.
        for (path, active) in self.active.iter().rev() {
            let mut restored = active.clone();
            restored.children = made.remove(path).unwrap_or_default();
            match engine.path_parent(*path) {
                Some(around) => made.entry(around).or_default().push(restored),
                None => return Some(restored),
            }
        }
        None
    }
}

fn given(
    engine: &Engine<Value>,
    node: NodeId,
    outputs: &[Value],
    absent: &[u32],
) -> Vec<(PortId, Value)> {
    let ports = (0..).zip(engine.program().node(node).outputs()).zip(outputs);
    let there = ports.filter(|((index, _), _)| !absent.contains(index));
    there.map(|((_, port), value)| (port.id, value.clone())).collect()
}
