//! Builds a tree of states: orders them, replaces duplicate ids, adds the content of libraries. Uses the locations of the states
//! for reports, and reads no files.

use super::file_of;
use super::library_content::Contents;
use super::state_files::Node;
use crate::files::{Part, StateFolder};
use crate::libraries::{Libraries, Loading};
use crate::problem::{Fault, LoadProblem};
use rafcon_model::{
    Container, DataFlow, DataFlows, Kind, State, StateId, StatePath, Transition, Transitions,
};
use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::OsStrExt as _;
use std::path::PathBuf;
use std::sync::Arc;

/// The tree, the folders of its states, and the problems found.
#[derive(Debug)]
pub(crate) struct Assembled {
    pub(crate) root: Arc<State>,
    pub(crate) place: StateFolder,
    pub(crate) problems: Vec<LoadProblem>,
}

/// A state with its children.
struct Built {
    number: usize,
    state: State,
    place: StateFolder,
    linked: bool,
}

/// Facts about each node by its number, to report the places of faults.
#[derive(Default)]
struct NodePaths {
    parents: Vec<Option<usize>>,
    ids: Vec<StateId>,
    folders: Vec<OsString>,
    faults: Vec<(usize, Part, Fault)>,
}

/// Makes the tree of all nodes. There is at least the root, with number 0.
pub(crate) fn assemble(
    mut nodes: Vec<Node>,
    libraries: &Libraries,
    loading: &Loading<'_>,
) -> Assembled {
    nodes.sort_unstable_by_key(|node| node.number);
    let mut trail = NodePaths::of(&nodes);
    let mut contents = Contents::new(libraries, loading);
    let mut inside: Vec<Vec<Built>> = Vec::new();
    inside.resize_with(nodes.len(), Vec::new);
    let mut root = None;
    while let Some(node) = nodes.pop() {
        let children = inside.pop().unwrap_or_default();
        let parent = node.parent;
        let built = build(node, children, &mut trail, &mut contents);
        match parent.and_then(|number| inside.get_mut(number)) {
            Some(siblings) => siblings.push(built),
            None => root = Some(built),
        }
    }
    let (mut root, place) = root.map_or_else(nothing, |built| (built.state, built.place));
    super::library_content::ports_of_missing(&mut root, &DataFlows::default());
    Assembled { root: Arc::new(root), place, problems: trail.problems() }
}

/// No nodes give an empty hierarchy; callers have at least a root.
fn nothing() -> (State, StateFolder) {
    let state = State::new(StateId::new("ROOT"), "root", Kind::Hierarchy(Container::default()));
    (state, StateFolder::new(OsString::new(), Vec::new()))
}

fn build(
    node: Node,
    mut children: Vec<Built>,
    trail: &mut NodePaths,
    contents: &mut Contents<'_>,
) -> Built {
    let Node { number, folder, mut state, faults, oddities, linked, .. } = node;
    trail.faults.extend(faults.into_iter().map(|(part, fault)| (number, part, fault)));
    if matches!(state.kind, Kind::Library(_)) {
        let faults = contents.fill(&mut state);
        trail.faults.extend(faults.into_iter().map(|fault| (number, Part::Core, fault)));
    }
    settle_ids(&mut children, &state.id, trail);
    let mut places = Vec::with_capacity(children.len());
    if let Some(container) = state.container_mut() {
        let mut states = Vec::with_capacity(children.len());
        for Built { mut state, place, number, .. } in children {
            super::library_content::ports_of_missing(&mut state, &container.data_flows);
            trail.ids[number] = state.id.clone();
            places.push((state.id.clone(), place));
            states.push((state.id.clone(), Arc::new(state)));
        }
        container.states = states.into_iter().collect();
    }
    trail.ids[number] = state.id.clone();
    Built { number, state, place: StateFolder::new(folder, places).with(oddities), linked }
}

/// Sorts children by id. A state with a duplicate id receives a new id, which is deterministic.
fn settle_ids(children: &mut [Built], parent: &StateId, trail: &mut NodePaths) {
    children.sort_by(|a, b| key(a).cmp(&key(b)));
    let mut taken = BTreeSet::from([parent.clone()]);
    for index in 0..children.len() {
        let old = children[index].state.id.clone();
        let again = index > 0 && children[index - 1].state.id == old;
        if !again && old != *parent {
            continue;
        }
        if taken.len() == 1 {
            taken.extend(children.iter().map(|child| child.state.id.clone()));
        }
        let child = &mut children[index];
        let new = fresh_id(&child.place.folder, &taken);
        taken.insert(new.clone());
        trail.faults.push((child.number, Part::Core, Fault::TakenId { old, new: new.clone() }));
        rename(&mut child.state, &new);
        if !child.linked {
            child.place.mark_stale();
        }
    }
    children.sort_by(|a, b| a.state.id.cmp(&b.state.id));
}

/// Sort key of a child. Among states with one id, the state whose folder name ends with the id keeps it.
fn key(child: &Built) -> (&StateId, bool, &OsStr) {
    let folder = &child.place.folder;
    let is_own = folder.as_bytes().ends_with(child.state.id.as_str().as_bytes());
    (&child.state.id, !is_own, folder)
}

/// Six letters derived from the folder's name.
fn fresh_id(folder: &OsStr, taken: &BTreeSet<StateId>) -> StateId {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for byte in folder.as_bytes() {
        hash = (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
    }
    loop {
        let letter =
            |n: u32| char::from(b'A' + u8::try_from(hash / 26_u64.pow(n) % 26).unwrap_or(0));
        let id = StateId::new((0..6).map(letter).collect::<String>());
        if !taken.contains(&id) {
            return id;
        }
        hash = hash.wrapping_add(1);
    }
}

/// Changes the id of the state, and updates its own transitions and data flows.
fn rename(state: &mut State, new: &StateId) {
    let old = std::mem::replace(&mut state.id, new.clone());
    let Some(container) = state.container_mut() else { return };
    let swap = |id: &StateId| if *id == old { new.clone() } else { id.clone() };
    let mut transitions = Transitions::default();
    for transition in container.transitions.iter() {
        let to_state = transition.to_state.as_ref().map(swap);
        transitions.insert(Transition { to_state, ..transition.clone() });
    }
    let mut flows = DataFlows::default();
    for flow in container.data_flows.iter() {
        let (from_state, to_state) = (swap(&flow.from_state), swap(&flow.to_state));
        flows.insert(DataFlow { from_state, to_state, ..flow.clone() });
    }
    container.transitions = transitions;
    container.data_flows = flows;
}

impl NodePaths {
    fn of(nodes: &[Node]) -> Self {
        Self {
            parents: nodes.iter().map(|node| node.parent).collect(),
            ids: nodes.iter().map(|node| node.state.id.clone()).collect(),
            folders: nodes.iter().map(|node| node.folder.clone()).collect(),
            faults: Vec::new(),
        }
    }

    /// Numbers from the root down to `number`.
    fn chain(&self, number: usize) -> Vec<usize> {
        let mut chain = vec![number];
        let mut at = number;
        while let Some(parent) = self.parents.get(at).copied().flatten() {
            chain.push(parent);
            at = parent;
        }
        chain.reverse();
        chain
    }

    fn problems(mut self) -> Vec<LoadProblem> {
        let faults = std::mem::take(&mut self.faults);
        let problem = |(number, part, fault)| {
            let chain = self.chain(number);
            let folder: PathBuf = chain.iter().map(|number| &self.folders[*number]).collect();
            let state =
                StatePath(chain.into_iter().map(|number| self.ids[number].clone()).collect());
            LoadProblem { state, file: file_of(&folder, part), fault }
        };
        let mut problems: Vec<_> = faults.into_iter().map(problem).collect();
        problems.sort_by(|a, b| (&a.state, &a.file).cmp(&(&b.state, &b.file)));
        problems
    }
}
