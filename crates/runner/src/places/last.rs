//! The data of the last run of a container or library state, for scripts and programs after its end. This module knows
//! values, but not who reads them.

use rafcon_model::{Port, PortId, State};
use smol_str::SmolStr;
use std::sync::Arc;

/// The data of one run of a state, begun or ended.
#[derive(Debug, Clone)]
pub struct Last<D> {
    /// The state at that time. Its ports name the values.
    state: Arc<State>,
    inputs: Arc<[D]>,
    outputs: Arc<[D]>,
    error: Option<Box<D>>,
    scoped_variables: Vec<(PortId, D)>,
}

impl<D> Last<D> {
    /// The data of a run that begins with these inputs.
    pub(crate) fn begun(state: &Arc<State>, inputs: &Arc<[D]>) -> Self {
        Self {
            state: Arc::clone(state),
            inputs: Arc::clone(inputs),
            outputs: Arc::default(),
            error: None,
            scoped_variables: Vec::new(),
        }
    }

    /// Updates a scoped variable.
    pub(crate) fn set_scoped(&mut self, port: PortId, value: D) {
        match self.scoped_variables.iter_mut().find(|(known, _)| *known == port) {
            Some((_, old)) => *old = value,
            None => self.scoped_variables.push((port, value)),
        }
    }

    /// Stores the end of the run.
    pub(crate) fn end(&mut self, outputs: &Arc<[D]>, error: Option<Box<D>>) {
        self.outputs = Arc::clone(outputs);
        self.error = error;
    }

    /// The inputs by name.
    pub fn inputs(&self) -> impl Iterator<Item = (&SmolStr, &D)> {
        named(self.state.inputs.as_slice(), &self.inputs)
    }

    /// The outputs by name; empty before the end of the run.
    pub fn outputs(&self) -> impl Iterator<Item = (&SmolStr, &D)> {
        named(self.state.outputs.as_slice(), &self.outputs)
    }

    /// The error that the run left, if any.
    pub fn error(&self) -> Option<&D> {
        self.error.as_deref()
    }

    /// The latest values of the scoped variables by name.
    pub fn scoped_variables(&self) -> impl Iterator<Item = (&SmolStr, &D)> {
        let ports = self.state.container().map(|inside| &inside.scoped_variables);
        self.scoped_variables.iter().filter_map(move |(id, value)| {
            let port = ports?.as_slice().iter().find(|port| port.id == *id)?;
            Some((&port.name, value))
        })
    }
}

fn named<'a, D>(ports: &'a [Port], values: &'a [D]) -> impl Iterator<Item = (&'a SmolStr, &'a D)> {
    ports.iter().map(|port| &port.name).zip(values)
}
