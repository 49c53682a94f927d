//! Random machines, valid or not. Objects have sorted keys, since that is how they are written.

use proptest::collection::{btree_map, vec};
use proptest::prelude::*;
use rafcon_model::{
    Container, DECIDER_ID, DataFlow, DataFlowId, DataType, Header, Json, Kind, Layout, Library,
    LibraryContent, Machine, Origin, Outcome, OutcomeId, Port, PortId, Ports, RuntimeValue,
    RuntimeValues, Script, State, StateId, Target, Transition, TransitionId, Value, notation,
};
use smol_str::{SmolStr, format_smolstr};
use std::fmt;
use std::sync::Arc;

const KEY: &str = "[a-z]{1,4}";

/// A machine that a failing test shows in the notation.
#[derive(Clone)]
pub(crate) struct Shown(pub(crate) Machine);

impl fmt::Debug for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&notation::print(&self.0))
    }
}

/// A machine of a few dozen states.
pub(crate) fn machine() -> impl Strategy<Value = Shown> {
    (state(3), text(), proptest::option::of("[0-9.]{1,5}"), layout()).prop_map(
        |(root, time, version, layout)| {
            let header = Header {
                creation_time: time,
                version: version.map(SmolStr::from),
                used_rafcon_version: Some("2.5.2".into()),
                layout,
                extra: None,
            };
            Shown(Machine { header, root: Arc::new(renamed(root, "ROOTID")) })
        },
    )
}

fn text() -> impl Strategy<Value = SmolStr> {
    prop_oneof!["[ -~]{1,12}", "\\PC{1,6}", "[a-z]{300}"].prop_map(SmolStr::from)
}

fn renamed(state: State, id: &str) -> State {
    State { id: StateId::new(id), ..state }
}

fn state(depth: u32) -> BoxedStrategy<State> {
    let parts = (text(), proptest::option::of(text()), ports(0), ports(10), layout(), semantic());
    let outcomes = vec(text(), 0..3);
    (parts, outcomes, kind(depth), proptest::option::of(object()))
        .prop_map(
            |((name, description, inputs, outputs, layout, semantic), outcomes, kind, extra)| {
                let mut state = State::new(StateId::new("X"), name, kind);
                state.description = description.map(|text| text.as_str().into());
                for (id, name) in (0..).zip(outcomes) {
                    state.outcomes.insert(Outcome::new(OutcomeId(id), name));
                }
                state.layout = layout;
                state.semantic_data = semantic;
                state.extra =
                    extra.map(|members| Box::new(Json::Object(vec![("unknown".into(), members)])));
                (state.inputs, state.outputs) = (inputs, outputs);
                if let Kind::Library(library) = &state.kind {
                    state.inputs = known_ports("input", &library.inputs);
                    state.outputs = known_ports("output", &library.outputs);
                }
                state
            },
        )
        .boxed()
}

fn kind(depth: u32) -> BoxedStrategy<Kind> {
    let script = proptest::option::of("[a-z =\n\"é]{0,20}");
    let script = script.prop_map(|text| Script { text: text.map(|text| text.as_str().into()) });
    let leaf =
        prop_oneof![script.clone().prop_map(Kind::Execution), library().prop_map(Kind::Library)];
    if depth == 0 {
        return leaf.boxed();
    }
    prop_oneof![
        leaf,
        container(depth, false).prop_map(Kind::Hierarchy),
        container(depth, true).prop_map(Kind::Barrier),
        container(depth, false).prop_map(Kind::Preemptive),
    ]
    .boxed()
}

fn container(depth: u32, with_decider: bool) -> impl Strategy<Value = Container> {
    let lines = vec((0..5_usize, 0..3_i64, 0..5_usize, 0..12_i64), 0..5);
    (vec(state(depth - 1), 0..4), lines, ports(20)).prop_map(move |(children, lines, variables)| {
        let mut inside = Container { scoped_variables: variables, ..Container::default() };
        let mut ids = vec![StateId::new("nowhere")];
        for (index, child) in children.into_iter().enumerate() {
            let id = format_smolstr!("LEVEL{depth}_{index}");
            ids.push(StateId(id.clone()));
            inside.states.insert(StateId(id.clone()), Arc::new(renamed(child, &id)));
        }
        if with_decider {
            let decider = Kind::Decider(Script { text: Some("x".into()) });
            let decider = State::new(DECIDER_ID.into(), "Decider", decider);
            inside.states.insert(decider.id.clone(), Arc::new(decider));
        }
        for (number, (from, outcome, to, port)) in (1..).zip(lines) {
            let (from, to) = (&ids[from % ids.len()], &ids[to % ids.len()]);
            let origin = Origin::Outcome(from.clone(), OutcomeId(outcome));
            let target = Target::State(to.clone());
            let line = Transition::new(TransitionId(number), origin, target, &StateId::new("X"));
            inside.transitions.insert(line);
            // Flows to and from library states would give them ports.
            let far = StateId::new("far");
            let ends = ((far.clone(), PortId(port)), (far, PortId(outcome)));
            inside.data_flows.insert(DataFlow::new(DataFlowId(number), ends.0, ends.1));
        }
        inside
    })
}

fn library() -> impl Strategy<Value = Library> {
    (runtime_values(), runtime_values(), KEY, proptest::option::of("[0-9]{1,3}")).prop_map(
        |(inputs, outputs, name, version)| Library {
            path: "lib".into(),
            name: name.into(),
            version: version.map(SmolStr::from),
            inputs,
            outputs,
            content: LibraryContent::Missing { reason: "no library root is named `lib`".into() },
        },
    )
}

fn runtime_values() -> impl Strategy<Value = RuntimeValues> {
    let values = vec((value(), any::<bool>()), 0..3);
    values.prop_map(|values| {
        let value = |(value, used)| RuntimeValue { value, used };
        (0..).map(PortId).zip(values.into_iter().map(value)).collect()
    })
}

/// The ports that a missing library has.
fn known_ports(side: &str, values: &RuntimeValues) -> Ports {
    let port = |(id, value): (&PortId, &RuntimeValue)| {
        Port::new(*id, format!("{side}_{id}"), DataType::Object, value.value.clone())
    };
    values.iter().map(port).collect()
}

fn ports(first: i64) -> impl Strategy<Value = Ports> {
    let types = prop_oneof![
        Just(DataType::Int),
        Just(DataType::None),
        Just(DataType::Object),
        Just(DataType::Named("numpy.ndarray".into())),
        Just(DataType::Named("builtins.bytes".into())),
    ];
    vec((text(), types, value()), 0..3).prop_map(move |ports| {
        let port =
            |(id, (name, data_type, default))| Port::new(PortId(id), name, data_type, default);
        (first..).zip(ports).map(port).collect()
    })
}

fn value() -> impl Strategy<Value = Value> {
    let float = any::<f64>().prop_filter("equal to itself", |number| !number.is_nan());
    let leaf = prop_oneof![
        Just(Value::None),
        any::<bool>().prop_map(Value::Bool),
        any::<i64>().prop_map(Value::Int),
        float.prop_map(Value::Float),
        text().prop_map(|text| Value::str(&text)),
        Just(Value::BigInt("123456789012345678901234567890".into())),
        Just(Value::Type("builtins.float".into())),
    ];
    leaf.prop_recursive(2, 8, 3, |inner| {
        prop_oneof![
            vec(inner.clone(), 0..3).prop_map(|items| Value::List(items.into())),
            vec(inner.clone(), 0..3).prop_map(|items| Value::Tuple(items.into())),
            btree_map(KEY, inner, 0..3).prop_map(|items| {
                Value::Dict(
                    items.into_iter().map(|(key, value)| (Value::str(&key), value)).collect(),
                )
            }),
        ]
    })
}

fn object() -> impl Strategy<Value = Json> {
    let members = btree_map(KEY, text(), 1..3);
    members.prop_map(|members| {
        let member = |(key, text): (String, SmolStr)| (key.into(), Json::Str(text));
        Json::Object(members.into_iter().map(member).collect())
    })
}

fn layout() -> impl Strategy<Value = Layout> {
    proptest::option::of(object())
        .prop_map(|object| object.map_or_else(Layout::default, |json| Layout::from_json(&json)))
}

fn semantic() -> impl Strategy<Value = Option<Arc<Json>>> {
    proptest::option::of(object().prop_map(Arc::new))
}
