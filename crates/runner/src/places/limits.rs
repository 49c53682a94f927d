//! Limits from the semantic data of states: deadlines, grace periods and keeping levels (`docs/semantics.md`). This
//! module knows the entries, but no clock.

use rafcon_engine::{Node, NodeId, Program};
use rafcon_model::{Json, Kind, LibraryContent, Loss, LossPolicy, Machine, State, seconds_as_ms};
use rafcon_protocol::Keeping;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Key of the deadline: seconds from the entry of a state, after which it is preempted.
const DEADLINE: &str = "deadline_s";
/// Key of the grace period: seconds that a script may continue after it was asked to end. That of the root applies to
/// all states without one.
const GRACE: &str = "grace_s";

/// The limits of the states in one program.
#[derive(Debug, Default)]
pub(crate) struct Limits {
    /// Limits by node; empty if no state has any.
    nodes: Vec<Limit>,
    /// Times of silence that policies name, in ms: of the link, then of commands. Each list is sorted.
    silences: [Vec<u64>; 2],
}

#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Limit {
    deadline_ms: Option<u64>,
    grace_ms: Option<u64>,
}

impl Limits {
    /// The limits of a program.
    pub(crate) fn of<D>(program: &Program<D>) -> Self {
        let all = grace(program.node(Program::<D>::ROOT).state());
        let limit = |node: &Node<D>| Limit {
            deadline_ms: deadline(node.state()),
            grace_ms: if node.is_script() { grace(node.state()).or(all) } else { None },
        };
        let nodes: Vec<Limit> = program.nodes().map(|(_, node)| limit(node)).collect();
        let any = nodes.iter().any(|limit| *limit != Limit::default());
        let silences = Loss::ALL.map(|loss| silences(program, loss));
        Self { nodes: if any { nodes } else { Vec::new() }, silences }
    }

    /// True if no state has a deadline or a grace period.
    pub(crate) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Times of silence that policies name, in ms: of the link, then of commands. Each list is sorted.
    pub(crate) fn silences(&self) -> &[Vec<u64>; 2] {
        &self.silences
    }

    /// The deadline of a state.
    pub(crate) fn deadline_ms(&self, node: NodeId) -> Option<u64> {
        self.nodes.get(node.index())?.deadline_ms
    }

    /// The grace period of a state's script.
    pub(crate) fn grace_ms(&self, node: NodeId) -> Option<u64> {
        self.nodes.get(node.index())?.grace_ms
    }
}

fn silences<D>(program: &Program<D>, loss: Loss) -> Vec<u64> {
    let policies = program.nodes().filter_map(|(_, node)| node.loss_policy(loss));
    let times: BTreeSet<u64> = policies.flat_map(LossPolicy::times).collect();
    times.into_iter().collect()
}

fn deadline(state: &State) -> Option<u64> {
    seconds_as_ms(entry(state, DEADLINE)?)
}

fn grace(state: &State) -> Option<u64> {
    seconds_as_ms(entry(state, GRACE)?)
}

fn entry<'s>(state: &'s State, key: &str) -> Option<&'s Json> {
    state.semantic_data.as_ref()?.get(key)
}

/// Invalid entries, one line each.
pub(crate) fn faults(machine: &Machine) -> Vec<String> {
    let mut faults = Vec::new();
    let mut libraries = BTreeSet::new();
    let mut open = vec![(machine.root.id.to_string(), Arc::clone(&machine.root))];
    while let Some((path, state)) = open.pop() {
        for key in [DEADLINE, GRACE] {
            if entry(&state, key).is_some_and(|json| seconds_as_ms(json).is_none()) {
                faults.push(format!(
                    "{path}, semantic data \"{key}\": not a number of seconds between 0 and a year; it is ignored"
                ));
            }
        }
        let inside = |child: &Arc<State>| (format!("{path}/{}", child.id), Arc::clone(child));
        if let Some(container) = state.container() {
            open.extend(container.states.values().map(inside));
        }
        if let Kind::Library(library) = &state.kind
            && let LibraryContent::Found(root) = &library.content
            && libraries.insert(Arc::as_ptr(root))
        {
            open.push(inside(root));
        }
    }
    faults.sort();
    faults
}

/// Key of the keeping level: `off`, `status` or `full`.
const KEEPING: &str = "journal";

/// The keeping level of `state`, given that of the state around it, or of the run for the root.
///
/// A state cannot keep more than the state around it. [`Keeping::Off`] drops its values and log lines. Its entries and
/// ends are kept nevertheless, because without them a run could not be resumed.
pub(crate) fn keeping_of(state: &State, around: Keeping) -> Keeping {
    around.min(asked(state).unwrap_or_default())
}

fn asked(state: &State) -> Option<Keeping> {
    match state.semantic_data.as_ref()?.get(KEEPING)?.as_str()? {
        "off" => Some(Keeping::Off),
        "status" => Some(Keeping::Status),
        "full" => Some(Keeping::Full),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::{Limits, faults};
    use expect_test::{Expect, expect};
    use rafcon_engine::{ModelLiterals, Program};
    use rafcon_model::{Json, Machine};
    use rafcon_testkit::notation;
    use std::sync::Arc;

    fn machine(deadline: Json) -> Machine {
        let mut machine = notation::parse("execution ROOT \"go\"\n  outcome done\n").unwrap();
        let data = Json::Object(vec![("deadline_s".into(), deadline)]);
        Arc::make_mut(&mut machine.root).semantic_data = Some(Arc::new(data));
        machine
    }

    fn check(deadline: Json, expect: &Expect) {
        let machine = machine(deadline);
        let program = Program::compile(&machine, &mut ModelLiterals);
        let limit = Limits::of(&program).deadline_ms(Program::<rafcon_model::Value>::ROOT);
        expect.assert_eq(&format!("{limit:?} {:?}", faults(&machine)));
    }

    #[test]
    fn a_limit_is_a_number_of_seconds() {
        check(Json::Int(2), &expect!["Some(2000) []"]);
        check(Json::Float(0.25), &expect!["Some(250) []"]);
        check(Json::Str(" 1.5 ".into()), &expect!["Some(1500) []"]);
    }

    #[test]
    fn what_is_no_time_is_named_and_ignored() {
        let said = expect![[
            r#"None ["ROOT, semantic data \"deadline_s\": not a number of seconds between 0 and a year; it is ignored"]"#
        ]];
        for nonsense in [Json::Int(-1), Json::Float(f64::NAN), Json::Str("soon".into()), Json::Null]
        {
            check(nonsense, &said);
        }
    }
}

#[cfg(test)]
mod keeping_tests {
    use super::keeping_of;
    use expect_test::{Expect, expect};
    use rafcon_model::{Json, Kind, Script, State, StateId};
    use rafcon_protocol::Keeping;
    use std::sync::Arc;

    fn check(asked: &str, around: Keeping, expect: &Expect) {
        let mut state = State::new(StateId::new("A"), "a", Kind::Execution(Script::default()));
        let members = vec![("journal".into(), Json::Str(asked.into()))];
        state.semantic_data = Some(Arc::new(Json::Object(members)));
        expect.assert_eq(&format!("{:?}", keeping_of(&state, around)));
    }

    #[test]
    fn a_state_keeps_what_it_asks_for_but_not_more_than_the_one_around_it() {
        check("status", Keeping::Full, &expect!["Status"]);
        check("off", Keeping::Full, &expect!["Off"]);
        check("full", Keeping::Status, &expect!["Status"]);
        check("everything", Keeping::Full, &expect!["Full"]);
    }
}
