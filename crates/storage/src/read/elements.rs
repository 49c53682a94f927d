//! Decodes outcomes, ports, transitions and data flows of a document. Supports their keys in every version.

use crate::problem::Wrong;
use rafcon_model::port::Extra;
use rafcon_model::{
    DataFlow, DataFlowId, DataType, Json, Outcome, OutcomeId, Port, PortId, StateId, Transition,
    TransitionId, Value,
};
use smol_str::{SmolStr, ToSmolStr as _};

/// Content of a document that the model cannot hold; kept, and merged into the document when it is written.
#[derive(Debug, Default)]
pub(crate) struct UnmodelledContent(Vec<(SmolStr, Json)>);

impl UnmodelledContent {
    /// Keeps the whole value of a known key.
    pub(crate) fn whole(&mut self, key: &str, value: &Json) {
        self.0.push((key.into(), value.clone()));
    }

    /// Keeps one member of the map at `key`.
    pub(crate) fn member(&mut self, key: &str, member: &str, value: &Json) {
        let index = self.0.iter().position(|(k, _)| k == key).unwrap_or_else(|| {
            self.0.push((key.into(), Json::object()));
            self.0.len() - 1
        });
        self.0[index].1.set(member, value.clone());
    }

    /// All kept content, and every member with an unknown key.
    pub(crate) fn into_extra(
        mut self,
        members: &[(SmolStr, Json)],
        is_known: impl Fn(&str) -> bool,
    ) -> Extra {
        self.0.extend(members.iter().filter(|(key, _)| !is_known(key)).cloned());
        self.0.sort_by(|a, b| a.0.cmp(&b.0));
        (!self.0.is_empty()).then(|| Box::new(Json::Object(self.0)))
    }
}

/// The ids of one map.
#[derive(Debug)]
pub(crate) struct Ids(Vec<i64>);

/// The keys under which an element repeats its id.
const ID_KEYS: [&str; 5] =
    ["outcome_id", "data_port_id", "scoped_variable_id", "transition_id", "data_flow_id"];

impl Ids {
    pub(crate) fn new(expected: usize) -> Self {
        Self(Vec::with_capacity(expected))
    }

    /// The id in a key, as Python's `int` reads it.
    pub(crate) fn read(&mut self, key: &str, value: &Json) -> Result<i64, Wrong> {
        let id = key.trim().parse().map_err(|_not_a_number: std::num::ParseIntError| Wrong::Key)?;
        if value.as_object().is_none() {
            return Err(Wrong::NotAnObject(value.kind()));
        }
        match self.0.binary_search(&id) {
            Ok(_) => Err(Wrong::Twice),
            Err(index) => {
                self.0.insert(index, id);
                Ok(id)
            }
        }
    }
}

/// The id in an element, if it differs from `key`.
pub(crate) fn other_id(key: i64, value: &Json) -> Option<i64> {
    let inside = ID_KEYS.iter().find_map(|id_key| value.get(id_key)?.as_int())?;
    (inside != key).then_some(inside)
}

/// The outcome with this id.
pub(crate) fn outcome(id: i64, json: &Json) -> Result<Outcome, Wrong> {
    let name = text(json, "name")?;
    let extra = unknown(json, &["__jsonqualname__", "name", "outcome_id"]);
    Ok(Outcome { id: OutcomeId(id), name, extra })
}

/// The port or scoped variable with this id.
pub(crate) fn port(id: i64, json: &Json) -> Result<Port, Wrong> {
    const KEYS: [&str; 6] = [
        "__jsonqualname__",
        "name",
        "data_port_id",
        "scoped_variable_id",
        "data_type",
        "default_value",
    ];
    Ok(Port {
        id: PortId(id),
        name: text(json, "name")?,
        data_type: data_type(json)?,
        default: json.get("default_value").map_or(Value::None, Value::from_json),
        extra: unknown(json, &KEYS),
    })
}

fn data_type(json: &Json) -> Result<DataType, Wrong> {
    let found = json.get("data_type").ok_or(Wrong::Missing("data_type"))?;
    match (found, found.get("__type__")) {
        (_, Some(Json::Str(name))) | (Json::Str(name), None) => Ok(DataType::from_file(name)),
        (Json::Null, None) => Ok(DataType::None),
        _ => Err(Wrong::Type { key: "data_type", expected: "a type", found: found.kind() }),
    }
}

/// The transition with this id.
pub(crate) fn transition(id: i64, json: &Json) -> Result<Transition, Wrong> {
    const KEYS: [&str; 6] = [
        "__jsonqualname__",
        "transition_id",
        "from_state",
        "from_outcome",
        "to_state",
        "to_outcome",
    ];
    Ok(Transition {
        id: TransitionId(id),
        from_state: optional(json, "from_state", text)?.map(StateId),
        from_outcome: optional(json, "from_outcome", number)?.map(OutcomeId),
        to_state: optional(json, "to_state", text)?.map(StateId),
        to_outcome: optional(json, "to_outcome", number)?.map(OutcomeId),
        extra: unknown(json, &KEYS),
    })
}

/// The data flow with this id.
pub(crate) fn data_flow(id: i64, json: &Json) -> Result<DataFlow, Wrong> {
    const KEYS: [&str; 6] =
        ["__jsonqualname__", "data_flow_id", "from_state", "from_key", "to_state", "to_key"];
    Ok(DataFlow {
        id: DataFlowId(id),
        from_state: StateId(text(json, "from_state")?),
        from_port: PortId(number(json, "from_key")?),
        to_state: StateId(text(json, "to_state")?),
        to_port: PortId(number(json, "to_key")?),
        extra: unknown(json, &KEYS),
    })
}

/// The text at `key`; a number counts as its digits.
pub(crate) fn text(json: &Json, key: &'static str) -> Result<SmolStr, Wrong> {
    match json.get(key) {
        Some(Json::Str(text)) => Ok(text.clone()),
        Some(Json::Int(number)) => Ok(number.to_smolstr()),
        other => Err(missing_or_wrong(key, "a string", other)),
    }
}

fn number(json: &Json, key: &'static str) -> Result<i64, Wrong> {
    match json.get(key) {
        Some(Json::Int(number)) => Ok(*number),
        other => Err(missing_or_wrong(key, "an integer", other)),
    }
}

fn optional<T>(
    json: &Json,
    key: &'static str,
    read: impl Fn(&Json, &'static str) -> Result<T, Wrong>,
) -> Result<Option<T>, Wrong> {
    match json.get(key) {
        Some(Json::Null) | None => Ok(None),
        Some(_) => read(json, key).map(Some),
    }
}

fn missing_or_wrong(key: &'static str, expected: &'static str, found: Option<&Json>) -> Wrong {
    match found {
        None => Wrong::Missing(key),
        Some(found) => Wrong::Type { key, expected, found: found.kind() },
    }
}

/// The members that are none of `known`.
fn unknown(json: &Json, known: &[&str]) -> Extra {
    UnmodelledContent::default().into_extra(json.as_object()?, |key| known.contains(&key))
}
