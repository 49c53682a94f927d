//! Decodes a `core_data.json`: one document in, one state without children out. Supports the keys and classes of every version,
//! from any source.

use super::elements::{self, UnmodelledContent};
use super::library_state;
use super::state_files::document;
use crate::problem::{Fault, Wrong};
use rafcon_model::port::Extra;
use rafcon_model::{
    Container, DECIDER_ID, DataFlows, Json, Kind, Layout, Outcome, OutcomeId, Outcomes, Ports,
    Script, State, StateId, States, Transitions, json,
};
use smol_str::{SmolStr, ToSmolStr as _};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Keys of every state that has its own ports.
const COMMON: [&str; 8] = [
    "__jsonqualname__",
    "name",
    "state_id",
    "description",
    "income",
    "outcomes",
    "input_data_ports",
    "output_data_ports",
];
/// Further keys of hierarchies and concurrency states.
const CONTAINER: [&str; 3] = ["scoped_variables", "transitions", "data_flows"];

/// Decodes documents, and shares repeated parts.
#[derive(Debug, Default)]
pub(crate) struct Decoder {
    pub(crate) interner: Interner,
    pub(crate) faults: Vec<Fault>,
}

/// The state in the text of a `core_data.json`, without children, script, notes and layout, and its faults.
/// Without an id in the text, `folder`, the folder's name, gives the id. `Err` if the text describes no state.
pub fn state_from_core_data(text: &str, folder: &str) -> Result<(State, Vec<Fault>), Fault> {
    let document = document(text)?;
    let mut decoder = Decoder::default();
    let state = decoder.state(&document, folder)?;
    Ok((state, decoder.faults))
}

impl Decoder {
    /// The state that `document` describes; `Err` if it describes none. Without an id, `folder` gives the id.
    pub(crate) fn state(&mut self, document: &Json, folder: &str) -> Result<State, Fault> {
        let members = document.as_object();
        let members = members.ok_or_else(|| Fault::Wrong(Wrong::NotAnObject(document.kind())))?;
        let class = elements::text(document, "__jsonqualname__").map_err(Fault::Wrong)?;
        let short = class.rsplit('.').next().unwrap_or_default();
        let id = self.required_text(document, "state_id");
        let id = id.map_or_else(|| id_from_folder(folder), StateId);
        let name = self.required_text(document, "name").unwrap_or_else(|| id.0.clone());
        let mut aside = UnmodelledContent::default();
        let kind = self.kind(document, short, &mut aside);
        let kind = kind.ok_or_else(|| Fault::UnknownClass(class.clone()))?;
        let mut state = State {
            id,
            name,
            description: self.description(document),
            outcomes: self.outcomes(document, &mut aside),
            inputs: Ports::default(),
            outputs: Ports::default(),
            semantic_data: None,
            layout: Layout::default(),
            kind,
            extra: None,
            damage: None,
        };
        let known: &[&str] = match &state.kind {
            Kind::Library(_) => &library_state::KEYS,
            Kind::Hierarchy(_) | Kind::Barrier(_) | Kind::Preemptive(_) => &CONTAINER,
            Kind::Execution(_) | Kind::Decider(_) => &[],
        };
        if !matches!(state.kind, Kind::Library(_)) {
            state.inputs = self.ports(document, "input_data_ports", &mut aside);
            state.outputs = self.ports(document, "output_data_ports", &mut aside);
        }
        let is_known = |key: &str| COMMON.contains(&key) || known.contains(&key);
        state.extra = aside.into_extra(members, is_known);
        keep_income(document, &mut state.extra);
        Ok(state)
    }

    fn kind(
        &mut self,
        document: &Json,
        class: &str,
        aside: &mut UnmodelledContent,
    ) -> Option<Kind> {
        Some(match class {
            "ExecutionState" => Kind::Execution(Script::default()),
            "DeciderState" => Kind::Decider(Script::default()),
            "HierarchyState" => Kind::Hierarchy(self.container(document, aside)),
            "BarrierConcurrencyState" => Kind::Barrier(self.container(document, aside)),
            "PreemptiveConcurrencyState" => Kind::Preemptive(self.container(document, aside)),
            "LibraryState" => Kind::Library(library_state::decode(self, document, aside)),
            _ => return None,
        })
    }

    fn container(&mut self, document: &Json, aside: &mut UnmodelledContent) -> Container {
        let mut transitions = Transitions::default();
        for transition in self.map(document, "transitions", aside, elements::transition) {
            transitions.insert(transition);
        }
        let mut data_flows = DataFlows::default();
        for flow in self.map(document, "data_flows", aside, elements::data_flow) {
            data_flows.insert(flow);
        }
        let scoped_variables = self.ports(document, "scoped_variables", aside);
        Container { states: States::default(), transitions, data_flows, scoped_variables }
    }

    fn outcomes(&mut self, document: &Json, aside: &mut UnmodelledContent) -> Outcomes {
        let found = self.map(document, "outcomes", aside, elements::outcome);
        let mut outcomes: Outcomes = found.into_iter().collect();
        for (id, name) in [(OutcomeId::ABORTED, "aborted"), (OutcomeId::PREEMPTED, "preempted")] {
            if outcomes.get(id).is_none() {
                outcomes.insert(Outcome::new(id, name));
            }
        }
        self.interner.outcomes(outcomes)
    }

    pub(crate) fn ports(
        &mut self,
        document: &Json,
        key: &'static str,
        aside: &mut UnmodelledContent,
    ) -> Ports {
        self.map(document, key, aside, elements::port).into_iter().collect()
    }

    /// The elements of the map at `key`. Reports one that cannot be decoded, and keeps it for the next save.
    pub(crate) fn map<T>(
        &mut self,
        document: &Json,
        key: &'static str,
        aside: &mut UnmodelledContent,
        element: impl Fn(i64, &Json) -> Result<T, Wrong>,
    ) -> Vec<T> {
        let Some(map) = document.get(key) else {
            self.faults.push(Fault::Wrong(Wrong::Missing(key)));
            return Vec::new();
        };
        let Some(members) = map.as_object() else {
            self.faults.push(wrong_type(key, "an object", map));
            aside.whole(key, map);
            return Vec::new();
        };
        let mut ids = elements::Ids::new(members.len());
        let mut found = Vec::with_capacity(members.len());
        // If two keys denote one id, the key in canonical form counts, at any position.
        let is_plain = |text: &str| json::canonical_int(text).is_some();
        let plain = members.iter().filter(|(text, _)| is_plain(text));
        let odd = members.iter().filter(|(text, _)| !is_plain(text));
        for (text, value) in plain.chain(odd) {
            match ids.read(text, value).and_then(|id| Ok((id, element(id, value)?))) {
                Ok((id, element)) => {
                    found.push(element);
                    if let Some(inside) = elements::other_id(id, value) {
                        self.element_fault(key, text, Wrong::OtherId(inside));
                    }
                }
                Err(wrong) => {
                    self.element_fault(key, text, wrong);
                    aside.member(key, text, value);
                }
            }
        }
        found
    }

    fn element_fault(&mut self, key: &str, text: &str, wrong: Wrong) {
        self.faults
            .push(Fault::Element { element: smol_str::format_smolstr!("{key}.{text}"), wrong });
    }

    /// The text at `key`; a number counts as its digits, as in the reference.
    pub(crate) fn required_text(&mut self, document: &Json, key: &'static str) -> Option<SmolStr> {
        match document.get(key) {
            Some(Json::Str(text)) => Some(text.clone()),
            Some(Json::Int(number)) => Some(number.to_smolstr()),
            Some(other) => {
                self.faults.push(wrong_type(key, "a string", other));
                None
            }
            None => {
                self.faults.push(Fault::Wrong(Wrong::Missing(key)));
                None
            }
        }
    }

    fn description(&mut self, document: &Json) -> Option<Arc<str>> {
        match document.get("description") {
            Some(Json::Str(text)) if !text.is_empty() => Some(self.interner.text(text)),
            Some(Json::Str(_) | Json::Null) | None => None,
            Some(other) => {
                self.faults.push(wrong_type("description", "a string", other));
                None
            }
        }
    }
}

/// Replaces a state whose file cannot be read. It has the id from the folder's name, so that
/// transitions to it stay valid.
pub(crate) fn stand_in(folder: &str, has_script: bool) -> State {
    let id = id_from_folder(folder);
    let kind = if has_script {
        Kind::Execution(Script::default())
    } else {
        Kind::Hierarchy(Container::default())
    };
    let name =
        folder.strip_suffix(id.as_str()).map(|name| name.strip_suffix(['_', '$']).unwrap_or(name));
    let name = name.filter(|name| !name.is_empty()).unwrap_or(id.as_str()).to_owned();
    State::new(id, name, kind)
}

/// `name_ID`, `name$ID` or `ID`.
fn id_from_folder(folder: &str) -> StateId {
    if folder.ends_with(DECIDER_ID) {
        return StateId::new(DECIDER_ID);
    }
    let id = folder.rsplit(['_', '$']).next().filter(|id| !id.is_empty());
    StateId::new(id.unwrap_or("UNREAD"))
}

pub(crate) fn wrong_type(key: &'static str, expected: &'static str, found: &Json) -> Fault {
    Fault::Wrong(Wrong::Type { key, expected, found: found.kind() })
}

/// An income has no content; unknown keys are kept.
fn keep_income(document: &Json, extra: &mut Extra) {
    let Some(members) = document.get("income").and_then(Json::as_object) else { return };
    let unknown: Vec<_> =
        members.iter().filter(|(key, _)| key != "__jsonqualname__").cloned().collect();
    if !unknown.is_empty() {
        let extra = extra.get_or_insert_with(|| Box::new(Json::object()));
        extra.set("income", Json::Object(unknown));
    }
}

/// The maximum number of shared lists of outcomes.
const LISTS: usize = 16;

/// The shared copies of one reader thread.
#[derive(Debug, Default)]
pub(crate) struct Interner {
    texts: BTreeSet<Arc<str>>,
    outcomes: Vec<Outcomes>,
}

impl Interner {
    /// The shared copy of `text`.
    pub(crate) fn text(&mut self, text: &str) -> Arc<str> {
        if let Some(shared) = self.texts.get(text) {
            return Arc::clone(shared);
        }
        let shared: Arc<str> = text.into();
        self.texts.insert(Arc::clone(&shared));
        shared
    }

    /// The shared copy of `outcomes`.
    pub(crate) fn outcomes(&mut self, outcomes: Outcomes) -> Outcomes {
        if let Some(shared) = self.outcomes.iter().find(|shared| **shared == outcomes) {
            return shared.clone();
        }
        if self.outcomes.len() < LISTS {
            self.outcomes.push(outcomes.clone());
        }
        outcomes
    }
}
