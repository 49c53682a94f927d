//! Edits that mend a broken rule. Knows which rule has an obvious way out; whether an edit is legal is asked of the model.

use rafcon_model::edit::apply;
use rafcon_model::{
    BuiltinTypes, Container, DataFlow, DataFlowId, Machine, OutcomeId, Part, Port, PortKind,
    Problem, Rule, State, StateId, StatePath, TransitionId,
};
use rafcon_protocol::api::Repair;
use rafcon_protocol::edit::{Edit, Goal, OutcomeOf, PortList, PortOf};

/// The edits that mend a problem, the one that keeps most first.
pub(crate) fn repairs(machine: &Machine, problem: &Problem) -> Vec<Repair> {
    let Some(state) = machine.state(&problem.path) else { return Vec::new() };
    let place = Place { machine, path: &problem.path, state };
    match problem.part {
        Part::Transition(id) => place.transition(id, problem.rule),
        Part::DataFlow(id) => place.data_flow(id, problem.rule),
        Part::RuntimeValue(kind, port) => place.runtime_value(kind, port.0, problem.rule),
        Part::State | Part::Outcome(_) | Part::Port(..) => Vec::new(),
    }
}

/// The repair, if it is an edit that the model takes.
pub(crate) fn possible(machine: &Machine, name: impl Into<String>, edit: Edit) -> Option<Repair> {
    let wish = rafcon_model::edit::Edit::try_from(&edit).ok()?;
    apply(&mut machine.clone(), wish, &BuiltinTypes).ok()?;
    Some(Repair { name: name.into(), edit })
}

/// The state that has the broken part.
struct Place<'m> {
    machine: &'m Machine,
    path: &'m StatePath,
    state: &'m State,
}

impl Place<'_> {
    fn path(&self) -> String {
        self.path.to_string()
    }

    fn possible(&self, name: impl Into<String>, edit: Edit) -> Option<Repair> {
        possible(self.machine, name, edit)
    }

    fn transition(&self, id: TransitionId, rule: Rule) -> Vec<Repair> {
        let Some(container) = self.state.container() else { return Vec::new() };
        let mended = match rule {
            Rule::OriginOutcome => self.other_origin(container, id),
            Rule::TargetOutcome | Rule::TargetIncomplete => self.other_outcome(id),
            Rule::BarrierTarget => self.to_decider(container, id),
            Rule::TargetOutcomeOfChild => self.to_income(container, id),
            _ => None,
        };
        let removed = Edit::RemoveTransition { path: self.path(), transition: id.0 };
        let removed = self.possible("Remove the transition", removed);
        mended.into_iter().chain(removed).collect()
    }

    /// The only outcome of the child that may happen and leads nowhere.
    fn other_origin(&self, container: &Container, id: TransitionId) -> Option<Repair> {
        let from = container.transitions.get(id)?.from_state.clone()?;
        let child = container.states.get(&from)?;
        let is_free = |outcome: &OutcomeId| {
            let mut leading = container.transitions.out_of_state(&from);
            !outcome.is_mandatory() && !leading.any(|other| other.from_outcome == Some(*outcome))
        };
        let free = child.outcomes.iter().filter(|outcome| is_free(&outcome.id));
        let outcome = only(free)?;
        let origin = OutcomeOf { state: from.to_string(), outcome: outcome.id.0 };
        let (path, transition) = (self.path(), id.0);
        let edit = Edit::SetTransitionOrigin { path, transition, from: Some(origin) };
        self.possible(format!("Begin at the outcome \"{}\"", outcome.name), edit)
    }

    /// The only outcome of the container that is not there by itself.
    fn other_outcome(&self, id: TransitionId) -> Option<Repair> {
        let outcome = only(self.state.outcomes.iter().filter(|one| !one.id.is_mandatory()))?;
        let name = format!("Lead to the outcome \"{}\"", outcome.name);
        self.lead(name, id, Goal::Outcome(outcome.id.0))
    }

    fn to_decider(&self, container: &Container, id: TransitionId) -> Option<Repair> {
        let decider = container.states.keys().find(|id| id.is_decider())?;
        self.lead("Lead to the decider", id, Goal::State(decider.to_string()))
    }

    fn to_income(&self, container: &Container, id: TransitionId) -> Option<Repair> {
        let child = container.transitions.get(id)?.to_state.clone()?;
        self.lead("Lead to the income", id, Goal::State(child.to_string()))
    }

    fn lead(&self, name: impl Into<String>, id: TransitionId, to: Goal) -> Option<Repair> {
        let edit = Edit::SetTransitionTarget { path: self.path(), transition: id.0, to };
        self.possible(name, edit)
    }

    fn data_flow(&self, id: DataFlowId, rule: Rule) -> Vec<Repair> {
        let Some(container) = self.state.container() else { return Vec::new() };
        let Some(flow) = container.data_flows.get(id) else { return Vec::new() };
        if rule == Rule::FlowTypeUnknown {
            return Vec::new();
        }
        let mended = match rule {
            Rule::FlowPort => self.other_port(container, flow),
            _ => None,
        };
        let removed = Edit::RemoveDataFlow { path: self.path(), data_flow: id.0 };
        let removed = self.possible("Remove the data flow", removed);
        mended.into_iter().chain(removed).collect()
    }

    /// For an end without its port: the port with the name of the other end's, or the only one that fits.
    fn other_port(&self, container: &Container, flow: &DataFlow) -> Option<Repair> {
        let from = self.ports(container, &flow.from_state, Side::From);
        let to = self.ports(container, &flow.to_state, Side::To);
        let source = from.iter().find(|port| port.id == flow.from_port);
        let target = to.iter().find(|port| port.id == flow.to_port);
        let (ports, other, side) = match (source, target) {
            (None, Some(target)) => (&from, target, Side::From),
            (Some(source), None) => (&to, source, Side::To),
            _ => return None,
        };
        let repair = |port: &&Port| self.reconnect(flow, side, port);
        let named = ports.iter().copied().filter(|port| port.name == other.name);
        named.map(|port| repair(&port)).find_map(|found| found).or_else(|| {
            let fitting: Vec<_> = ports.iter().filter_map(repair).collect();
            only(fitting.into_iter())
        })
    }

    fn reconnect(&self, flow: &DataFlow, side: Side, port: &Port) -> Option<Repair> {
        let (path, data_flow) = (self.path(), flow.id.0);
        let end = |state: &StateId| PortOf { state: state.to_string(), port: port.id.0 };
        let (name, edit) = match side {
            Side::From => (
                format!("Begin at the port \"{}\"", port.name),
                Edit::SetDataFlowSource { path, data_flow, from: end(&flow.from_state) },
            ),
            Side::To => (
                format!("End at the port \"{}\"", port.name),
                Edit::SetDataFlowTarget { path, data_flow, to: end(&flow.to_state) },
            ),
        };
        self.possible(name, edit)
    }

    /// Ports where a data flow may begin, or end, at the container or a child.
    fn ports<'s>(&'s self, container: &'s Container, id: &StateId, side: Side) -> Vec<&'s Port> {
        let kinds: &[PortKind] = match (*id == self.state.id, side) {
            (true, Side::From) => &[PortKind::Input, PortKind::ScopedVariable],
            (true, Side::To) => &[PortKind::Output, PortKind::ScopedVariable],
            (false, Side::From) => &[PortKind::Output],
            (false, Side::To) => &[PortKind::Input],
        };
        let child = || container.states.get(id).map(|child| &**child);
        let owner = if *id == self.state.id { Some(self.state) } else { child() };
        let lists =
            owner.into_iter().flat_map(|owner| kinds.iter().filter_map(|kind| kind.of(owner)));
        lists.flatten().collect()
    }

    fn runtime_value(&self, kind: PortKind, port: i64, rule: Rule) -> Vec<Repair> {
        let list = match kind {
            PortKind::Input => PortList::Input,
            PortKind::Output => PortList::Output,
            PortKind::ScopedVariable => return Vec::new(),
        };
        let path = self.path();
        let (name, edit) = match rule {
            Rule::RuntimeValueType => (
                "Do not use the runtime value",
                Edit::UseRuntimeValue { path, list, port, used: false },
            ),
            _ => ("Remove the runtime value", Edit::RemoveRuntimeValue { path, list, port }),
        };
        self.possible(name, edit).into_iter().collect()
    }
}

/// One end of a data flow.
#[derive(Debug, Clone, Copy)]
enum Side {
    From,
    To,
}

/// The one that there is, if there is no other.
fn only<T>(mut of: impl Iterator<Item = T>) -> Option<T> {
    let first = of.next()?;
    of.next().is_none().then_some(first)
}

#[cfg(test)]
mod tests {
    use super::repairs;
    use expect_test::{Expect, expect};
    use rafcon_model::{BuiltinTypes, problems};
    use rafcon_testkit::notation;

    /// Rule, then what mends it.
    fn check(text: &str, expect: &Expect) {
        let machine = notation::parse(text).expect("a machine");
        let told = problems(&machine, &BuiltinTypes).into_iter().filter_map(|problem| {
            let repairs = repairs(&machine, &problem);
            let names: Vec<_> = repairs.into_iter().map(|repair| repair.name).collect();
            (!names.is_empty()).then(|| format!("{}: {}\n", problem.rule, names.join(" | ")))
        });
        expect.assert_eq(&told.collect::<String>());
    }

    #[test]
    fn transitions_are_mended() {
        check(
            "hierarchy ROOT
               outcome success
               AAAAAA.9 -> .success ; BBBBBB.success -> .7 ; AAAAAA.aborted -> GONEEE
               execution AAAAAA
                 outcome done
               execution BBBBBB
                 outcome success",
            &expect![[r#"
                OriginOutcome: Begin at the outcome "done" | Remove the transition
                TargetOutcome: Lead to the outcome "success" | Remove the transition
                TargetState: Remove the transition
            "#]],
        );
    }

    #[test]
    fn data_flows_are_mended() {
        check(
            "hierarchy ROOT
               in speed: float
               var other: str
               flow .speed -> AAAAAA.9 ; .other -> BBBBBB.9 ; BBBBBB.8 -> .other ; GONEEE.1 -> .other
               execution AAAAAA
                 in speed: float
                 in limit: float
               execution BBBBBB
                 in first: str
                 in second: int
                 out first: str
                 out second: str",
            &expect![[r#"
                FlowPort: End at the port "speed" | Remove the data flow
                FlowPort: End at the port "first" | Remove the data flow
                FlowPort: Remove the data flow
                FlowState: Remove the data flow
            "#]],
        );
    }
}
