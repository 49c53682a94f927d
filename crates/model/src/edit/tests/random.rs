//! Any edits on any machine: no rule is broken that was not broken before, and everything can be taken back.

use crate::edit::{
    ChildrenEdit, DataFlowEdit, Edit, OutcomeEdit, PortEdit, StateEdit, TransitionEdit, apply, copy,
};
use crate::ids::Fresh;
use crate::{
    BuiltinTypes, DECIDER_ID, DataFlowId, DataType, Kind, KindName, Machine, Origin, OutcomeId,
    PortId, PortKind, Rule, Script, State, StateId, StatePath, Target, TransitionId, Value,
    notation, problems,
};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

const START: &str = "
    hierarchy ROOT
      outcome success
      in a: int
      out b: int
      var v: int
      start -> AAAAAA
      AAAAAA.success -> BBBBBB ; BBBBBB.success -> .success
      flow .a -> AAAAAA.x ; AAAAAA.y -> .v ; .v -> CCCCCC.x
      execution AAAAAA
        outcome success
        in x: int
        out y: int
      barrier BBBBBB
        outcome success
        DDDDDD.success -> unique_decider_state_id
        execution DDDDDD
          outcome success
        decider unique_decider_state_id
          outcome success
      hierarchy CCCCCC
        outcome success
        in x: int
        var w: int
        start -> EEEEEE
        flow .x -> .w
        library EEEEEE from \"lib/one\"
          content
            execution LLLLLL
              outcome success
              in q: object
      preemptive FFFFFF
        outcome success
        GGGGGG.success -> .success
        execution GGGGGG
          outcome success
";

/// Ids at the end of what a number can be.
const FULL: &str = "
    barrier ROOT
      outcome success
      var v: int
      AAAAAA.success -> unique_decider_state_id as 9223372036854775807
      unique_decider_state_id.success -> .success as 0
      flow .v -> AAAAAA.x as 9223372036854775807
      hierarchy AAAAAA
        outcome success
        in 9223372036854775807 x: int
        start -> BBBBBB as -9223372036854775808
        BBBBBB.9223372036854775807 -> .success as 9223372036854775807
        flow .x -> BBBBBB.x as 9223372036854775807
        execution BBBBBB
          outcome 9223372036854775807 done
          in -9223372036854775808 x: int
      decider unique_decider_state_id
        outcome success
";

const FAULTY: &str = "
    hierarchy ROOT
      without -1
      outcome success
      outcome success
      in a: int = \"five\"
      in b: int
      out 1 b: int
      start -> GONE ; start -> AAAAAA
      AAAAAA -> BBBBBB ; AAAAAA.7 -> BBBBBB ; AAAAAA.success -> nowhere ; .0 -> AAAAAA
      flow .a -> AAAAAA.7 ; GONE.0 -> AAAAAA.x ; .a -> .0 ; AAAAAA.0 -> .b
      execution AAAAAA \"\"
        outcome success
        in x: str
      barrier BBBBBB
        start -> AAAAAA
        AAAAAA.success -> .3
        execution AAAAAA
          outcome success
      preemptive CCCCCC
        AAAAAA.success -> AAAAAA
        execution AAAAAA
          outcome success
        decider unique_decider_state_id
      library EEEEEE
        set in 3 = 4
        missing \"no folder\"
";

/// Numbers that choose an edit from what the machine has.
struct Dice {
    numbers: std::vec::IntoIter<u16>,
}

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        usize::from(self.numbers.next().unwrap_or(0)).checked_rem(sides).unwrap_or(0)
    }

    fn pick<T: Clone>(&mut self, items: &[T]) -> Option<T> {
        let index = self.roll(items.len());
        items.get(index).cloned()
    }

    fn some<T: Clone>(&mut self, items: &[T]) -> Vec<T> {
        items.iter().filter(|_| self.roll(2) == 0).cloned().collect()
    }
}

fn paths(machine: &Machine) -> Vec<StatePath> {
    let mut paths = vec![StatePath::root(machine.root.id.clone())];
    let mut next = 0;
    while let Some(path) = paths.get(next).cloned() {
        let state = machine.state(&path).expect("a state");
        let children = state.container().into_iter().flat_map(|c| c.states.keys());
        paths.extend(children.map(|id| path.child(id.clone())));
        next += 1;
    }
    paths
}

/// An edit that may or may not be legal.
fn edit(machine: &Machine, dice: &mut Dice) -> Edit {
    let path = dice.pick(&paths(machine)).expect("a root");
    let state = machine.state(&path).expect("a state");
    match dice.roll(7) {
        0 => Edit::State(path, state_edit(dice)),
        1 => {
            let id = OutcomeId(i64::try_from(dice.roll(5)).expect("small") - 2);
            let edits = [
                OutcomeEdit::Add(name(dice)),
                OutcomeEdit::Rename(name(dice)),
                OutcomeEdit::Remove,
            ];
            Edit::Outcome(path, id, dice.pick(&edits).expect("one"))
        }
        2 => {
            let kind = dice.pick(&PortKind::ALL).expect("one");
            let edit = port_edit(dice);
            Edit::Port(path, kind, PortId(small(dice)), edit)
        }
        3 => {
            let (from, to) = (origin(state, dice), target(state, dice));
            let edits = [
                TransitionEdit::Add { from: from.clone(), to: to.clone() },
                TransitionEdit::Add { from: from.clone(), to: to.clone() },
                TransitionEdit::SetOrigin(from),
                TransitionEdit::SetTarget(to),
                TransitionEdit::Remove,
            ];
            Edit::Transition(path, TransitionId(small(dice)), dice.pick(&edits).expect("one"))
        }
        4 => {
            let (from, to) = (flow_end(state, dice), flow_end(state, dice));
            let edits = [
                DataFlowEdit::Add { from: from.clone(), to: to.clone() },
                DataFlowEdit::Add { from: from.clone(), to: to.clone() },
                DataFlowEdit::SetSource(from),
                DataFlowEdit::SetTarget(to),
                DataFlowEdit::Remove,
            ];
            Edit::DataFlow(path, DataFlowId(small(dice)), dice.pick(&edits).expect("one"))
        }
        _ => Edit::Children(path, children_edit(machine, state, dice)),
    }
}

fn small(dice: &mut Dice) -> i64 {
    i64::try_from(dice.roll(6)).expect("small")
}

fn name(dice: &mut Dice) -> smol_str::SmolStr {
    dice.pick(&["success", "x", "y", "", "a/b", "done"]).expect("one").into()
}

fn state_edit(dice: &mut Dice) -> StateEdit {
    let kinds = [KindName::Execution, KindName::Hierarchy, KindName::Barrier, KindName::Preemptive];
    match dice.roll(3) {
        0 => StateEdit::SetName(name(dice)),
        1 => StateEdit::SetKind(dice.pick(&kinds).expect("one")),
        _ => StateEdit::SetId(fresh(dice)),
    }
}

fn port_edit(dice: &mut Dice) -> PortEdit {
    let types = [DataType::Int, DataType::Int, DataType::Str, DataType::Object];
    let data_type = dice.pick(&types).expect("one");
    let default = dice.pick(&[Value::None, Value::Int(1), Value::str("2")]).expect("one");
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
        Some(id) => Origin::Outcome(id, OutcomeId(small(dice) - 2)),
        None => Origin::Income,
    }
}

fn target(state: &State, dice: &mut Dice) -> Target {
    match dice.pick(&child_ids(state)).filter(|_| dice.roll(3) > 0) {
        Some(id) => Target::State(id),
        None => Target::Outcome(OutcomeId(small(dice) - 2)),
    }
}

fn flow_end(state: &State, dice: &mut Dice) -> (StateId, PortId) {
    let mut ids = child_ids(state);
    ids.push(state.id.clone());
    (dice.pick(&ids).expect("one"), PortId(small(dice)))
}

fn fresh(dice: &mut Dice) -> StateId {
    if dice.roll(4) == 0 {
        return dice.pick(&["AAAAAA", "ROOT", DECIDER_ID].map(StateId::new)).expect("one");
    }
    let seed = u64::try_from(dice.roll(60)).expect("small");
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
            let to = dice.pick(&paths(machine)).expect("a root");
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
    let inside = crate::Container::default;
    let kinds = [
        Kind::Execution(Script::default()),
        Kind::Hierarchy(inside()),
        Kind::Barrier(inside()),
        Kind::Preemptive(inside()),
    ];
    let kind = dice.pick(&kinds).expect("one");
    let mut state = State::new(fresh(dice), "New", kind);
    state.outcomes.insert(crate::Outcome::new(OutcomeId(0), "success"));
    let port = |id, name| crate::Port::new(PortId(id), name, DataType::Int, Value::Int(4));
    state.inputs.insert(port(0, "x"));
    state.outputs.insert(port(1, "y"));
    Arc::new(state)
}

/// How often each rule is broken.
fn faults(machine: &Machine) -> BTreeMap<Rule, usize> {
    let mut counts = BTreeMap::new();
    for problem in problems(machine, &BuiltinTypes).into_iter().filter(|p| p.rule.refuses_edits()) {
        *counts.entry(problem.rule).or_default() += 1;
    }
    counts
}

/// Makes the edits; holds after each what an edit promises.
fn edit_and_look(text: &str, numbers: Vec<u16>) {
    let mut machine = notation::parse(text).expect("a machine");
    let mut dice = Dice { numbers: numbers.into_iter() };
    let mut backs = Vec::new();
    while dice.numbers.len() > 0 {
        let before = machine.clone();
        let edit = edit(&machine, &mut dice);
        let shown = format!("{edit:?}");
        match apply(&mut machine, edit, &BuiltinTypes) {
            Ok(back) => {
                let (earlier, now) = (faults(&before), faults(&machine));
                for (rule, count) in now {
                    assert!(
                        earlier.get(&rule).is_some_and(|n| *n >= count),
                        "{rule} by {shown}\n{}",
                        notation::print(&before)
                    );
                }
                let after = machine.clone();
                backs.push((before, back, after, shown));
            }
            Err(_) => assert_eq!(machine, before, "{shown}"),
        }
    }
    assert_eq!(notation::parse(&notation::print(&machine)).as_ref(), Ok(&machine));
    take_all_back(machine, backs);
}

fn take_all_back(mut machine: Machine, backs: Vec<(Machine, Edit, Machine, String)>) {
    let mut agains = Vec::new();
    for (before, back, after, shown) in backs.into_iter().rev() {
        let again = apply(&mut machine, back, &BuiltinTypes);
        agains.push((again.unwrap_or_else(|error| panic!("{error} taking back {shown}")), after));
        assert_eq!(machine, before, "{shown}");
    }
    for (again, after) in agains.into_iter().rev() {
        apply(&mut machine, again, &BuiltinTypes).expect("an edit is made again");
        assert_eq!(machine, after);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn any_edits_keep_every_rule_and_can_be_taken_back(numbers in proptest::collection::vec(any::<u16>(), 0..400)) {
        edit_and_look(START, numbers);
    }

    /// The same where ids come to their end.
    #[test]
    fn edits_find_room_for_their_ids(numbers in proptest::collection::vec(any::<u16>(), 0..200)) {
        edit_and_look(FULL, numbers);
    }

    /// The same where much is wrong to begin with.
    #[test]
    fn edits_of_a_faulty_machine_make_nothing_worse(numbers in proptest::collection::vec(any::<u16>(), 0..400)) {
        edit_and_look(FAULTY, numbers);
    }
}
