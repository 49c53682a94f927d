//! Two states that pass a value: the first machine for a reader to run. Knows the model only.

use super::{Template, TemplateRequest, empty};
use rafcon_model::{
    DataFlow, DataFlowId, DataType, Kind, Origin, Outcome, OutcomeId, Port, PortId, Script, State,
    StateId, Target, Transition, TransitionId, Value,
};
use std::sync::Arc;

pub(super) const TEMPLATE: Template = Template {
    name: "hello",
    about: "two states: one makes a greeting, the other logs it",
    sized: false,
    libraries: &[],
    build: |wish| Ok(root(wish)),
};

const GREET: &str = r#"def execute(self, inputs, outputs, gvm):
    outputs["greeting"] = "Hello, " + inputs["name"] + "!"
    return "success"
"#;

const SAY: &str = r#"def execute(self, inputs, outputs, gvm):
    self.logger.info(inputs["greeting"])
    return "success"
"#;

fn root(wish: &TemplateRequest) -> State {
    let mut root = empty::root(wish);
    root.inputs.insert(text_port(0, "name", "World"));
    let id = root.id.clone();
    if let Some(inside) = root.container_mut() {
        let (greet, say) = (greet(), say());
        let lines = [
            (Origin::Income, Target::State(greet.id.clone())),
            (Origin::Outcome(greet.id.clone(), OutcomeId(0)), Target::State(say.id.clone())),
            (Origin::Outcome(say.id.clone(), OutcomeId(0)), Target::Outcome(OutcomeId(0))),
        ];
        for (number, (from, to)) in (1..).zip(lines) {
            inside.transitions.insert(Transition::new(TransitionId(number), from, to, &id));
        }
        let name = ((id, PortId(0)), (greet.id.clone(), PortId(0)));
        let greeting = ((greet.id.clone(), PortId(1)), (say.id.clone(), PortId(0)));
        for (number, (from, to)) in (1..).zip([name, greeting]) {
            inside.data_flows.insert(DataFlow::new(DataFlowId(number), from, to));
        }
        inside.states.extend([greet, say].map(|state| (state.id.clone(), Arc::new(state))));
    }
    root
}

fn greet() -> State {
    let mut state = script("GREETS", "Greet", GREET);
    state.inputs.insert(text_port(0, "name", "World"));
    state.outputs.insert(text_port(1, "greeting", ""));
    state
}

fn say() -> State {
    let mut state = script("SAYING", "Say", SAY);
    state.inputs.insert(text_port(0, "greeting", ""));
    state
}

fn script(id: &str, name: &str, text: &str) -> State {
    let kind = Kind::Execution(Script { text: Some(text.into()) });
    let mut state = State::new(StateId::new(id), name, kind);
    state.outcomes.insert(Outcome::new(OutcomeId(0), "success"));
    state
}

fn text_port(id: i64, name: &str, default: &str) -> Port {
    Port::new(PortId(id), name, DataType::Str, Value::str(default))
}
