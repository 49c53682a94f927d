//! What was done to an open machine, as a tree: whoever goes back and does something else takes another branch. Pure: knows
//! machines and the order of revisions, nothing of what may be taken back.
//!
//! A node is a revision at which the machine was what it had never been before; it hangs on the node of the revision before.

use rafcon_model::Machine;
use rafcon_protocol::api::{MachineStep, MachineSteps};
use rafcon_protocol::document::{Change, changes};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// Older steps are no longer told.
const STEPS_MAX: usize = 10_000;
/// So many machines of the past are kept beside the start. They share what they have in common.
const MACHINES_MAX: usize = 1000;

/// The steps of an open machine, and the machines that they led to.
#[derive(Debug)]
pub(super) struct MachineHistoryTree {
    start: u64,
    steps: VecDeque<MachineStep>,
    /// By node.
    machines: BTreeMap<u64, RecordedMachine>,
    nodes: BTreeMap<Fingerprint, u64>,
}

#[derive(Debug)]
struct RecordedMachine {
    machine: Machine,
    mark: Fingerprint,
}

/// Tells machines of one past apart without looking at all of them: the sum of what is different from the start, part by part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) struct Fingerprint(u128);

impl Fingerprint {
    /// That of `new`, if this is that of `old`, and these changes lead from there to `new`.
    pub(super) fn after(self, old: &Machine, new: &Machine, forth: &[Change]) -> Self {
        Self(self.0.wrapping_add(weight(forth)).wrapping_sub(weight(&changes(new, old))))
    }
}

/// The sum over everything that changes say is there.
fn weight(changes: &[Change]) -> u128 {
    let is_there = |change: &&Change| match change {
        Change::State { .. } | Change::Header { .. } => true,
        Change::Transition { transition, .. } => transition.is_some(),
        Change::DataFlow { data_flow, .. } => data_flow.is_some(),
        Change::StateRemoved { .. } => false,
    };
    let of_one = |change: &Change| {
        let text = serde_json::to_vec(change).unwrap_or_default();
        let mut bytes = [0; 16];
        bytes.copy_from_slice(&blake3::hash(&text).as_bytes()[..16]);
        u128::from_le_bytes(bytes)
    };
    changes.iter().filter(is_there).map(of_one).fold(0, u128::wrapping_add)
}

impl MachineHistoryTree {
    /// A machine that has only just begun, as this revision.
    pub(super) fn of(machine: Machine, start: u64) -> Self {
        let mut past = Self {
            start,
            steps: VecDeque::new(),
            machines: BTreeMap::new(),
            nodes: BTreeMap::new(),
        };
        past.keep(start, machine, Fingerprint::default());
        past
    }

    /// The earliest revision that is known at which the machine was this one.
    pub(super) fn same_as(&self, machine: &Machine, mark: Fingerprint) -> Option<u64> {
        let node = *self.nodes.get(&mark)?;
        (self.machines.get(&node)?.machine == *machine).then_some(node)
    }

    /// The next step, and the machine that it led to.
    pub(super) fn push(&mut self, step: MachineStep, machine: &Machine, mark: Fingerprint) {
        if step.same_as.is_none() {
            self.keep(step.revision, machine.clone(), mark);
        }
        self.steps.push_back(step);
        if self.steps.len() > STEPS_MAX
            && let Some(oldest) = self.steps.pop_front()
        {
            self.forget(oldest.revision);
        }
    }

    /// The start is kept for as long as the machine is open.
    fn keep(&mut self, node: u64, machine: Machine, mark: Fingerprint) {
        self.nodes.insert(mark, node);
        self.machines.insert(node, RecordedMachine { machine, mark });
        if self.machines.len() > MACHINES_MAX + 1
            && let Some(oldest) = self.machines.keys().nth(1).copied()
        {
            self.forget(oldest);
        }
    }

    fn forget(&mut self, node: u64) {
        if let Some(kept) = self.machines.remove(&node)
            && self.nodes.get(&kept.mark) == Some(&node)
        {
            self.nodes.remove(&kept.mark);
        }
    }

    /// All of it.
    pub(super) fn steps(&self) -> MachineSteps {
        let told = |step: &MachineStep| {
            let is_kept = self.machines.contains_key(&node(step));
            MachineStep { is_kept, ..step.clone() }
        };
        MachineSteps { start: self.start, steps: self.steps.iter().map(told).collect() }
    }

    /// What the step to a revision is called; nothing at the start.
    pub(super) fn name(&self, revision: u64) -> Option<&str> {
        self.step(revision).map(|step| step.name.as_str())
    }

    /// The node of a revision, and the machine as it was there; nothing if it is not kept.
    pub(super) fn machine(&self, revision: u64) -> Option<(u64, &Machine)> {
        let node = self.node(revision)?;
        Some((node, &self.machines.get(&node)?.machine))
    }

    /// The node of a revision.
    pub(super) fn node(&self, revision: u64) -> Option<u64> {
        if revision == self.start {
            return Some(revision);
        }
        self.step(revision).map(node)
    }

    fn step(&self, revision: u64) -> Option<&MachineStep> {
        let index = self.steps.binary_search_by_key(&revision, |step| step.revision).ok()?;
        self.steps.get(index)
    }

    /// How many steps of others than `author` are taken away on the way from one revision to another, by who made them.
    pub(super) fn taken_away(&self, author: &str, from: u64, to: u64) -> BTreeMap<&str, usize> {
        let stays: BTreeSet<u64> = self.way(to).map(|step| step.revision).collect();
        let goes = self.way(from).take_while(|step| !stays.contains(&step.revision));
        let mut taken = BTreeMap::new();
        for step in goes.filter(|step| step.author != author) {
            *taken.entry(step.author.as_str()).or_default() += 1;
        }
        taken
    }

    /// The steps that lead from a revision's node back to the start, as far as they are known.
    fn way(&self, revision: u64) -> impl Iterator<Item = &MachineStep> {
        let step_to = |revision: u64| self.step(self.node(revision)?);
        std::iter::successors(step_to(revision), move |step| step_to(step.revision - 1))
    }
}

fn node(step: &MachineStep) -> u64 {
    step.same_as.unwrap_or(step.revision)
}

#[cfg(test)]
mod tests {
    use super::{Fingerprint, MACHINES_MAX, MachineHistoryTree, STEPS_MAX};
    use proptest::prelude::*;
    use rafcon_model::edit::apply;
    use rafcon_model::{BuiltinTypes, Machine};
    use rafcon_protocol::api::{MachineStep, RevisionKind};
    use rafcon_protocol::document::changes;
    use rafcon_testkit::edits::{Dice, edit};
    use rafcon_testkit::notation;

    fn machine(name: usize) -> Machine {
        notation::parse(&format!("execution ROOT \"{name}\"")).expect("a machine")
    }

    fn step(
        past: &mut MachineHistoryTree,
        revision: u64,
        author: &str,
        machine: &Machine,
        mark: Fingerprint,
    ) {
        let same_as = past.same_as(machine, mark);
        let (id, name) = (String::new(), revision.to_string());
        let author = author.to_owned();
        let kind = RevisionKind::Edit;
        let step =
            MachineStep { revision, id, author, name, at_ms: 0, kind, same_as, is_kept: false };
        past.push(step, machine, mark);
    }

    #[test]
    fn what_is_kept_is_bounded_and_the_start_stays() {
        let mut past = MachineHistoryTree::of(machine(0), 5);
        let last = STEPS_MAX + 2;
        for number in 1..=last {
            let mark = Fingerprint(number as u128);
            step(&mut past, 5 + number as u64, "ann", &machine(number), mark);
        }
        let told = past.steps();
        assert_eq!((told.start, told.steps.len()), (5, STEPS_MAX));
        assert_eq!(told.steps.iter().filter(|step| step.is_kept).count(), MACHINES_MAX);
        assert_eq!(past.machine(5), Some((5, &machine(0))));
        assert_eq!(past.machine(6), None);
        let last = 5 + last as u64;
        assert!(past.machine(last - 900).is_some() && past.machine(last - 1100).is_none());
        assert_eq!(past.taken_away("bob", last, 5).get("ann"), Some(&STEPS_MAX));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        /// A mark does not depend on the way: equal machines have one, others have others.
        #[test]
        fn marks_tell_machines_apart(numbers in proptest::collection::vec(any::<u16>(), 0..600)) {
            let start = notation::parse("hierarchy ROOT\n  barrier BBBBBB\n    decider unique_decider_state_id").unwrap();
            let (mut dice, mut now) = (Dice::new(numbers), start.clone());
            let mut mark = Fingerprint::default();
            while !dice.is_empty() {
                let mut next = now.clone();
                if apply(&mut next, edit(&now, &mut dice), &BuiltinTypes).is_ok() {
                    mark = mark.after(&now, &next, &changes(&now, &next));
                    now = next;
                }
                let direct = Fingerprint::default().after(&start, &now, &changes(&start, &now));
                prop_assert_eq!(mark, direct);
                prop_assert_eq!(mark == Fingerprint::default(), now == start);
            }
        }
    }
}
