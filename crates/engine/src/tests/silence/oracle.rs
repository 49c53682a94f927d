//! A second implementation of `docs/semantics.md`, Lost link. It follows the events of a run, and reports a hold, a
//! begin or a recovery that the policies forbid, and one that is missing. It knows paths as text, and nothing of the
//! engine.

use super::machine::{Kind, Policy, StateFacts};
use std::collections::{BTreeMap, BTreeSet};

/// Index of a loss: 0 the link, 1 commands.
pub(super) type LossIndex = usize;

pub(super) type Checked = Result<(), String>;

/// The inputs of a run that matter for policies.
#[derive(Debug)]
pub(super) enum Given {
    Silence([u64; 2]),
    Resume,
    /// The run is lost and restored.
    Cut,
    Preempt(String),
    Other,
}

/// The events of a run that matter for policies.
#[derive(Debug, Clone)]
pub(super) enum Seen {
    Entered(String),
    Left(String, String),
    /// A hold. `None`: the cause is not a policy.
    Held {
        path: String,
        next: Option<String>,
        loss: Option<LossIndex>,
    },
    Recovery(String, LossIndex),
}

#[derive(Default)]
pub(super) struct Oracle {
    states: BTreeMap<String, StateFacts>,
    silence: [u64; 2],
    /// Active states; true if the state was asked to end.
    active: BTreeMap<String, bool>,
    /// States active before a restore that have not come back.
    lost: BTreeMap<String, bool>,
    /// Outcomes of ended children.
    outcomes: BTreeMap<String, String>,
    /// The child of a container that ended last.
    last: BTreeMap<String, String>,
    decided: BTreeSet<String>,
    held: BTreeSet<(String, Option<String>)>,
    let_go: BTreeSet<(String, Option<String>)>,
    /// Children after which a hold must follow.
    due: BTreeSet<String>,
    recovering: BTreeSet<String>,
    /// Recoveries that must begin, by the container.
    awaited: BTreeMap<String, String>,
    /// Numbers of holds and of recoveries.
    pub(super) seen: [usize; 2],
}

impl Oracle {
    pub(super) fn new(states: BTreeMap<String, StateFacts>) -> Self {
        Self { states, ..Self::default() }
    }

    pub(super) fn give(&mut self, given: Given) {
        match given {
            Given::Silence(silence) => self.silence = silence,
            Given::Resume => self.let_go = std::mem::take(&mut self.held),
            Given::Preempt(path) => self.ask(&path, true),
            Given::Cut => {
                let stands =
                    |path: &&String| self.kind(path) == Kind::Hierarchy && !self.asked(path);
                let still = self.active.keys().filter(stands).filter(|path| !self.has_active(path));
                let left = still.filter_map(|path| self.last.get(path)).cloned();
                self.due = left.filter(|child| self.is_due_behind(child)).collect();
                self.lost = std::mem::take(&mut self.active);
                self.held.clear();
            }
            Given::Other => {}
        }
    }

    pub(super) fn see(&mut self, seen: Seen) -> Checked {
        match seen {
            Seen::Entered(path) => self.entered(path),
            Seen::Left(path, outcome) => self.left(&path, outcome),
            Seen::Held { path, next, loss } => self.hold(path, next, loss),
            Seen::Recovery(path, loss) => self.recovery(path, loss),
        }
    }

    /// Checks the run when it waits for its next input.
    pub(super) fn rest(&mut self) -> Checked {
        self.let_go.clear();
        demand(self.lost.is_empty(), "a state did not come back", &self.lost)?;
        demand(self.due.is_empty(), "no pause behind", &self.due)?;
        demand(self.awaited.is_empty(), "no recovery follows", &self.awaited)?;
        let late = self.active.keys().find(|path| (0..2).any(|loss| self.recovers(path, loss)));
        demand(late.is_none(), "a state is not preempted", late)?;
        let stuck = self.active.keys().find(|path| {
            self.kind(path) == Kind::Hierarchy
                && !self.has_active(path)
                && !self.held.iter().any(|(held, _)| held == *path)
        });
        demand(stuck.is_none(), "a hierarchy does nothing", stuck)
    }

    fn entered(&mut self, path: String) -> Checked {
        if let Some(asked) = self.lost.remove(&path) {
            self.active.insert(path, asked);
            return Ok(());
        }
        let around = parent(&path);
        let in_turn = around.is_none_or(|around| self.kind(around) == Kind::Hierarchy);
        let ends = around.is_some_and(|around| self.begins_asked(around));
        let was_let_go = self.let_go.extract_if(.., |(held, next)| {
            next.as_ref() == Some(&path) || in_turn && around == Some(held.as_str())
        });
        if was_let_go.count() == 0 && !is_decider(&path) && !ends {
            let owner = (0..2).find_map(|loss| self.holder_before(&path, loss));
            demand(owner.is_none(), "a state begins that is to be held", (&path, owner))?;
        }
        let skipped = self.due.iter().find(|child| in_turn && parent(child) == around);
        demand(skipped.is_none(), "no pause behind", skipped)?;
        self.awaited.retain(|_, target| *target != path);
        self.decided.remove(&path);
        self.last.remove(&path);
        self.outcomes.retain(|child, _| parent(child) != Some(path.as_str()));
        self.active.insert(path, ends);
        Ok(())
    }

    fn left(&mut self, path: &str, outcome: String) -> Checked {
        let skipped = self.due.iter().find(|child| parent(child) == Some(path));
        demand(skipped.is_none(), "no pause behind", skipped)?;
        self.active.remove(path);
        self.held.retain(|(held, _)| held != path);
        let recovered = self.recovering.remove(path) && outcome == "preempted";
        self.outcomes.insert(path.to_owned(), outcome);
        let Some(around) = parent(path).map(str::to_owned) else { return Ok(()) };
        if let Some(target) = self.states[path].recovery.clone().filter(|_| recovered) {
            self.awaited.insert(around.clone(), target);
        }
        if self.kind(&around) == Kind::Race && self.decided.insert(around.clone()) {
            self.ask(&around, false);
        }
        self.last.insert(around.clone(), path.to_owned());
        if !self.asked(&around) && self.is_due_behind(path) {
            self.due.insert(path.to_owned());
        }
        Ok(())
    }

    fn hold(&mut self, path: String, next: Option<String>, loss: Option<LossIndex>) -> Checked {
        let what = format!("{path} before {next:?} for {loss:?}");
        let loss = loss.ok_or_else(|| format!("something else holds {what}"))?;
        self.seen[0] += 1;
        let in_turn = self.kind(&path) == Kind::Hierarchy;
        let behind = self.held_behind(&path, next.as_ref(), loss);
        let owner = next.as_ref().and_then(|next| self.holder_before(next, loss));
        let before =
            owner.filter(|_| !self.active.contains_key(&path) || !self.begins_asked(&path));
        demand(behind.is_some() || before.is_some(), "held for no policy", &what)?;
        if behind.is_none() {
            let own = before.as_ref().is_none_or(|owner| Some(owner) == next.as_ref());
            let held = before.filter(|owner| !own && self.recovering.contains(owner));
            demand(held.is_none(), "held by what recovers", &what)?;
        }
        if let Some(child) = behind {
            self.due.remove(&child);
        }
        if in_turn {
            self.awaited.remove(&path);
        }
        self.held.insert((path, next));
        Ok(())
    }

    /// The child after which a container may be held.
    fn held_behind(&self, path: &str, next: Option<&String>, loss: LossIndex) -> Option<String> {
        if !self.active.contains_key(path) || self.asked(path) {
            return None;
        }
        let ends = |child: &&String| self.is_held_behind(child, loss);
        match self.kind(path) {
            Kind::Hierarchy => self.last.get(path).filter(ends).cloned(),
            Kind::Barrier if next.is_none() => {
                let children = || self.outcomes.keys().filter(|child| parent(child) == Some(path));
                let due = children().filter(|child| self.due.contains(*child)).find(ends);
                due.or_else(|| children().find(ends)).cloned()
            }
            Kind::Barrier | Kind::Race | Kind::Script => None,
        }
    }

    fn recovery(&mut self, path: String, loss: LossIndex) -> Checked {
        self.seen[1] += 1;
        demand(self.recovers(&path, loss), "a state is preempted too early", (&path, loss))?;
        self.ask(&path, true);
        self.recovering.insert(path);
        Ok(())
    }

    /// Marks the states in `top`, and optionally `top` itself, as asked to end.
    fn ask(&mut self, top: &str, and_itself: bool) {
        for (path, asked) in &mut self.active {
            *asked |= is_below(path, top) && (and_itself || path != top);
        }
        let active = &self.active;
        self.due.retain(|child| parent(child).is_some_and(|around| !active[around]));
        let decided = &self.decided;
        let ends = |path: &String| active.get(path) == Some(&true) || decided.contains(path);
        self.held.retain(|(path, _)| !(is_below(path, top) && ends(path)));
    }

    /// True if a policy must preempt this state: its time is over, and no policy inside it takes precedence.
    fn recovers(&self, path: &str, loss: LossIndex) -> bool {
        let inner = |inner: &String| inner != path && is_below(inner, path);
        let mut inside = self.active.keys().filter(|path| inner(path));
        let policy = self.own(path, loss);
        policy.is_some_and(|policy| self.is_over(policy.recover, loss))
            && !self.asked(path)
            && inside.all(|inner| self.own(inner, loss).is_none())
    }

    /// The state whose policy forbids this one to begin.
    fn holder_before(&self, path: &str, loss: LossIndex) -> Option<String> {
        let mut owner = path;
        while self.own(owner, loss).is_none() {
            owner = parent(owner)?;
            if self.asked(owner) {
                return None;
            }
        }
        let policy = self.own(owner, loss)?;
        let holds = self.is_over(policy.hold, loss) || self.is_over(policy.recover, loss);
        holds.then(|| owner.to_owned())
    }

    fn is_due_behind(&self, child: &str) -> bool {
        (0..2).any(|loss| self.is_held_behind(child, loss))
    }

    fn is_held_behind(&self, child: &str, loss: LossIndex) -> bool {
        let in_race = parent(child).is_none_or(|around| self.kind(around) == Kind::Race);
        let Some(policy) = self.own(child, loss).filter(|_| !in_race) else { return false };
        let outcome = self.outcomes.get(child).map(String::as_str);
        let recovered = matches!(outcome, Some("preempted" | "aborted"));
        self.is_over(policy.finish, loss) && !(recovered && self.is_over(policy.recover, loss))
    }

    fn is_over(&self, time_ms: Option<u64>, loss: LossIndex) -> bool {
        time_ms.is_some_and(|ms| self.silence[loss] > 0 && self.silence[loss] >= ms)
    }

    fn own(&self, path: &str, loss: LossIndex) -> Option<Policy> {
        self.states[path].policies[loss]
    }

    fn kind(&self, path: &str) -> Kind {
        self.states[path].kind
    }

    fn asked(&self, path: &str) -> bool {
        self.active.get(path).copied().unwrap_or_default()
    }

    /// True if a branch that begins in this state is asked to end at once.
    fn begins_asked(&self, path: &str) -> bool {
        self.kind(path) != Kind::Hierarchy && (self.asked(path) || self.decided.contains(path))
    }

    fn has_active(&self, path: &str) -> bool {
        self.active.keys().any(|inner| parent(inner) == Some(path))
    }
}

fn demand(holds: bool, otherwise: &str, about: impl std::fmt::Debug) -> Checked {
    if holds { Ok(()) } else { Err(format!("{otherwise}: {about:?}")) }
}

fn parent(path: &str) -> Option<&str> {
    path.rsplit_once('/').map(|(around, _)| around)
}

fn is_below(path: &str, top: &str) -> bool {
    path.strip_prefix(top).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

fn is_decider(path: &str) -> bool {
    path.ends_with("/unique_decider_state_id")
}
