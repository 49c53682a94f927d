//! Rules about library states.

use super::{Fault, PortKind, Rule};
use crate::{
    Conversion, Kind, Library, LibraryContent, PortId, RuntimeValues, State, convert_runtime_value,
};

pub(super) fn faults(state: &State, library: &Library, faults: &mut Vec<Fault>) {
    if library.name.is_empty() {
        faults.push(Fault::new(Rule::LibraryName, "the library has no name"));
    }
    match &library.content {
        LibraryContent::Missing { reason } => {
            let place = format!("{}/{}", library.path, library.name);
            let what = format!("the library {place} was not found: {reason}");
            faults.push(Fault::new(Rule::LibraryMissing, what));
        }
        LibraryContent::Found(root) => {
            if (&state.outcomes, &state.inputs, &state.outputs)
                != (&root.outcomes, &root.inputs, &root.outputs)
            {
                let what = "its outcomes or ports are not those of the library";
                faults.push(Fault::new(Rule::LibraryInterface, what));
            }
        }
    }
}

fn library(state: &State) -> Option<&Library> {
    match &state.kind {
        Kind::Library(library) => Some(library),
        Kind::Execution(_)
        | Kind::Decider(_)
        | Kind::Hierarchy(_)
        | Kind::Barrier(_)
        | Kind::Preemptive(_) => None,
    }
}

fn values(library: &Library, kind: PortKind) -> Option<&RuntimeValues> {
    match kind {
        PortKind::Input => Some(&library.inputs),
        PortKind::Output => Some(&library.outputs),
        PortKind::ScopedVariable => None,
    }
}

/// The ports with runtime values of a library state.
pub(super) fn runtime_values(state: &State) -> impl Iterator<Item = (PortKind, PortId)> {
    let library = library(state).into_iter();
    library.flat_map(|library| {
        let inputs = library.inputs.keys().map(|id| (PortKind::Input, *id));
        inputs.chain(library.outputs.keys().map(|id| (PortKind::Output, *id)))
    })
}

pub(super) fn runtime_value_faults(state: &State, kind: PortKind, id: PortId) -> Vec<Fault> {
    let value = library(state).and_then(|library| values(library, kind)?.get(&id));
    let Some(value) = value else { return Vec::new() };
    let Some(port) = kind.of(state).and_then(|ports| ports.get(id)) else {
        let what = format!("there is no {kind} with the id {id}");
        return vec![Fault::new(Rule::RuntimeValuePort, what)];
    };
    match convert_runtime_value(&value.value, &port.data_type) {
        Conversion::Fails(reason) if value.used => {
            let what = format!("the runtime value of `{}`: {reason}", port.name);
            vec![Fault::new(Rule::RuntimeValueType, what)]
        }
        Conversion::Fails(_)
        | Conversion::Value(_)
        | Conversion::Global(_)
        | Conversion::NeedsPython => Vec::new(),
    }
}
