//! Rules about lost-link policies (`docs/semantics.md`, Lost link). They find entries that are not understood, and traps.

use super::{Fault, Rule};
use crate::{Container, Kind, Loss, LossPolicy, Origin, OutcomeId, State, Transition};
use std::collections::BTreeSet;

/// For each loss the nearest state around another that has a policy.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PoliciesAround<'m>([Option<(&'m State, LossPolicy)>; 2]);

impl<'m> PoliciesAround<'m> {
    /// Those for the states in `state`, which has these around it.
    pub(crate) fn within(self, state: &'m State) -> Self {
        let own = Loss::ALL.map(|loss| Some((state, LossPolicy::of(state, loss)?)));
        let [link, command] = self.0;
        Self([own[0].or(link), own[1].or(command)])
    }
}

/// Entries that are not understood, and recoveries that lead nowhere.
pub(super) fn faults(parent: Option<&State>, state: &State) -> Vec<Fault> {
    let unclear = Loss::ALL.into_iter().filter(|loss| LossPolicy::is_unclear(state, *loss));
    let what = |loss: Loss| format!("the semantic data `{}` is not understood", loss.key());
    let mut faults: Vec<_> = unclear.map(|loss| Fault::new(Rule::LostLink, what(loss))).collect();
    let recovers =
        |loss| LossPolicy::of(state, loss).is_some_and(|policy| policy.recover_ms.is_some());
    if let Some(loss) = Loss::ALL.into_iter().find(|loss| recovers(*loss))
        && !leads_on(parent, state)
    {
        let key = loss.key();
        let what = format!("`{key}` preempts the state, and no transition begins at `preempted`");
        faults.push(Fault::new(Rule::LostLinkRecovery, what));
    }
    faults
}

/// True if a transition begins at *preempted*. That of the root of a library is in the machine that uses it.
fn leads_on(parent: Option<&State>, state: &State) -> bool {
    let Some(parent) = parent else { return false };
    parent.container().is_none_or(|container| recovery(container, state).is_some())
}

/// The transition from the outcome *preempted* of a state.
fn recovery<'m>(container: &'m Container, state: &State) -> Option<&'m Transition> {
    let origin = Origin::Outcome(state.id.clone(), OutcomeId::PREEMPTED);
    container.transitions.from(&origin).next()
}

/// The faults of policies that do something else than their author may expect.
pub(crate) fn traps(
    around: PoliciesAround<'_>,
    parent: Option<&State>,
    state: &State,
) -> Vec<Fault> {
    let pairs = Loss::ALL.into_iter().zip(around.0);
    let policies = pairs.filter_map(|(loss, around)| {
        let policy = LossPolicy::of(state, loss)?;
        Some(PolicyInPlace { key: loss.key(), loss, policy, state, parent, around })
    });
    policies.flat_map(|policy| [policy.finish_trap(), policy.way_home_trap()]).flatten().collect()
}

/// A policy of a state, with what is around the state.
struct PolicyInPlace<'m> {
    key: &'static str,
    loss: Loss,
    policy: LossPolicy,
    state: &'m State,
    parent: Option<&'m State>,
    around: Option<(&'m State, LossPolicy)>,
}

impl PolicyInPlace<'_> {
    fn finish_trap(&self) -> Option<Fault> {
        let (key, finish_ms) = (self.key, self.policy.finish_ms?);
        if self.parent.is_none() {
            let what = format!("`finish_s` of `{key}` pauses nothing: the run ends with the root");
            return Some(Fault::new(Rule::LostLinkFinish, what));
        }
        if !ends_by_itself(self.state) {
            let what =
                format!("`finish_s` of `{key}` pauses nothing: the state never ends by itself");
            return Some(Fault::new(Rule::LostLinkFinish, what));
        }
        let in_race = self.parent.is_some_and(|parent| matches!(parent.kind, Kind::Preemptive(_)));
        let recovers_late = self.policy.recover_ms.is_some_and(|recover_ms| finish_ms < recover_ms);
        let recovers_around = self.around.is_some_and(|(_, policy)| policy.recover_ms.is_some());
        let what = || {
            format!(
                "if the state ends between `finish_s` and `recover_s` of `{key}`, its branch is paused and never recovers"
            )
        };
        (recovers_late && !recovers_around && !in_race)
            .then(|| Fault::new(Rule::LostLinkFinishFirst, what()))
    }

    /// The recovery is paused by its own policy, or by the one around it.
    fn way_home_trap(&self) -> Option<Fault> {
        let recover_ms = self.policy.recover_ms?;
        let Some(Kind::Hierarchy(container)) = self.parent.map(|parent| &parent.kind) else {
            return None;
        };
        let leading = recovery(container, self.state).filter(|t| t.to_outcome.is_none())?;
        let home = container.states.get(leading.to_state.as_ref()?)?;
        let own = LossPolicy::of(home, self.loss);
        let (holder, policy) = own.map(|own| (&**home, own)).or(self.around)?;
        let entry = if policy.hold_ms.is_some() {
            "hold_s"
        } else if own.and_then(|own| own.recover_ms).is_some_and(|ms| ms <= recover_ms) {
            "recover_s"
        } else {
            return None;
        };
        let (key, home, holder) = (self.key, &home.id, &holder.id);
        let what = format!(
            "the recovery of `{key}` leads to {home}, and `{entry}` of {holder} pauses that state"
        );
        Some(Fault::new(Rule::LostLinkWayHome, what))
    }
}

/// True if ordinary outcomes of its children lead to an end of the state.
fn ends_by_itself(state: &State) -> bool {
    let Kind::Hierarchy(container) = &state.kind else { return true };
    let Some(start) = container.transitions.from(&Origin::Income).next() else { return true };
    let mut open = vec![start];
    let mut reached = BTreeSet::new();
    while let Some(transition) = open.pop() {
        if transition.to_outcome.is_some() {
            return true;
        }
        let Some(child) = transition.to_state.as_ref().filter(|child| reached.insert(*child))
        else {
            continue;
        };
        open.extend(container.transitions.out_of_state(child).filter(|t| {
            !matches!(t.from_outcome, Some(OutcomeId::PREEMPTED | OutcomeId::ABORTED))
        }));
    }
    false
}
