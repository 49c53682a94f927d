//! Encodes a state as `core_data.json` and the machine as `statemachine.json`: exactly the keys that the reference reads, and the
//! unknown keys of the file. Writes no files.

use rafcon_model::{
    Container, DataFlow, Header, Json, Kind, Library, Outcome, OutcomeId, Port, Ports,
    RuntimeValues, State, StateId, Transition, json,
};
use smol_str::{SmolStr, ToSmolStr as _};

/// The release of the reference that introduced the current layout.
const LAYOUT_VERSION: &str = "2.2.0";

/// The text of the state's `core_data.json`.
pub fn core(state: &State) -> String {
    let mut object = Object::of(class(&state.kind));
    object.put("name", Json::Str(state.name.clone()));
    object.put("state_id", Json::Str(state.id.0.clone()));
    object.put("outcomes", map(state.outcomes.iter().map(outcome)));
    match &state.kind {
        Kind::Execution(_) | Kind::Decider(_) => object.interface(state),
        Kind::Hierarchy(inside) | Kind::Barrier(inside) | Kind::Preemptive(inside) => {
            object.interface(state);
            object.container(inside);
        }
        Kind::Library(library) => object.library(library, state),
    }
    object.text(state.extra.as_deref())
}

/// The text of the machine's `statemachine.json`.
pub(crate) fn header(header: &Header) -> String {
    let mut object = Object(Json::object());
    let text = |text: &SmolStr| Json::Str(text.clone());
    object.put("creation_time", text(&header.creation_time));
    object.put("state_machine_version", header.version.as_ref().map_or(Json::Null, text));
    object
        .put("used_rafcon_version", Json::Str(writer_version(header.used_rafcon_version.as_ref())));
    object.text(header.extra.as_deref())
}

/// The text of the machine's own layout file, if it has one.
pub(crate) fn machine_layout(header: &Header) -> Option<String> {
    header.layout.text().map(document)
}

/// The version of the last writer, at least that of the layout.
fn writer_version(version: Option<&SmolStr>) -> SmolStr {
    let number = |part: &str| part.parse::<u32>().unwrap_or(0);
    let release = |text: &str| text.split('.').map(number).take(2).collect::<Vec<_>>();
    let newer = version.filter(|version| release(version) >= release(LAYOUT_VERSION));
    newer.cloned().unwrap_or_else(|| SmolStr::new_static(LAYOUT_VERSION))
}

fn class(kind: &Kind) -> &'static str {
    match kind {
        Kind::Execution(_) => "rafcon.core.states.execution_state.ExecutionState",
        Kind::Decider(_) => "rafcon.core.states.barrier_concurrency_state.DeciderState",
        Kind::Hierarchy(_) => "rafcon.core.states.hierarchy_state.HierarchyState",
        Kind::Barrier(_) => "rafcon.core.states.barrier_concurrency_state.BarrierConcurrencyState",
        Kind::Preemptive(_) => {
            "rafcon.core.states.preemptive_concurrency_state.PreemptiveConcurrencyState"
        }
        Kind::Library(_) => "rafcon.core.states.library_state.LibraryState",
    }
}

/// A JSON object under construction.
struct Object(Json);

impl Object {
    fn of(class: &'static str) -> Self {
        let mut object = Self(Json::object());
        object.put("__jsonqualname__", Json::Str(SmolStr::new_static(class)));
        object
    }

    fn put(&mut self, key: &'static str, value: Json) {
        if let Json::Object(members) = &mut self.0 {
            members.push((SmolStr::new_static(key), value));
        }
    }

    fn text(mut self, extra: Option<&Json>) -> String {
        merge(&mut self.0, extra);
        json::write(&self.0)
    }

    fn with(mut self, extra: Option<&Json>) -> Json {
        merge(&mut self.0, extra);
        self.0
    }

    fn interface(&mut self, state: &State) {
        let description = state.description.as_deref();
        self.put("description", description.map_or(Json::Null, |text| Json::Str(text.into())));
        self.put("income", Self::of("rafcon.core.state_elements.logical_port.Income").0);
        let input = "rafcon.core.state_elements.data_port.InputDataPort";
        self.put("input_data_ports", ports(&state.inputs, input));
        let output = "rafcon.core.state_elements.data_port.OutputDataPort";
        self.put("output_data_ports", ports(&state.outputs, output));
    }

    fn container(&mut self, container: &Container) {
        self.put("transitions", map(container.transitions.iter().map(transition)));
        self.put("data_flows", map(container.data_flows.iter().map(data_flow)));
        let variable = "rafcon.core.state_elements.scope.ScopedVariable";
        self.put("scoped_variables", ports(&container.scoped_variables, variable));
    }

    /// Writes the description of a library state, which the reference ignores, only if there is one.
    fn library(&mut self, library: &Library, state: &State) {
        if let Some(description) = state.description.as_deref() {
            self.put("description", Json::Str(description.into()));
        }
        let version = library.version.clone().unwrap_or_else(|| SmolStr::new_static("None"));
        self.put("library_path", Json::Str(library.path.clone()));
        self.put("library_name", Json::Str(library.name.clone()));
        self.put("version", Json::Str(version));
        self.put("input_data_port_runtime_values", values(&library.inputs));
        self.put("use_runtime_value_input_data_ports", flags(&library.inputs));
        self.put("output_data_port_runtime_values", values(&library.outputs));
        self.put("use_runtime_value_output_data_ports", flags(&library.outputs));
    }
}

/// Adds members that are only in `extra`, recursively; common members keep the value of `into`.
fn merge(into: &mut Json, extra: Option<&Json>) {
    let Some(Json::Object(members)) = extra else { return };
    for (key, value) in members {
        let Json::Object(known) = &mut *into else { return };
        match known.iter_mut().find(|(name, _)| name == key) {
            Some((_, inside)) => merge(inside, Some(value)),
            None => known.push((key.clone(), value.clone())),
        }
    }
}

fn map(elements: impl Iterator<Item = (i64, Json)>) -> Json {
    Json::Object(elements.map(|(id, element)| (id.to_smolstr(), element)).collect())
}

fn outcome(outcome: &Outcome) -> (i64, Json) {
    let mut object = Object::of("rafcon.core.state_elements.logical_port.Outcome");
    object.put("name", Json::Str(outcome.name.clone()));
    object.put("outcome_id", Json::Int(outcome.id.0));
    (outcome.id.0, object.with(outcome.extra.as_deref()))
}

fn ports(ports: &Ports, class: &'static str) -> Json {
    map(ports.iter().map(|port| (port.id.0, self::port(port, class))))
}

fn port(port: &Port, class: &'static str) -> Json {
    let mut object = Object::of(class);
    object.put("name", Json::Str(port.name.clone()));
    object.put("data_port_id", Json::Int(port.id.0));
    object.put("data_type", port.data_type.to_json());
    object.put("default_value", port.default.to_json());
    object.with(port.extra.as_deref())
}

fn transition(transition: &Transition) -> (i64, Json) {
    let state = |id: &Option<StateId>| id.as_ref().map_or(Json::Null, |id| Json::Str(id.0.clone()));
    let outcome = |id: Option<OutcomeId>| id.map_or(Json::Null, |id| Json::Int(id.0));
    let mut object = Object::of("rafcon.core.state_elements.transition.Transition");
    object.put("transition_id", Json::Int(transition.id.0));
    object.put("from_state", state(&transition.from_state));
    object.put("from_outcome", outcome(transition.from_outcome));
    object.put("to_state", state(&transition.to_state));
    object.put("to_outcome", outcome(transition.to_outcome));
    (transition.id.0, object.with(transition.extra.as_deref()))
}

fn data_flow(flow: &DataFlow) -> (i64, Json) {
    let mut object = Object::of("rafcon.core.state_elements.data_flow.DataFlow");
    object.put("data_flow_id", Json::Int(flow.id.0));
    object.put("from_state", Json::Str(flow.from_state.0.clone()));
    object.put("from_key", Json::Int(flow.from_port.0));
    object.put("to_state", Json::Str(flow.to_state.0.clone()));
    object.put("to_key", Json::Int(flow.to_port.0));
    (flow.id.0, object.with(flow.extra.as_deref()))
}

fn values(values: &RuntimeValues) -> Json {
    map(values.iter().map(|(port, value)| (port.0, value.value.to_json())))
}

fn flags(values: &RuntimeValues) -> Json {
    map(values.iter().map(|(port, value)| (port.0, Json::Bool(value.used))))
}

/// The text of a `semantic_data.json` or `meta_data.json`. Text that is not JSON is not changed.
pub(crate) fn document(text: &str) -> String {
    json::parse(text).map_or_else(|_| text.to_owned(), |document| json::write(&document))
}
