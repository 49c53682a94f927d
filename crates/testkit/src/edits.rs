//! Edits of a machine chosen by numbers, legal and illegal: for tests of the model and of the crates that forward edits.
//! Deterministic: equal numbers give equal edits.

use rafcon_model::edit::{
    ChildrenEdit, DataFlowEdit, Edit, HeaderEdit, LayoutEdit, LayoutElement, OutcomeEdit, PortEdit,
    RuntimeValueEdit, StateEdit, TransitionEdit, copy,
};
use rafcon_model::{
    Container, DECIDER_ID, DataFlowId, DataType, Fresh, Json, Kind, KindName, Machine, Origin,
    Outcome, OutcomeId, Port, PortId, PortKind, Script, State, StateId, StatePath, Target,
    TransitionId, Value,
};
use smol_str::SmolStr;
use std::sync::Arc;

/// Numbers that determine choices.
#[derive(Debug, Clone)]
pub struct Dice {
    numbers: std::vec::IntoIter<u16>,
}

impl Dice {
    /// Choices from these numbers; after the last one every number is 0.
    pub fn new(numbers: Vec<u16>) -> Self {
        Self { numbers: numbers.into_iter() }
    }

    /// True if all numbers are used up.
    pub fn is_empty(&self) -> bool {
        self.numbers.len() == 0
    }

    /// A number below `sides`.
    pub fn roll(&mut self, sides: usize) -> usize {
        usize::from(self.numbers.next().unwrap_or(0)).checked_rem(sides).unwrap_or(0)
    }

    fn pick<T: Clone>(&mut self, items: &[T]) -> Option<T> {
        let index = self.roll(items.len());
        items.get(index).cloned()
    }

    /// One of the items, of which there must be at least one.
    fn one<T: Clone, const N: usize>(&mut self, items: &[T; N]) -> T {
        items[self.roll(N)].clone()
    }

    fn some<T: Clone>(&mut self, items: &[T]) -> Vec<T> {
        items.iter().filter(|_| self.roll(2) == 0).cloned().collect()
    }

    fn small(&mut self, sides: u32) -> i64 {
        i64::try_from(self.roll(sides as usize)).unwrap_or(0)
    }
}

fn paths(machine: &Machine) -> Vec<StatePath> {
    let mut paths = vec![StatePath::root(machine.root.id.clone())];
    let mut next = 0;
    while let Some(path) = paths.get(next).cloned() {
        let inside = machine.state(&path).and_then(|state| state.container());
        let children = inside.into_iter().flat_map(|inside| inside.states.keys());
        paths.extend(children.map(|id| path.child(id.clone())));
        next += 1;
    }
    paths
}

fn any_path(machine: &Machine, dice: &mut Dice) -> StatePath {
    dice.pick(&paths(machine)).unwrap_or_default()
}

/// A random edit, legal or illegal.
pub fn edit(machine: &Machine, dice: &mut Dice) -> Edit {
    let path = any_path(machine, dice);
    let state = machine.state(&path).unwrap_or(&machine.root);
    match dice.roll(10) {
        0 => Edit::State(path, state_edit(dice)),
        1 => {
            let id = OutcomeId(dice.small(5) - 2);
            let edits = [
                OutcomeEdit::Add(name(dice)),
                OutcomeEdit::Rename(name(dice)),
                OutcomeEdit::Remove,
            ];
            Edit::Outcome(path, id, dice.one(&edits))
        }
        2 => {
            let kind = dice.one(&PortKind::ALL);
            let edit = port_edit(dice);
            Edit::Port(path, kind, PortId(dice.small(6)), edit)
        }
        3 => {
            let edit = transition_edit(state, dice);
            Edit::Transition(path, TransitionId(dice.small(6)), edit)
        }
        4 => {
            let edit = data_flow_edit(state, dice);
            Edit::DataFlow(path, DataFlowId(dice.small(6)), edit)
        }
        5 => layout_or_value(path, dice),
        6 if dice.roll(4) == 0 => Edit::Batch(vec![edit(machine, dice), edit(machine, dice)]),
        _ => Edit::Children(path, children_edit(machine, state, dice)),
    }
}

fn transition_edit(state: &State, dice: &mut Dice) -> TransitionEdit {
    let (from, to) = (origin(state, dice), target(state, dice));
    dice.one(&[
        TransitionEdit::Add { from: from.clone(), to: to.clone() },
        TransitionEdit::Add { from: from.clone(), to: to.clone() },
        TransitionEdit::SetOrigin(from),
        TransitionEdit::SetTarget(to),
        TransitionEdit::Remove,
    ])
}

fn data_flow_edit(state: &State, dice: &mut Dice) -> DataFlowEdit {
    let (from, to) = (flow_end(state, dice), flow_end(state, dice));
    dice.one(&[
        DataFlowEdit::Add { from: from.clone(), to: to.clone() },
        DataFlowEdit::Add { from: from.clone(), to: to.clone() },
        DataFlowEdit::SetSource(from),
        DataFlowEdit::SetTarget(to),
        DataFlowEdit::Remove,
    ])
}

fn layout_or_value(path: StatePath, dice: &mut Dice) -> Edit {
    let element = dice.one(&[
        LayoutElement::State,
        LayoutElement::Name,
        LayoutElement::Outcome(OutcomeId(0)),
        LayoutElement::Port(PortKind::Input, PortId(0)),
        LayoutElement::Transition(TransitionId(1)),
        LayoutElement::DataFlow(DataFlowId(1)),
    ]);
    let point = (f64::from(u16::try_from(dice.roll(9)).unwrap_or(0)), 0.5);
    let layout = dice.one(&[
        LayoutEdit::SetPosition(element, point),
        LayoutEdit::SetSize(element, point),
        LayoutEdit::SetWaypoints(element, vec![point, (1.5, 2.0)]),
    ]);
    let (kind, id) = (dice.one(&PortKind::ALL), PortId(dice.small(2)));
    let set = RuntimeValueEdit::Set(value(dice));
    let value = dice.one(&[set, RuntimeValueEdit::SetUsed(false), RuntimeValueEdit::Remove]);
    let version = Some("2".into()).filter(|_| dice.roll(2) == 0);
    dice.one(&[
        Edit::Layout(path.clone(), layout),
        Edit::RuntimeValue(path, kind, id, value),
        Edit::Header(HeaderEdit::SetVersion(version)),
    ])
}

fn name(dice: &mut Dice) -> SmolStr {
    dice.one(&["success", "x", "y", "", "a/b", "done"]).into()
}

fn value(dice: &mut Dice) -> Value {
    let tuple = Value::Tuple([Value::Float(1.0), Value::None].into());
    dice.one(&[Value::None, Value::Int(1), Value::str("2"), tuple])
}

fn state_edit(dice: &mut Dice) -> StateEdit {
    let kinds = [KindName::Execution, KindName::Hierarchy, KindName::Barrier, KindName::Preemptive];
    match dice.roll(6) {
        0 => StateEdit::SetName(name(dice)),
        1 => StateEdit::SetKind(dice.one(&kinds)),
        2 => StateEdit::SetScript(Some(name(dice).as_str().into())),
        3 => StateEdit::SetDescription(Some(name(dice).as_str().into())),
        4 => {
            let notes = Json::Object(vec![("a".into(), Json::Float(2.0))]);
            StateEdit::SetSemanticData(Some(Arc::new(notes)).filter(|_| dice.roll(3) > 0))
        }
        _ => StateEdit::SetId(fresh(dice)),
    }
}

fn port_edit(dice: &mut Dice) -> PortEdit {
    let data_type = dice.one(&[DataType::Int, DataType::Int, DataType::Str, DataType::Object]);
    let default = value(dice);
    match dice.roll(5) {
        0 => PortEdit::Rename(name(dice)),
        1 => PortEdit::SetType(data_type),
        2 => PortEdit::SetDefault(default),
        3 => PortEdit::Remove,
        _ => PortEdit::Add { name: name(dice), data_type, default },
    }
}

fn child_ids(state: &State) -> Vec<StateId> {
    state.container().map_or_else(Vec::new, |c| c.states.keys().cloned().collect())
}

fn origin(state: &State, dice: &mut Dice) -> Origin {
    match dice.pick(&child_ids(state)).filter(|_| dice.roll(5) > 0) {
        Some(id) => Origin::Outcome(id, OutcomeId(dice.small(6) - 2)),
        None => Origin::Income,
    }
}

fn target(state: &State, dice: &mut Dice) -> Target {
    match dice.pick(&child_ids(state)).filter(|_| dice.roll(3) > 0) {
        Some(id) => Target::State(id),
        None => Target::Outcome(OutcomeId(dice.small(6) - 2)),
    }
}

fn flow_end(state: &State, dice: &mut Dice) -> (StateId, PortId) {
    let mut ids = child_ids(state);
    ids.push(state.id.clone());
    (dice.pick(&ids).unwrap_or_else(|| state.id.clone()), PortId(dice.small(6)))
}

fn fresh(dice: &mut Dice) -> StateId {
    if dice.roll(4) == 0 {
        return dice.one(&["AAAAAA", "ROOT", DECIDER_ID].map(StateId::new));
    }
    let seed = dice.roll(60) as u64;
    Fresh::new(seed).id(|_| false)
}

fn children_edit(machine: &Machine, state: &State, dice: &mut Dice) -> ChildrenEdit {
    let ids = child_ids(state);
    let one = dice.pick(&ids).unwrap_or_else(|| StateId::new("NOPEXX"));
    let spare: Vec<_> = (0..3).map(|_| fresh(dice)).collect();
    match dice.roll(8) {
        0 => ChildrenEdit::Remove(one),
        1 => ChildrenEdit::SetStart(Some(target(state, dice)).filter(|_| dice.roll(4) > 0)),
        2 => {
            let scoped_variables = dice.some(&[PortId(0), PortId(1), PortId(2)]);
            let variables = state.container().map(|c| c.scoped_variables.clone());
            let exists = |id: &PortId| variables.as_ref().is_some_and(|v| v.get(*id).is_some());
            let scoped_variables = scoped_variables.into_iter().filter(exists).collect();
            let (states, id) = (dice.some(&ids), fresh(dice));
            ChildrenEdit::Group { states, scoped_variables, id, name: "Group".into() }
        }
        3 => ChildrenEdit::Ungroup { state: one, fresh: spare },
        4 => ChildrenEdit::Substitute { state: one, by: new_state(dice) },
        5 => {
            let to = any_path(machine, dice);
            ChildrenEdit::Move { states: dice.some(&ids), to, ids: spare }
        }
        6 => {
            let selection = copy(state, &dice.some(&ids), &[PortId(0), PortId(2)]);
            ChildrenEdit::Paste { selection, ids: spare }
        }
        _ => ChildrenEdit::Add(new_state(dice)),
    }
}

fn new_state(dice: &mut Dice) -> Arc<State> {
    let kind = dice.one(&[
        Kind::Execution(Script::default()),
        Kind::Hierarchy(Container::default()),
        Kind::Barrier(Container::default()),
        Kind::Preemptive(Container::default()),
    ]);
    let mut state = State::new(fresh(dice), "New", kind);
    state.outcomes.insert(Outcome::new(OutcomeId(0), "success"));
    let port = |id, name| Port::new(PortId(id), name, DataType::Int, Value::Int(4));
    state.inputs.insert(port(0, "x"));
    state.outputs.insert(port(1, "y"));
    Arc::new(state)
}
