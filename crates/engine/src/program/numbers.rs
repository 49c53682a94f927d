//! Assigns numbers to states. A state keeps its number while its id and its parent are unchanged.

use super::Program;
use super::compile::index;
use super::node::{Body, Node};
use super::tables::Exits;
use crate::NodeId;
use rafcon_model::{Container, State, StateId};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Numbers of the program that is being compiled.
pub(super) struct Numbers<'p, D> {
    before: Option<&'p Program<D>>,
    /// The lowest number that was never used.
    next: u32,
    /// The root of each library content of this program, by address. Never iterated.
    contents: BTreeMap<*const State, NodeId>,
    /// The roots of the library contents of the earlier program, by address.
    earlier: BTreeMap<*const State, NodeId>,
    /// States removed before the earlier program, by parent and id.
    former: BTreeMap<(NodeId, StateId), NodeId>,
    /// Numbers of the earlier program that are now used for roots of contents.
    taken: BTreeSet<NodeId>,
}

impl<'p, D> Numbers<'p, D> {
    pub(super) fn new(before: Option<&'p Program<D>>) -> Self {
        let mut numbers = Self {
            before,
            next: before.map_or(1, |before| index(before.nodes.len())),
            contents: BTreeMap::new(),
            earlier: BTreeMap::new(),
            former: BTreeMap::new(),
            taken: BTreeSet::new(),
        };
        let nodes = before.map(|before| before.nodes.as_slice()).unwrap_or_default();
        for (number, node) in (0..).map(NodeId).zip(nodes).skip(1) {
            numbers.know(number, node);
        }
        numbers
    }

    fn know(&mut self, number: NodeId, node: &Node<D>) {
        match node.parent {
            None => {
                self.earlier.insert(Arc::as_ptr(&node.state), number);
            }
            Some(parent) if node.gone => {
                self.former.insert((parent, node.id().clone()), number);
            }
            Some(_) => {}
        }
    }

    fn fresh(&mut self) -> NodeId {
        self.next += 1;
        NodeId(self.next - 1)
    }

    /// The earlier node with this number.
    fn earlier(&self, number: NodeId) -> Option<&'p Node<D>> {
        self.before?.nodes.get(number.index())
    }

    /// The number of each child of this container.
    pub(super) fn children(&mut self, parent: NodeId, container: &Container) -> Vec<NodeId> {
        let before = self.before;
        let inside = match self.earlier(parent).map(|node| &node.body) {
            Some(Body::Hierarchy(inside) | Body::Concurrency(_, inside)) => &*inside.children,
            Some(Body::Script | Body::Library(_)) | None => &[],
        };
        let id = |child: &NodeId| Some((before?.node(*child).id(), *child));
        let stood: BTreeMap<_, _> = inside.iter().filter_map(id).collect();
        let mut number = |id: &StateId| match stood.get(id) {
            Some(number) => *number,
            None if self.former.is_empty() => self.fresh(),
            None => {
                let former = self.former.get(&(parent, id.clone())).copied();
                former.unwrap_or_else(|| self.fresh())
            }
        };
        container.states.keys().map(&mut number).collect()
    }

    /// The number of a library content's root; true if the content is new in this program.
    pub(super) fn content(&mut self, library: NodeId, root: &Arc<State>) -> (NodeId, bool) {
        let address = Arc::as_ptr(root);
        if let Some(number) = self.contents.get(&address) {
            return (*number, false);
        }
        let same = self.earlier.get(&address).copied();
        let stood = same.or_else(|| self.root_before(library, &root.id));
        let number = stood.filter(|number| self.taken.insert(*number));
        let number = number.unwrap_or_else(|| self.fresh());
        self.contents.insert(address, number);
        (number, true)
    }

    /// The earlier root of this library state, if it has this id.
    fn root_before(&self, library: NodeId, id: &StateId) -> Option<NodeId> {
        match &self.earlier(library)?.body {
            Body::Library(content) => {
                content.root().filter(|root| self.earlier(*root).is_some_and(|r| r.id() == id))
            }
            Body::Script | Body::Hierarchy(_) | Body::Concurrency(..) => None,
        }
    }

    /// The nodes by number. Removed states keep a placeholder.
    pub(super) fn finish(&self, made: Vec<(NodeId, Node<D>)>) -> Vec<Node<D>> {
        let mut made: BTreeMap<_, _> = made.into_iter().collect();
        let gone = |number| self.earlier(number).map(placeholder);
        (0..self.next).map(NodeId).filter_map(|n| made.remove(&n).or_else(|| gone(n))).collect()
    }
}

/// The placeholder for a removed state, which keeps its names.
fn placeholder<D>(node: &Node<D>) -> Node<D> {
    Node {
        state: Arc::clone(&node.state),
        parent: node.parent,
        child_index: node.child_index,
        gone: true,
        outcomes: node.outcomes.clone(),
        exits: Exits::default(),
        plain_outcomes: node.plain_outcomes,
        body: Body::Script,
        inputs: Box::default(),
        constant_inputs: None,
        outputs: Arc::new([]),
        bad_outputs: Box::default(),
        gather: super::FlowRange::default(),
        scatter: super::FlowRange::default(),
        input_checks: super::Checks::default(),
        output_checks: super::Checks::default(),
        error_input: None,
        loss: None,
    }
}
