//! A rover that plans its own mission: it observes, plans, and replans when a step fails. Knows the model, and the ports of
//! the libraries `examples/rover/observe` and `planning/replan`.

use super::mission::layout;
use super::{Template, TemplateRequest, empty};
use rafcon_model::{
    DataFlow, DataFlowId, DataType, Kind, Library, LibraryContent, Origin, Outcome, OutcomeId,
    Port, PortId, RuntimeValue, State, StateId, Target, Transition, TransitionId, Value,
};
use std::sync::Arc;

pub(super) const TEMPLATE: Template = Template {
    name: "rover",
    about: "a rover that plans its mission, and again when a step fails; needs an engine (docs/guide/planning.md)",
    sized: false,
    libraries: &[("examples", "examples/libraries"), ("planning", "libraries/planning")],
    build: |wish| Ok(root(wish)),
};

const GOAL: &str = "(assembled battery mug)";
/// Ports of the library `planning/replan`.
const FACTS: PortId = PortId(0);
const POOL: PortId = PortId(1);
const WANTED: PortId = PortId(2);
const TRIED: PortId = PortId(11);
const TRIED_NOW: PortId = PortId(12);
/// The output of `examples/rover/observe`.
const SEEN: PortId = PortId(0);
/// The variable with the plans tried.
const PLANS: PortId = PortId(0);

fn root(wish: &TemplateRequest) -> State {
    let mut root = empty::root(wish);
    root.layout = layout::entry((0.0, 0.0), (620.0, 400.0), true);
    let id = root.id.clone();
    let mut observe = library("OBSERV", "Observe", "examples/rover", "observe", &[]);
    let pool = Value::List([Value::str("examples/rover")].into());
    let inputs = [(POOL, pool), (WANTED, Value::str(GOAL))];
    let mut again = library("REPLAN", "Plan again", "planning", "replan", &inputs);
    // Positions next to the steps of a plan.
    observe.layout = layout::entry((50.0, 60.0), (120.0, 72.0), false);
    again.layout = layout::entry((250.0, 60.0), (120.0, 72.0), false);
    let Some(inside) = root.container_mut() else { return root };
    let at = |state: &State, outcome| Origin::Outcome(state.id.clone(), OutcomeId(outcome));
    let (success, aborted) = (Target::Outcome(OutcomeId(0)), Target::Outcome(OutcomeId::ABORTED));
    let lines = [
        (Origin::Income, Target::State(observe.id.clone())),
        (at(&observe, 0), Target::State(again.id.clone())),
        (at(&observe, -1), aborted.clone()),
        // The first step of the first plan follows here later.
        (at(&again, 0), success.clone()),
        (at(&again, 1), success),
        (at(&again, 2), aborted.clone()),
        (at(&again, -1), aborted),
    ];
    for (number, (from, to)) in (1..).zip(lines) {
        inside.transitions.insert(Transition::new(TransitionId(number), from, to, &id));
    }
    let flows = [
        ((observe.id.clone(), SEEN), (again.id.clone(), FACTS)),
        ((id.clone(), PLANS), (again.id.clone(), TRIED)),
        ((again.id.clone(), TRIED_NOW), (id, PLANS)),
    ];
    for (number, (from, to)) in (1..).zip(flows) {
        inside.data_flows.insert(DataFlow::new(DataFlowId(number), from, to));
    }
    let plans = Port::new(PLANS, "plans", DataType::List, Value::List([].into()));
    inside.scoped_variables.insert(plans);
    inside.states.extend([observe, again].map(|state| (state.id.clone(), Arc::new(state))));
    root
}

fn library(id: &str, name: &str, path: &str, library: &str, inputs: &[(PortId, Value)]) -> State {
    let given = |(port, value): &(PortId, Value)| {
        (*port, RuntimeValue { value: value.clone(), used: true })
    };
    let kind = Kind::Library(Library {
        path: path.into(),
        name: library.into(),
        version: None,
        inputs: inputs.iter().map(given).collect(),
        outputs: std::collections::BTreeMap::default(),
        content: LibraryContent::Missing { reason: "it is read with the machine".into() },
    });
    let mut state = State::new(StateId::new(id), name, kind);
    state.outcomes.insert(Outcome::new(OutcomeId(0), "success"));
    state
}
