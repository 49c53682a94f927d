//! Queries of scripts about their own run. Called on any thread, never while the engine is locked.

use crate::drive::core::Core;
use crate::drive::driver::Driver;
use crate::places::last::Last;
use crate::{Place, Scripts};
use rafcon_engine::{Inspection, PathId, Status};
use rafcon_model::{Machine, Port};
use rafcon_protocol::{StateData, Values};
use smol_str::SmolStr;
use std::sync::Arc;

impl<S: Scripts> Driver<S> {
    /// The place with this number, even if no state was entered there yet.
    pub fn place(&self, path: PathId) -> Option<Arc<Place>> {
        self.places().get(path).cloned().or_else(|| {
            let make = |core: &mut Core<S::Value>| {
                let node = core.engine.path_node(path)?;
                Some(Arc::clone(core.place_of(path, node)))
            };
            self.with_core(make)?
        })
    }

    /// The places of the states inside, in their order.
    pub fn children(&self, path: PathId) -> Vec<PathId> {
        self.with_core(|core| core.engine.child_places(path).to_vec()).unwrap_or_default()
    }

    /// The data of the state at this place; `None` if it is not active.
    pub fn inspect(&self, path: PathId) -> Option<Inspection<S::Value>> {
        self.with_core(|core| core.engine.inspect(path))?
    }

    /// The data of the last run of the container or library state at this place; `None` if it has not run.
    pub fn last(&self, path: PathId) -> Option<Last<S::Value>> {
        let last = |core: &mut Core<S::Value>| {
            let known = core.known.get(path.index())?.as_ref()?;
            known.last.as_deref().cloned()
        };
        self.with_core(last)?
    }

    /// The current status of the run.
    pub fn status(&self) -> Option<Status> {
        self.with_core(|core| core.engine.status())
    }

    /// The machine that currently runs.
    pub fn machine(&self) -> Arc<Machine> {
        self.document().machine()
    }
}

/// The data of the state at `path` (ids joined by `/`), encoded for viewers; `None` if it is not active.
pub(crate) fn state_data<S: Scripts>(driver: &Driver<S>, path: &str) -> Option<StateData> {
    let find = |core: &mut Core<S::Value>| {
        let active = core.engine.snapshot();
        let at =
            active.iter().find(|active| core.engine.path_text(active.path).to_string() == path)?;
        Some((core.engine.inspect(at.path)?, at.node, Arc::clone(core.engine.program())))
    };
    let (held, node, program) = driver.with_core(find)??;
    let node = program.node(node);
    let ports = |ports: &[Port], values: &[S::Value]| -> Values {
        let named = ports.iter().zip(values);
        named.map(|(port, value)| encoded(driver, &port.name, value)).collect()
    };
    let data = StateData {
        inputs: ports(node.inputs(), &held.inputs),
        outputs: ports(node.outputs(), &held.outputs),
        scoped_variables: held
            .scoped_variables
            .iter()
            .map(|(name, value)| encoded(driver, name, value))
            .collect(),
    };
    drop(held);
    driver.scripts().settle();
    Some(data)
}

fn encoded<S: Scripts>(
    driver: &Driver<S>,
    name: &SmolStr,
    value: &S::Value,
) -> (String, serde_json::Value) {
    (name.to_string(), driver.scripts().encode(value))
}
