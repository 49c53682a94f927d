//! Finds all faults of a machine. Knows the way through the tree; the rules themselves are in
//! [`rules`](crate::rules).

use crate::rules::{
    Fault, MAX_NESTING, Part, PoliciesAround, Rule, Severity, errors_of, faults_of, parts, traps,
};
use crate::{Container, Kind, LibraryContent, Machine, Origin, State, StateId, StatePath, Types};
use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

/// A rule that a part of the machine breaks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The path of the state. Inside a library: below the first state that uses it.
    pub path: StatePath,
    /// The part of the state.
    pub part: Part,
    /// The broken rule, with severity and remedy.
    pub rule: Rule,
    /// The fault, for the user.
    pub what: String,
}

impl Problem {
    /// Severity of the problem.
    pub fn severity(&self) -> Severity {
        self.rule.severity()
    }

    /// The remedy for the user.
    pub fn way_out(&self) -> &'static str {
        self.rule.way_out()
    }

    pub(crate) fn new(path: &StatePath, part: Part, fault: Fault) -> Self {
        Self { path: path.clone(), part, rule: fault.rule, what: fault.what }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, part, what, .. } = self;
        write!(f, "{path}, {part}: {what}; {}", self.way_out())
    }
}

/// Every rule that the machine breaks, state by state from the root down. Never fails and never panics, also for a machine that is
/// broken in every part. Checks the content of a library once, however many states use it.
///
/// ```
/// use rafcon_model::{BuiltinTypes, problems};
/// use rafcon_testkit::notation;
///
/// let machine = notation::parse("hierarchy ROOT\n  start -> AAAAAA")?;
/// let problems = problems(&machine, &BuiltinTypes);
/// assert_eq!(
///     problems[0].to_string(),
///     "ROOT, transition 1: it leads to AAAAAA, which does not exist; \
///      connect the end with a child or an outcome of the container, or remove the transition"
/// );
/// # Ok::<(), notation::NotationError>(())
/// ```
pub fn problems(machine: &Machine, types: &dyn Types) -> Vec<Problem> {
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    let mut open = vec![Visit {
        path: StatePath::root(machine.root.id.clone()),
        parent: None,
        state: &machine.root,
        around: PoliciesAround::default(),
    }];
    while let Some(visit) = open.pop() {
        visit.look(types, &mut found);
        if visit.path.0.len() < MAX_NESTING {
            visit.go_on(&mut seen, &mut open);
        }
    }
    found
}

/// The first problem that forbids a state below `parent`, in it or anywhere inside except in libraries.
pub(crate) fn refusal(
    parent: &State,
    path: &StatePath,
    state: &State,
    types: &dyn Types,
) -> Option<Problem> {
    let around = PoliciesAround::default();
    let mut open = vec![Visit { path: path.clone(), parent: Some(parent), state, around }];
    while let Some(visit) = open.pop() {
        for part in parts(visit.state) {
            let faults = errors_of(visit.parent, visit.state, part, types);
            let fault = faults.into_iter().find(|fault| fault.rule.refuses_edits());
            if let Some(fault) = fault {
                return Some(Problem::new(&visit.path, part, fault));
            }
        }
        if visit.path.0.len() < MAX_NESTING {
            visit.children(&mut open);
        }
    }
    None
}

struct Visit<'m> {
    path: StatePath,
    parent: Option<&'m State>,
    state: &'m State,
    around: PoliciesAround<'m>,
}

impl Visit<'_> {
    fn look(&self, types: &dyn Types, found: &mut Vec<Problem>) {
        if let Some(fault) = self.nesting_fault() {
            found.push(Problem::new(&self.path, Part::State, fault));
        }
        for part in parts(self.state) {
            let faults = faults_of(self.parent, self.state, part, types);
            found.extend(faults.into_iter().map(|fault| Problem::new(&self.path, part, fault)));
        }
        let traps = traps(self.around, self.parent, self.state).into_iter();
        found.extend(traps.map(|fault| Problem::new(&self.path, Part::State, fault)));
        if let Kind::Hierarchy(container) = &self.state.kind {
            found.extend(unreachable(container).map(|child| {
                let fault = Fault::new(Rule::Unreachable, "no way leads to it from the start");
                Problem::new(&self.path.child(child.clone()), Part::State, fault)
            }));
        }
    }

    fn nesting_fault(&self) -> Option<Fault> {
        let full = self.path.0.len() >= MAX_NESTING;
        let inner = self.state.container().is_some_and(|c| !c.states.is_empty());
        let what = || format!("its children are nested deeper than {MAX_NESTING} levels");
        (full && inner).then(|| Fault::new(Rule::Nesting, what()))
    }

    fn children(&self, open: &mut Vec<Self>) {
        let around = self.around.within(self.state);
        let children = self.state.container().into_iter().flat_map(|c| c.states.values().rev());
        open.extend(children.map(|child| Self {
            path: self.path.child(child.id.clone()),
            parent: Some(self.state),
            state: child,
            around,
        }));
    }

    fn go_on(&self, seen: &mut BTreeSet<*const State>, open: &mut Vec<Self>) {
        self.children(open);
        if let Kind::Library(library) = &self.state.kind
            && let LibraryContent::Found(root) = &library.content
            && seen.insert(Arc::as_ptr(root))
        {
            let path = self.path.child(root.id.clone());
            let around = self.around.within(self.state);
            open.push(Self { path, parent: Some(self.state), state: root, around });
        }
    }
}

/// The children of a hierarchy that no transitions reach from its start. A missing start is a fault of its own.
fn unreachable(container: &Container) -> impl Iterator<Item = &StateId> {
    let start = container.transitions.from(&Origin::Income).next();
    let mut open: Vec<&StateId> =
        start.and_then(|start| start.to_state.as_ref()).into_iter().collect();
    let mut reached = BTreeSet::new();
    while let Some(id) = open.pop() {
        if reached.insert(id) {
            let leading = container.transitions.out_of_state(id);
            open.extend(leading.filter_map(|transition| transition.to_state.as_ref()));
        }
    }
    let is_lost = start.is_some();
    container.states.keys().filter(move |id| is_lost && !reached.contains(id))
}
