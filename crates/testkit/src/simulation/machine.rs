//! Random machines in text notation: nested, concurrent, with libraries, many of them faulty.

use crate::random::Random;

/// Maximum depth of machines.
const DEPTH: usize = 4;
/// Outcomes of every state, besides the mandatory ones.
pub(crate) const OUTCOMES: [&str; 2] = ["a", "b"];
/// Input of every state, with the id 0.
pub(crate) const INPUT: &str = "x";
/// Output of every state, with the id 1.
pub(crate) const OUTPUT: &str = "y";

const LOSSES: [&str; 2] = ["lost_link", "lost_command"];
/// Policies of states for a lost link.
const POLICIES: [&str; 4] = [
    "\"continue\"",
    "{\"finish_s\": 0.01}",
    "{\"hold_s\": 0.02}",
    "{\"finish_s\": 0.01, \"recover_s\": 0.02}",
];

/// State of the generation of a machine.
#[derive(Debug)]
pub(crate) struct Generator<'r> {
    random: &'r mut Random,
    states: usize,
    /// True if the outcome preempted may be connected.
    handlers: bool,
    text: String,
}

/// A random machine, in the text notation.
pub(crate) fn machine(random: &mut Random, handlers: bool) -> String {
    let mut generator = Generator { random, states: 0, handlers, text: String::new() };
    generator.state("ROOT", 0, 0);
    generator.text
}

impl Generator<'_> {
    fn line(&mut self, indent: usize, line: &str) {
        self.text += &" ".repeat(indent);
        self.text += line;
        self.text.push('\n');
    }

    fn fresh(&mut self) -> String {
        self.states += 1;
        format!("S{}", self.states)
    }

    fn state(&mut self, id: &str, depth: usize, indent: usize) {
        // The root is always a container.
        let choice = match depth {
            0 => 4 + self.random.below(8),
            DEPTH.. => 0,
            _ => self.random.below(12),
        };
        match choice {
            0..=3 => self.execution("execution", id, indent),
            4..=7 => self.hierarchy(id, depth, indent),
            8 => self.barrier(id, depth, indent),
            9 | 10 => self.preemptive(id, depth, indent),
            _ => self.library(id, depth, indent),
        }
    }

    fn execution(&mut self, kind: &str, id: &str, indent: usize) {
        self.line(indent, &format!("{kind} {id}"));
        self.face(indent + 1);
    }

    /// Writes the common outcomes and ports of all states, so that any two states can be connected.
    fn face(&mut self, indent: usize) {
        for outcome in OUTCOMES {
            self.line(indent, &format!("outcome {outcome}"));
        }
        self.line(indent, &format!("in {INPUT}: int = 1"));
        self.line(indent, &format!("out {OUTPUT}: int = 2"));
        if self.random.percent(10) {
            self.line(indent, "in error: object");
        }
        if self.random.percent(15) {
            let key = LOSSES[self.random.below(LOSSES.len())];
            let policy = POLICIES[self.random.below(POLICIES.len())];
            self.line(indent, &format!("semantic {{\"{key}\": {policy}}}"));
        }
    }

    fn children(&mut self, depth: usize, indent: usize) -> Vec<String> {
        let count = if self.random.percent(5) { 0 } else { 1 + self.random.below(4) };
        let ids: Vec<_> = (0..count).map(|_| self.fresh()).collect();
        for id in &ids {
            self.state(id, depth + 1, indent);
        }
        ids
    }

    fn hierarchy(&mut self, id: &str, depth: usize, indent: usize) {
        self.line(indent, &format!("hierarchy {id}"));
        self.face(indent + 1);
        let fault = if self.random.percent(3) { "\"none\"" } else { "3" };
        self.line(indent + 1, &format!("var v: int = {fault}"));
        let children = self.children(depth, indent + 1);
        if self.random.percent(95) {
            let start = self.target(&children);
            self.line(indent + 1, &format!("start -> {start}"));
        }
        for child in &children {
            self.transitions(child, &children, indent + 1);
            self.flows(child, &children, indent + 1);
        }
        self.line(indent + 1, "flow .x -> .v ; .v -> .y");
    }

    fn transitions(&mut self, child: &str, children: &[String], indent: usize) {
        let preempted = if self.handlers { 40 } else { 0 };
        for (outcome, chance) in [("a", 95), ("b", 95), ("aborted", 50), ("preempted", preempted)] {
            if self.random.percent(chance) {
                let target = self.target(children);
                self.line(indent, &format!("{child}.{outcome} -> {target}"));
            }
        }
    }

    /// A child or an outcome of the container.
    fn target(&mut self, children: &[String]) -> String {
        let outcome = children.is_empty() || self.random.percent(10);
        if outcome {
            format!(".{}", OUTCOMES[self.random.below(OUTCOMES.len())])
        } else {
            children[self.random.below(children.len())].clone()
        }
    }

    fn flows(&mut self, child: &str, children: &[String], indent: usize) {
        let other = children[self.random.below(children.len())].clone();
        let flows = [
            format!("flow .x -> {child}.x"),
            format!("flow .v -> {child}.x"),
            format!("flow {child}.y -> .v"),
            format!("flow {child}.y -> {other}.x"),
        ];
        for flow in flows {
            if self.random.percent(40) {
                self.line(indent, &flow);
            }
        }
    }

    fn barrier(&mut self, id: &str, depth: usize, indent: usize) {
        self.line(indent, &format!("barrier {id}"));
        self.face(indent + 1);
        let children = self.children(depth, indent + 1);
        if self.random.percent(3) {
            return;
        }
        for child in &children {
            self.line(indent + 1, &format!("flow {child}.y -> unique_decider_state_id.x"));
        }
        self.execution("decider", "unique_decider_state_id", indent + 1);
        self.ends("unique_decider_state_id", indent + 1);
    }

    fn preemptive(&mut self, id: &str, depth: usize, indent: usize) {
        self.line(indent, &format!("preemptive {id}"));
        self.face(indent + 1);
        for child in self.children(depth, indent + 1) {
            self.line(indent + 1, &format!("flow .x -> {child}.x ; {child}.y -> .y"));
            self.ends(&child, indent + 1);
        }
    }

    /// Writes the transitions of a child of a concurrency state.
    fn ends(&mut self, child: &str, indent: usize) {
        for outcome in ["a", "b", "aborted"] {
            if self.random.percent(85) {
                self.line(indent, &format!("{child}.{outcome} -> .b"));
            }
        }
    }

    fn library(&mut self, id: &str, depth: usize, indent: usize) {
        self.line(indent, &format!("library {id} from \"some/library\""));
        if self.random.percent(5) {
            self.face(indent + 1);
            self.line(indent + 1, "missing \"it is gone\"");
            return;
        }
        self.line(indent + 1, "content");
        let root = self.fresh();
        self.state(&root, depth + 1, indent + 2);
    }
}
