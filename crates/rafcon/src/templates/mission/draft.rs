//! A draft of a state, with names for children, outcomes and ports.
//!
//! Knows the syntax of drafts, but neither ids nor positions; `build` adds these.

use rafcon_model::Value;

/// A draft of a state.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    pub(super) name: String,
    pub(super) about: &'static str,
    pub(super) inputs: Vec<Slot>,
    pub(super) outputs: Vec<Slot>,
    /// The user's own outcomes; aborted and preempted are added automatically.
    pub(super) outcomes: Vec<String>,
    pub(super) inside: Inside,
}

/// Name and default of a port or scoped variable; its type is that of the default.
pub(super) type Slot = (&'static str, Value);

/// Content of a state, by kind.
#[derive(Debug, Clone)]
pub(super) enum Inside {
    Script(&'static str),
    Decider(&'static str),
    Hierarchy(Parts),
    Barrier(Parts),
    Preemptive(Parts),
}

/// Children and the lines between them. A hierarchy starts with its first child.
#[derive(Debug, Clone, Default)]
pub(super) struct Parts {
    pub(super) variables: Vec<Slot>,
    pub(super) children: Vec<Draft>,
    pub(super) transitions: Vec<TransitionDraft>,
    pub(super) data: Vec<FlowDraft>,
}

/// A transition from an outcome of a child.
#[derive(Debug, Clone)]
pub(super) struct TransitionDraft {
    pub(super) from: String,
    pub(super) outcome: String,
    pub(super) to: To,
}

/// Target of a transition.
#[derive(Debug, Clone)]
pub(super) enum To {
    Child(String),
    Outcome(String),
}

/// A data flow between two ports of equal name; `None` is the container itself.
#[derive(Debug, Clone)]
pub(super) struct FlowDraft {
    pub(super) port: &'static str,
    pub(super) from: Option<String>,
    pub(super) to: Option<String>,
}

impl Draft {
    /// An execution state that runs `script`.
    pub(super) fn script(name: impl Into<String>, script: &'static str) -> Self {
        Self::new(name, Inside::Script(script))
    }

    /// The decider of a barrier.
    pub(super) fn decider(script: &'static str) -> Self {
        Self::new(DECIDER, Inside::Decider(script))
    }

    pub(super) fn hierarchy(name: impl Into<String>, parts: Parts) -> Self {
        Self::new(name, Inside::Hierarchy(parts))
    }

    /// A barrier; every outcome of its children leads to the decider.
    pub(super) fn barrier(name: impl Into<String>, parts: Parts) -> Self {
        Self::new(name, Inside::Barrier(parts.all_to_the_decider()))
    }

    pub(super) fn preemptive(name: impl Into<String>, parts: Parts) -> Self {
        Self::new(name, Inside::Preemptive(parts))
    }

    fn new(name: impl Into<String>, inside: Inside) -> Self {
        let outcomes = vec!["success".to_owned()];
        Self { name: name.into(), about: "", inputs: vec![], outputs: vec![], outcomes, inside }
    }

    /// Sets the description of the state.
    pub(super) fn about(mut self, text: &'static str) -> Self {
        self.about = text;
        self
    }

    /// One more input port.
    pub(super) fn input(mut self, name: &'static str, default: Value) -> Self {
        self.inputs.push((name, default));
        self
    }

    /// One more output port.
    pub(super) fn output(mut self, name: &'static str, default: Value) -> Self {
        self.outputs.push((name, default));
        self
    }

    /// Its own outcomes instead of `success`.
    pub(super) fn outcomes<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.outcomes = names.into_iter().map(Into::into).collect();
        self
    }
}

impl Draft {
    /// The children, if it has any.
    pub(super) fn children(&self) -> &[Self] {
        match &self.inside {
            Inside::Script(_) | Inside::Decider(_) => &[],
            Inside::Hierarchy(parts) | Inside::Barrier(parts) | Inside::Preemptive(parts) => {
                &parts.children
            }
        }
    }
}

/// Name of every decider.
pub(super) const DECIDER: &str = "Decider";

impl Parts {
    /// One more scoped variable.
    pub(super) fn variable(mut self, name: &'static str, default: Value) -> Self {
        self.variables.push((name, default));
        self
    }

    pub(super) fn child(mut self, child: Draft) -> Self {
        self.children.push(child);
        self
    }

    /// `outcome` of the child `from` leads to the child `to`.
    pub(super) fn go(self, from: &str, outcome: &str, to: &str) -> Self {
        self.line(from, outcome, To::Child(to.to_owned()))
    }

    /// `outcome` of the child `from` ends the container by its outcome `end`.
    pub(super) fn end(self, from: &str, outcome: &str, end: &str) -> Self {
        self.line(from, outcome, To::Outcome(end.to_owned()))
    }

    fn line(mut self, from: &str, outcome: &str, to: To) -> Self {
        self.transitions.push(TransitionDraft {
            from: from.to_owned(),
            outcome: outcome.to_owned(),
            to,
        });
        self
    }

    /// `success` of each child leads to the next one.
    pub(super) fn chain(mut self) -> Self {
        let names = self.children.iter().map(|child| child.name.clone()).collect::<Vec<_>>();
        for pair in names.windows(2) {
            self = self.go(&pair[0], "success", &pair[1]);
        }
        self
    }

    /// An input or scoped variable of the container flows into these children.
    pub(super) fn give(mut self, port: &'static str, children: &[&str]) -> Self {
        let flow = |child: &&str| FlowDraft { port, from: None, to: Some((*child).to_owned()) };
        self.data.extend(children.iter().map(flow));
        self
    }

    /// An output of a child flows into the scoped variable of the container, or into its output if there is none.
    pub(super) fn take(mut self, child: &str, port: &'static str) -> Self {
        self.data.push(FlowDraft { port, from: Some(child.to_owned()), to: None });
        self
    }

    /// An output of a child flows into an input of another.
    pub(super) fn pass(mut self, port: &'static str, from: &str, to: &str) -> Self {
        self.data.push(FlowDraft { port, from: Some(from.to_owned()), to: Some(to.to_owned()) });
        self
    }

    /// A scoped variable flows into an output of the container.
    pub(super) fn show(mut self, port: &'static str) -> Self {
        self.data.push(FlowDraft { port, from: None, to: None });
        self
    }

    fn all_to_the_decider(mut self) -> Self {
        let leads = |child: &&Draft| !matches!(child.inside, Inside::Decider(_));
        let ends = self.children.iter().filter(leads).flat_map(|child| {
            child.outcomes.iter().map(|outcome| (child.name.clone(), outcome.clone()))
        });
        for (from, outcome) in ends.collect::<Vec<_>>() {
            self = self.go(&from, &outcome, DECIDER);
        }
        self
    }
}
