//! Small random machines with lost-link policies, as text for the engine and as a table for the oracle.

use std::collections::BTreeMap;

/// Limit of the nesting depth.
const DEPTH: usize = 3;
/// Times of policies in ms; `None` omits the entry.
const TIMES: [Option<u64>; 6] = [None, Some(10), None, Some(20), Some(30), None];

/// Numbers that a test has drawn; zeros follow after the last.
pub(super) struct Choices<'c>(pub(super) std::slice::Iter<'c, u8>);

impl Choices<'_> {
    pub(super) fn below(&mut self, limit: usize) -> usize {
        usize::from(self.0.next().copied().unwrap_or_default()) % limit
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Script,
    Hierarchy,
    Barrier,
    Race,
}

/// Times of one policy, in ms.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Policy {
    pub(super) finish: Option<u64>,
    pub(super) hold: Option<u64>,
    pub(super) recover: Option<u64>,
}

/// The oracle's view of a state.
#[derive(Debug)]
pub(super) struct StateFacts {
    pub(super) kind: Kind,
    /// Policies for the link, then for commands.
    pub(super) policies: [Option<Policy>; 2],
    /// Path of the sibling that follows the outcome *preempted*.
    pub(super) recovery: Option<String>,
}

/// A machine and its states by path.
#[derive(Debug, Default)]
pub(super) struct RandomMachine {
    pub(super) text: String,
    pub(super) states: BTreeMap<String, StateFacts>,
}

impl RandomMachine {
    pub(super) fn new(choices: &mut Choices<'_>) -> Self {
        let mut machine = Self::default();
        machine.state("ROOT", 0, choices);
        machine
    }

    fn state(&mut self, path: &str, depth: usize, choices: &mut Choices<'_>) {
        let kind = match (depth, choices.below(8)) {
            (0, _) | (1..DEPTH, 4 | 5) => Kind::Hierarchy,
            (1..DEPTH, 6) => Kind::Barrier,
            (1..DEPTH, 7) => Kind::Race,
            _ => Kind::Script,
        };
        let policies = [0, 1].map(|loss| policy(loss, choices));
        let word = match kind {
            Kind::Script => "execution",
            Kind::Hierarchy => "hierarchy",
            Kind::Barrier => "barrier",
            Kind::Race => "preemptive",
        };
        let id = path.rsplit('/').next().unwrap_or(path);
        self.line(depth, &format!("{word} {id}"));
        self.line(depth + 1, "outcome ok");
        self.line(depth + 1, &semantic_data(policies));
        let facts = StateFacts { kind, policies, recovery: None };
        self.states.insert(path.to_owned(), facts);
        let count = if kind == Kind::Script { 0 } else { 1 + choices.below(3) };
        let ids: Vec<_> = (0..count).map(|index| format!("{id}{index}")).collect();
        for id in &ids {
            self.state(&format!("{path}/{id}"), depth + 1, choices);
        }
        match kind {
            Kind::Script => {}
            Kind::Hierarchy => self.lead_on(path, depth + 1, &ids, choices),
            Kind::Barrier => self.decide(path, depth + 1),
            Kind::Race => {
                for id in &ids {
                    self.line(depth + 1, &format!("{id}.ok -> .ok"));
                }
            }
        }
    }

    fn lead_on(&mut self, path: &str, depth: usize, ids: &[String], choices: &mut Choices<'_>) {
        self.line(depth, &format!("start -> {}", ids[0]));
        for (index, id) in ids.iter().enumerate() {
            let next = ids.get(index + 1).map_or(".ok", String::as_str);
            self.line(depth, &format!("{id}.ok -> {next}"));
            for outcome in ["preempted", "aborted"] {
                let Some(target) = ids.get(choices.below(ids.len() + 1)) else { continue };
                self.line(depth, &format!("{id}.{outcome} -> {target}"));
                let facts = self.states.get_mut(&format!("{path}/{id}"));
                if let Some(facts) = facts.filter(|_| outcome == "preempted") {
                    facts.recovery = Some(format!("{path}/{target}"));
                }
            }
        }
    }

    fn decide(&mut self, path: &str, depth: usize) {
        self.line(depth, "unique_decider_state_id.ok -> .ok");
        self.line(depth, "decider unique_decider_state_id");
        self.line(depth + 1, "outcome ok");
        let facts = StateFacts { kind: Kind::Script, policies: [None; 2], recovery: None };
        self.states.insert(format!("{path}/unique_decider_state_id"), facts);
    }

    fn line(&mut self, indent: usize, line: &str) {
        self.text += &"  ".repeat(indent);
        self.text += line;
        self.text.push('\n');
    }
}

/// A random policy: often `None`, sometimes `continue`, which has no times.
fn policy(loss: usize, choices: &mut Choices<'_>) -> Option<Policy> {
    if choices.below(4 + 8 * loss) > 1 {
        return None;
    }
    let [finish, hold, recover] = [(); 3].map(|()| TIMES[choices.below(TIMES.len())]);
    Some(Policy { finish, hold, recover })
}

fn semantic_data(policies: [Option<Policy>; 2]) -> String {
    let entries = ["lost_link", "lost_command"].iter().zip(policies).filter_map(|(key, policy)| {
        let Policy { finish, hold, recover } = policy?;
        let times = [("finish_s", finish), ("hold_s", hold), ("recover_s", recover)];
        let seconds = |ms: u64| format!("0.0{}", ms / 10);
        let times =
            times.into_iter().filter_map(|(key, ms)| Some(format!("\"{key}\": {}", seconds(ms?))));
        let times: Vec<_> = times.collect();
        let policy = if times.is_empty() {
            "\"continue\"".to_owned()
        } else {
            format!("{{{}}}", times.join(", "))
        };
        Some(format!("\"{key}\": {policy}"))
    });
    let entries: Vec<_> = entries.collect();
    if entries.is_empty() { String::new() } else { format!("semantic {{{}}}", entries.join(", ")) }
}
