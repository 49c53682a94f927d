//! The machine that a run goes by. Knows the latest root and what it was compiled to; must never know who changes it.

use parking_lot::RwLock;
use rafcon_engine::Program;
use rafcon_model::Machine;
use std::sync::Arc;

/// The machine of a run, as it is now.
#[derive(Debug)]
pub(crate) struct Document<D> {
    current: RwLock<Root<D>>,
}

/// One root of the machine.
#[derive(Debug)]
pub(crate) struct Root<D> {
    pub(crate) machine: Arc<Machine>,
    pub(crate) program: Arc<Program<D>>,
}

impl<D> Document<D> {
    /// A machine that nobody has changed.
    pub(crate) fn new(machine: Machine, program: Arc<Program<D>>) -> Self {
        Self { current: RwLock::new(Root { machine: Arc::new(machine), program }) }
    }

    /// What is run.
    pub(crate) fn program(&self) -> Arc<Program<D>> {
        Arc::clone(&self.current.read().program)
    }

    /// The machine that is run.
    pub(crate) fn machine(&self) -> Arc<Machine> {
        Arc::clone(&self.current.read().machine)
    }
}
