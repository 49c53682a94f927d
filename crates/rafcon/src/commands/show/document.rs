//! A machine as one JSON document. Values are those of the file format; numbers that JSON does not have are texts.

use anyhow::Result;
use rafcon_model::{self as model, Json, Kind, LibraryContent, StateId, Target};
use serde::Serialize;
use serde_json::Value;

/// Returns the document with indentation and a final newline.
pub(super) fn print(machine: &model::Machine) -> Result<String> {
    let document = Machine {
        creation_time: &machine.header.creation_time,
        version: machine.header.version.as_deref(),
        root: state(&machine.root),
    };
    Ok(serde_json::to_string_pretty(&document)? + "\n")
}

#[derive(Serialize)]
struct Machine<'m> {
    creation_time: &'m str,
    version: Option<&'m str>,
    root: ShownState<'m>,
}

#[derive(Serialize)]
struct ShownState<'m> {
    id: &'m str,
    name: &'m str,
    kind: String,
    description: Option<&'m str>,
    outcomes: Vec<Outcome<'m>>,
    inputs: Vec<Port<'m>>,
    outputs: Vec<Port<'m>>,
    #[serde(flatten)]
    content: Content<'m>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Content<'m> {
    Script {
        script: Option<&'m str>,
    },
    Container {
        scoped_variables: Vec<Port<'m>>,
        transitions: Vec<Transition<'m>>,
        data_flows: Vec<DataFlow<'m>>,
        states: Vec<ShownState<'m>>,
    },
    Library {
        library: Library<'m>,
    },
}

#[derive(Serialize)]
struct Outcome<'m> {
    id: i64,
    name: &'m str,
}

#[derive(Serialize)]
struct Port<'m> {
    id: i64,
    name: &'m str,
    #[serde(rename = "type")]
    data_type: String,
    default: Value,
}

/// A transition with the fields of its file (also a faulty one), and a flag for transitions out of the container.
#[derive(Serialize)]
struct Transition<'m> {
    id: i64,
    from_state: Option<&'m str>,
    from_outcome: Option<i64>,
    to_state: Option<&'m str>,
    to_outcome: Option<i64>,
    leads_out: bool,
}

#[derive(Serialize)]
struct DataFlow<'m> {
    id: i64,
    from_state: &'m str,
    from_port: i64,
    to_state: &'m str,
    to_port: i64,
}

#[derive(Serialize)]
struct Library<'m> {
    path: &'m str,
    name: &'m str,
    version: Option<&'m str>,
    found: bool,
}

fn state(state: &model::State) -> ShownState<'_> {
    ShownState {
        id: state.id.as_str(),
        name: &state.name,
        kind: state.kind.name().to_string(),
        description: state.description.as_deref(),
        outcomes: state.outcomes.iter().map(|o| Outcome { id: o.id.0, name: &o.name }).collect(),
        inputs: ports(&state.inputs),
        outputs: ports(&state.outputs),
        content: content(state),
    }
}

fn content(state: &model::State) -> Content<'_> {
    match &state.kind {
        Kind::Execution(script) | Kind::Decider(script) => {
            Content::Script { script: script.text.as_deref() }
        }
        Kind::Hierarchy(inside) | Kind::Barrier(inside) | Kind::Preemptive(inside) => {
            Content::Container {
                scoped_variables: ports(&inside.scoped_variables),
                transitions: inside.transitions.iter().map(|t| transition(t, &state.id)).collect(),
                data_flows: inside.data_flows.iter().map(data_flow).collect(),
                states: inside.states.values().map(|child| self::state(child)).collect(),
            }
        }
        Kind::Library(library) => Content::Library {
            library: Library {
                path: &library.path,
                name: &library.name,
                version: library.version.as_deref(),
                found: matches!(library.content, LibraryContent::Found(_)),
            },
        },
    }
}

fn ports(ports: &model::Ports) -> Vec<Port<'_>> {
    ports.iter().map(port).collect()
}

fn port(port: &model::Port) -> Port<'_> {
    Port {
        id: port.id.0,
        name: &port.name,
        data_type: port.data_type.short_name().to_string(),
        default: value(&port.default.to_json()),
    }
}

fn transition<'m>(transition: &'m model::Transition, container: &StateId) -> Transition<'m> {
    Transition {
        id: transition.id.0,
        from_state: transition.from_state.as_ref().map(StateId::as_str),
        from_outcome: transition.from_outcome.map(|outcome| outcome.0),
        to_state: transition.to_state.as_ref().map(StateId::as_str),
        to_outcome: transition.to_outcome.map(|outcome| outcome.0),
        leads_out: matches!(transition.target(container), Some(Target::Outcome(_))),
    }
}

fn data_flow(flow: &model::DataFlow) -> DataFlow<'_> {
    DataFlow {
        id: flow.id.0,
        from_state: flow.from_state.as_str(),
        from_port: flow.from_port.0,
        to_state: flow.to_state.as_str(),
        to_port: flow.to_port.0,
    }
}

fn value(json: &Json) -> Value {
    match json {
        Json::Null => Value::Null,
        Json::Bool(truth) => (*truth).into(),
        Json::Int(number) => (*number).into(),
        Json::BigInt(digits) => digits.as_str().into(),
        Json::Float(number) if number.is_finite() => (*number).into(),
        Json::Float(number) => number.to_string().into(),
        Json::Str(text) => text.as_str().into(),
        Json::List(items) => items.iter().map(value).collect(),
        Json::Object(members) => {
            members.iter().map(|(key, member)| (key.to_string(), value(member))).collect()
        }
    }
}
