//! Checks that a restored configuration exists in the program, completely and before anything changes.

use crate::engine::Refusal;
use crate::program::{Body, Concurrency, Node};
use crate::{ActiveStateData, NodeId, Program};
use rafcon_model::{StateId, StatePath};
use smol_str::{SmolStr, format_smolstr};

/// A state to check, with its node and the index of its parent.
struct FittedState<'r, D> {
    restored: &'r ActiveStateData<D>,
    node: NodeId,
    around: Option<usize>,
}

/// Every active state, its inputs and the child that decides its next step must exist.
pub(in crate::engine) fn fits<D>(
    program: &Program<D>,
    root: &ActiveStateData<D>,
) -> Result<(), Refusal> {
    let mut entries = vec![FittedState { restored: root, node: Program::<D>::ROOT, around: None }];
    if program.node(Program::<D>::ROOT).id() != &root.state {
        return Err(refusal(&entries, 0, "is not the root of the machine".into()));
    }
    let mut next = 0;
    while let Some(FittedState { restored, node, .. }) = entries.get(next) {
        let (restored, node) = (*restored, program.node(*node));
        if let Some(problem) = problem(program, node, restored) {
            return Err(refusal(&entries, next, problem));
        }
        for child in &restored.children {
            let found = program.child_of(node, &child.state).map(|(_, node)| node);
            let node = found.unwrap_or(Program::<D>::ROOT);
            entries.push(FittedState { restored: child, node, around: Some(next) });
            if found.is_none() {
                let problem = "does not exist in the machine as it is now";
                return Err(refusal(&entries, entries.len() - 1, problem.into()));
            }
        }
        next += 1;
    }
    Ok(())
}

fn refusal<D>(entries: &[FittedState<'_, D>], entry: usize, problem: SmolStr) -> Refusal {
    let mut ids = Vec::new();
    let mut next = Some(entry);
    while let Some(entry) = next.and_then(|entry| entries.get(entry)) {
        ids.push(entry.restored.state.clone());
        next = entry.around;
    }
    ids.reverse();
    Refusal::CannotRestore { path: StatePath(ids), problem }
}

/// Describes the problem of one state.
fn problem<D>(
    program: &Program<D>,
    node: &Node<D>,
    restored: &ActiveStateData<D>,
) -> Option<SmolStr> {
    let missing = |port: &&(_, D)| !node.inputs().iter().any(|own| own.id == port.0);
    if let Some((port, _)) = restored.inputs.iter().find(missing) {
        return Some(format_smolstr!("has no input {port} in the machine as it is now"));
    }
    let most = match &node.body {
        Body::Script => 0,
        Body::Hierarchy(_) | Body::Library(_) => 1,
        Body::Concurrency(_, inside) => inside.children.len(),
    };
    if restored.children.len() > most {
        return Some(format_smolstr!(
            "cannot have {} active states inside",
            restored.children.len()
        ));
    }
    match &node.body {
        Body::Hierarchy(_) if restored.children.is_empty() => last(program, node, restored),
        Body::Concurrency(kind, _) => branches(program, node, *kind, restored),
        Body::Script | Body::Hierarchy(_) | Body::Library(_) => None,
    }
}

/// The child whose transition is next must exist, with its outcome.
fn last<D>(program: &Program<D>, node: &Node<D>, restored: &ActiveStateData<D>) -> Option<SmolStr> {
    let last = restored.last.as_ref()?;
    let Some(end) = restored.ended.iter().rfind(|end| end.state == *last) else {
        return Some(format_smolstr!("ended its child '{last}' in a way that is not known"));
    };
    let child = program.child_of(node, last).map(|(_, child)| program.node(child));
    let known = child.is_some_and(|child| child.outcome(end.outcome).is_some());
    let outcome = end.outcome.0;
    (!known).then(|| {
        format_smolstr!(
            "has no child '{last}' with an outcome {outcome} in the machine as it is now"
        )
    })
}

fn branches<D>(
    program: &Program<D>,
    node: &Node<D>,
    kind: Concurrency,
    restored: &ActiveStateData<D>,
) -> Option<SmolStr> {
    let index = |id: &StateId| program.child_of(node, id).map(|(index, _)| index);
    let mut active: Vec<_> = restored.children.iter().map(|child| index(&child.state)).collect();
    active.sort_unstable();
    if active.windows(2).any(|pair| pair[0] == pair[1]) {
        return Some("cannot have one state active twice inside".into());
    }
    let decides = kind.decider().is_some_and(|decider| active.contains(&Some(decider)));
    let open = (0..node.child_count()).filter(|&child| Some(child) != kind.decider());
    let ended: Vec<_> = restored.ended.iter().map(|end| index(&end.state)).collect();
    let mut open = open.filter(|&child| !ended.contains(&Some(child)));
    if decides && (active.len() > 1 || open.next().is_some()) {
        return Some("cannot decide while its branches have not ended".into());
    }
    let unknown = restored.ended.iter().find(|end| {
        let child = program.child_of(node, &end.state).map(|(_, child)| program.node(child));
        child.is_none_or(|child| child.outcome(end.outcome).is_none())
    })?;
    let (state, outcome) = (&unknown.state, unknown.outcome.0);
    Some(format_smolstr!(
        "has no branch '{state}' with an outcome {outcome} in the machine as it is now"
    ))
}
