//! Adds the content of a library to its instance: outcomes and ports of its root, or those that the instance implies if the library
//! is missing. [`Libraries`] finds the library.

use super::library_label;
use crate::libraries::{Libraries, Loading, ReadLibrary};
use crate::problem::Fault;
use rafcon_model::{
    DataFlows, DataType, Kind, Library, LibraryContent, Port, PortId, Ports, RuntimeValues, State,
    Value,
};
use smol_str::{SmolStr, format_smolstr};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

/// Adds the content of libraries to one machine.
#[derive(Debug)]
pub(crate) struct Contents<'l> {
    libraries: &'l Libraries,
    loading: &'l Loading<'l>,
    /// Libraries whose own faults are already reported.
    reported: BTreeSet<SmolStr>,
}

impl<'l> Contents<'l> {
    pub(crate) fn new(libraries: &'l Libraries, loading: &'l Loading<'l>) -> Self {
        Self { libraries, loading, reported: BTreeSet::new() }
    }

    /// Looks up the library of `state` and takes outcomes and ports from it.
    pub(crate) fn fill(&mut self, state: &mut State) -> Vec<Fault> {
        let Kind::Library(library) = &mut state.kind else { return Vec::new() };
        let label = library_label(&library.path, &library.name);
        match self.libraries.resolve(&library.path, &library.name, self.loading) {
            Err(reason) => {
                library.content = LibraryContent::Missing { reason: reason.clone() };
                vec![Fault::MissingLibrary { library: label, reason }]
            }
            Ok(parsed) => {
                let mut faults = differences(library, &parsed, &label);
                faults.extend(self.own_faults(&parsed, &label));
                library.content = LibraryContent::Found(Arc::clone(&parsed.root));
                state.outcomes = parsed.root.outcomes.clone();
                state.inputs = parsed.root.inputs.clone();
                state.outputs = parsed.root.outputs.clone();
                faults
            }
        }
    }

    fn own_faults(&mut self, parsed: &ReadLibrary, label: &SmolStr) -> Option<Fault> {
        let first = parsed.problems.first()?;
        let is_new = self.reported.insert(label.clone());
        is_new.then(|| Fault::InLibrary {
            library: label.clone(),
            count: parsed.problems.len(),
            first: first.to_string().into(),
        })
    }
}

/// The differences between the instance and the library.
fn differences(library: &Library, parsed: &ReadLibrary, label: &SmolStr) -> Vec<Fault> {
    let mut faults = Vec::new();
    if let Some(found) = parsed.version.as_ref().filter(|v| Some(*v) != library.version.as_ref()) {
        let wanted = library.version.clone().unwrap_or_else(|| "none".into());
        faults.push(Fault::LibraryVersion { library: label.clone(), wanted, found: found.clone() });
    }
    let sides = [
        ("input", &library.inputs, &parsed.root.inputs),
        ("output", &library.outputs, &parsed.root.outputs),
    ];
    for (side, values, ports) in sides {
        for port in values.keys().filter(|port| ports.get(**port).is_none()) {
            faults.push(Fault::ValueWithoutPort { library: label.clone(), side, port: *port });
        }
    }
    faults
}

/// Gives a missing library the ports that its runtime values and the data flows around it use.
pub(crate) fn ports_of_missing(state: &mut State, flows: &DataFlows) {
    let Kind::Library(library) = &state.kind else { return };
    if !matches!(library.content, LibraryContent::Missing { .. }) {
        return;
    }
    let into = flows.iter().filter(|flow| flow.to_state == state.id).map(|flow| flow.to_port);
    let from = flows.iter().filter(|flow| flow.from_state == state.id).map(|flow| flow.from_port);
    state.inputs = known_ports("input", &library.inputs, into);
    state.outputs = known_ports("output", &library.outputs, from);
}

fn known_ports(
    side: &str,
    values: &RuntimeValues,
    connected: impl Iterator<Item = PortId>,
) -> Ports {
    let ids: BTreeSet<PortId> = values.keys().copied().chain(connected).collect();
    let port = |id: PortId| {
        let value = values.get(&id).map_or(Value::None, |value| value.value.clone());
        Port::new(id, format_smolstr!("{side}_{id}"), DataType::Object, value)
    };
    ids.into_iter().map(port).collect()
}

/// Looks up the library of `state`, which is in no machine yet, and takes outcomes and ports from it. Returns
/// the differences; a state of another kind stays as it is.
pub fn fill_library(state: &mut State, libraries: &Libraries) -> Vec<Fault> {
    Contents::new(libraries, &Loading::first(PathBuf::new())).fill(state)
}
