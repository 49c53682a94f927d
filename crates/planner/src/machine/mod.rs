//! The machine of a plan: library states in the order of the plan, and the recovery from their failures.

mod layout;
mod step;
mod values;
mod wiring;

pub use values::Data;

use crate::finding::Finding;
use crate::merge::Pool;
use crate::pddl::Name;
use crate::plan::Plan;
use crate::skill::{Recovery, Then};
use crate::structure::Structure;
use crate::task::Task;
use rafcon_model::{
    DECIDER_ID, DataType, Kind, OutcomeId, Port, PortId, RuntimeValue, RuntimeValues, Script,
    State, StateId, StatePath, Target, Value,
};
use smol_str::SmolStr;
use std::sync::Arc;
use wiring::{Draft, Ids, SUCCESS, Sized, with_outcomes};

/// Script of the state for a goal that already holds.
const NOTHING: &str = include_str!("scripts/nothing.py");
/// Path and name of the library that plans again.
pub const REPLAN: &str = "planning/replan";
/// Scoped variable with the plans that were already tried.
const PLANS: PortId = PortId(0);
const DECIDE: &str = include_str!("scripts/decide.py");

/// Returns the root of a library by its path and name. The error is the reason why it is missing.
pub type FindLibrary<'b> = &'b dyn Fn(&str) -> Result<Arc<State>, String>;

/// The parts from which a machine is built.
#[derive(Clone, Copy)]
pub struct Build<'b> {
    /// Name of the machine.
    pub name: &'b str,
    /// The domain and the problem.
    pub task: &'b Task,
    /// The skills of the pool.
    pub pool: &'b Pool,
    /// A valid plan of the task.
    pub plan: &'b Plan,
    /// The sequential and parallel parts of the plan.
    pub structure: &'b Structure,
    /// The runtime data of objects.
    pub data: &'b Data,
    /// Recovery of skills that declare none.
    pub recovery: Recovery,
    /// The libraries for planning again after a failure, if that is configured.
    pub replanning: Option<&'b Replanning>,
    /// Finds the libraries that check preconditions.
    pub library: FindLibrary<'b>,
}

impl std::fmt::Debug for Build<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Build").field("name", &self.name).finish_non_exhaustive()
    }
}

/// The libraries with which a running machine plans again.
#[derive(Debug, Clone)]
pub struct Replanning {
    /// The library whose output `facts` is the current world.
    pub observe: (SmolStr, Arc<State>),
    /// The library that plans again, [`REPLAN`].
    pub replan: (SmolStr, Arc<State>),
    /// Values for the inputs of `replan`, by name.
    pub inputs: Vec<(SmolStr, Value)>,
}

/// A reason why a machine cannot be built.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum BuildError {
    /// No skill has this action.
    #[error("no skill has the action `{0}`")]
    NoSkill(Name),
    /// A library is missing.
    #[error("the library {library} is missing: {reason}")]
    NoLibrary {
        /// Path and name of the library.
        library: SmolStr,
        /// The reason why it is missing.
        reason: String,
    },
    /// A library lacks a port or an outcome.
    #[error("the library {library} has no {what} `{name}`: add it")]
    Lacks {
        /// Path and name of the library.
        library: SmolStr,
        /// The kind of the part: input, output or outcome.
        what: &'static str,
        /// Name of the missing part.
        name: SmolStr,
    },
    /// A skill plans again, but no library observes the facts.
    #[error("{0} plans again when it fails: name the library that observes the facts")]
    NoObserver(SmolStr),
    /// The value of a port cannot be set.
    #[error("{0}")]
    Value(String),
}

impl From<Finding> for BuildError {
    fn from(finding: Finding) -> Self {
        Self::Value(format!("{}: {}", finding.libraries.join(", "), finding.text))
    }
}

/// A machine and the places of the plan's steps in it.
#[derive(Debug, Clone)]
pub struct Built {
    /// The root of the machine.
    pub root: State,
    /// The paths of the steps, in plan order.
    pub steps: Vec<StatePath>,
}

impl Built {
    /// The name of the state at a path.
    pub fn title(&self, path: &StatePath) -> String {
        let below = path.0.iter().skip(1);
        let mut state = Some(&self.root);
        for id in below {
            state = state.and_then(|state| state.container()?.states.get(id).map(|child| &**child));
        }
        state.map(|state| state.name.to_string()).unwrap_or_default()
    }
}

/// Builds the machine. Equal plans give equal machines.
pub fn build(build: &Build<'_>) -> Result<Built, BuildError> {
    let mut ids = Ids::new(u64::try_from(build.plan.steps.len()).unwrap_or_default());
    let mut steps = vec![StatePath(Vec::new()); build.plan.steps.len()];
    let mut draft = Draft::new(ids.next());
    let root = StatePath::root(draft.id.clone());
    let replanning = build.replanning;
    let mut again = None;
    let failed = match replanning {
        Some(replanning) => {
            let (observe, replanned) = replan(&mut draft, &mut ids, replanning)?;
            again = Some(replanned);
            Target::State(observe)
        }
        None => match build.pool.skills.iter().find(|skill| replans(build, skill)) {
            Some(skill) => return Err(BuildError::NoObserver(skill.library.clone())),
            None => Target::Outcome(OutcomeId::ABORTED),
        },
    };
    let parts = match build.structure {
        Structure::Series(parts) => parts.as_slice(),
        other => std::slice::from_ref(other),
    };
    let mut maker = Maker { build, ids, steps: &mut steps };
    let first = maker.series(&mut draft, &root, parts, &failed)?;
    if let Some((state, outcome)) = again {
        // The last replanning state continues with the first step of the plan.
        draft.line((&state, outcome), Target::State(first));
    }
    let mut root = draft.finish(build.name, Kind::Hierarchy, &["success"]);
    if let Some(container) = root.state.container_mut().filter(|_| replanning.is_some()) {
        container.scoped_variables.insert(Port::new(PLANS, "plans", DataType::List, tried(build)));
    }
    root.state.layout = layout::entry((0.0, 0.0), root.size, true);
    Ok(Built { root: root.state, steps })
}

/// The plan as the first entry of the tried plans.
fn tried(build: &Build<'_>) -> Value {
    let steps = build.plan.steps.iter().map(|step| {
        let objects = step.objects.iter().map(|name| format!(" {}", build.task.spelling(name)));
        Value::str(&format!("({}{})", step.action, objects.collect::<String>()))
    });
    Value::List([Value::List(steps.collect())].into())
}

fn replans(build: &Build<'_>, skill: &crate::skill::Skill) -> bool {
    let is_used = build.plan.steps.iter().any(|step| step.action == skill.action.name);
    is_used && skill.recovery.unwrap_or(build.recovery).then == Then::Replan
}

/// Adds the states that observe and plan again. Returns the first state, and the last with its outcome for a new plan.
fn replan(
    draft: &mut Draft,
    ids: &mut Ids,
    replanning: &Replanning,
) -> Result<(StateId, (StateId, OutcomeId)), BuildError> {
    let (observe, observer) = &replanning.observe;
    let (library, root) = &replanning.replan;
    let told = part(observe, "output", "facts", observer.outputs.by_name("facts"))?.id;
    let input = |name: &str| {
        Ok::<_, BuildError>(part(library, "input", name, root.inputs.by_name(name))?.id)
    };
    let outcome = |name: &str| {
        let found = root.outcomes.iter().find(|outcome| outcome.name == name);
        Ok::<_, BuildError>(part(library, "outcome", name, found)?.id)
    };
    let tried = part(library, "output", "plans", root.outputs.by_name("plans"))?.id;
    let (replanned, reached) = (outcome("replanned")?, outcome("reached")?);
    let mut values = values::defaults(root);
    for (name, value) in &replanning.inputs {
        values.insert(input(name)?, RuntimeValue { value: value.clone(), used: true });
    }
    let again = step::library(ids.next(), "Plan again", library, root, values);
    let observer = step::library(ids.next(), "Observe", observe, observer, RuntimeValues::new());
    let seen = crate::skill::done(&observer).map_or(SUCCESS, |outcome| outcome.id);
    let first = draft.add(Sized::leaf(observer));
    let second = draft.add(Sized::leaf(again));
    draft.line((&first, seen), Target::State(second.clone()));
    draft.failures(&first, seen, &Target::Outcome(OutcomeId::ABORTED));
    draft.flow((&first, told), (&second, input("facts")?));
    let container = draft.id.clone();
    draft.flow((&container, PLANS), (&second, input("plans")?));
    draft.flow((&second, tried), (&container, PLANS));
    draft.line((&second, reached), Target::Outcome(SUCCESS));
    for other in root.outcomes.iter().map(|outcome| outcome.id) {
        if ![replanned, reached, OutcomeId::PREEMPTED].contains(&other) {
            draft.line((&second, other), Target::Outcome(OutcomeId::ABORTED));
        }
    }
    Ok((first, (second, replanned)))
}

/// Requires a part that a library must have.
fn part<'p, P>(
    library: &SmolStr,
    what: &'static str,
    name: &str,
    found: Option<&'p P>,
) -> Result<&'p P, BuildError> {
    found.ok_or_else(|| BuildError::Lacks { library: library.clone(), what, name: name.into() })
}

struct Maker<'b> {
    build: &'b Build<'b>,
    ids: Ids,
    steps: &'b mut [StatePath],
}

impl Maker<'_> {
    /// Adds parts in sequence to a hierarchy and returns the first.
    fn series(
        &mut self,
        draft: &mut Draft,
        path: &StatePath,
        parts: &[Structure],
        failed: &Target,
    ) -> Result<StateId, BuildError> {
        let mut before: Option<(StateId, OutcomeId)> = None;
        let mut first = None;
        for part in parts {
            let (child, done) = self.part(path, part)?;
            let id = draft.add(child);
            first.get_or_insert_with(|| id.clone());
            match &before {
                Some((state, done)) => draft.line((state, *done), Target::State(id.clone())),
                None => draft.start(&id),
            }
            draft.failures(&id, done, failed);
            before = Some((id, done));
        }
        if let Some((first, (state, done))) = first.zip(before) {
            draft.line((&state, done), Target::Outcome(SUCCESS));
            return Ok(first);
        }
        let nothing = wiring::script(self.ids.next(), "Nothing to do", NOTHING, &["success"]);
        let id = draft.add(Sized::leaf(nothing));
        draft.start(&id);
        draft.line((&id, SUCCESS), Target::Outcome(SUCCESS));
        Ok(id)
    }

    /// The state of a part, and the outcome that means success.
    fn part(
        &mut self,
        path: &StatePath,
        part: &Structure,
    ) -> Result<(Sized, OutcomeId), BuildError> {
        match part {
            Structure::Step(index) => {
                let (state, done) = step::state(self.build, &mut self.ids, *index)?;
                if let Some(slot) = self.steps.get_mut(*index) {
                    *slot = path.child(state.state.id.clone());
                }
                Ok((state, done))
            }
            Structure::Series(parts) => {
                let mut draft = Draft::new(self.ids.next());
                let path = path.child(draft.id.clone());
                self.series(&mut draft, &path, parts, &Target::Outcome(OutcomeId::ABORTED))?;
                Ok((
                    draft.finish(&self.name(part, " then "), Kind::Hierarchy, &["success"]),
                    SUCCESS,
                ))
            }
            Structure::Parallel(parts) => {
                let mut draft = Draft::new(self.ids.next());
                let path = path.child(draft.id.clone());
                let decider = StateId::new(DECIDER_ID);
                let mut wanted = Vec::new();
                for part in parts {
                    let (child, done) = self.part(&path, part)?;
                    let name = child.state.outcomes.get(done).map(|outcome| outcome.name.clone());
                    wanted.push((
                        Value::str(child.state.id.as_str()),
                        Value::str(&name.unwrap_or_default()),
                    ));
                    let id = draft.add(child);
                    draft.line((&id, done), Target::State(decider.clone()));
                    draft.failures(&id, done, &Target::State(decider.clone()));
                }
                let script = Script { text: Some(DECIDE.into()) };
                let mut state = State::new(decider, "Decider", Kind::Decider(script));
                let wanted = Value::Dict(wanted.into());
                state.inputs.insert(Port::new(PortId(0), "wanted", DataType::Dict, wanted));
                let decider = draft.add(Sized::leaf(with_outcomes(state, &["success"])));
                draft.line((&decider, SUCCESS), Target::Outcome(SUCCESS));
                draft.line((&decider, OutcomeId::ABORTED), Target::Outcome(OutcomeId::ABORTED));
                Ok((draft.finish(&self.name(part, ", "), Kind::Barrier, &["success"]), SUCCESS))
            }
        }
    }

    /// The name of a container: the names of its steps, or their number.
    fn name(&self, part: &Structure, between: &str) -> String {
        let steps = part.steps();
        let titles = steps.iter().filter_map(|step| {
            let skill = self.build.pool.skill(&self.build.plan.steps[*step].action)?;
            Some(step::title(self.build, skill, *step))
        });
        match steps.len() {
            0..=3 => titles.collect::<Vec<_>>().join(between),
            many => format!("{many} steps"),
        }
    }
}
