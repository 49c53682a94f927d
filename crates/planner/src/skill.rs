//! Skills: library states with a planner annotation. The reference's planner plugin writes the annotation into the
//! semantic data of a library's root (`docs/guide/planning.md`). This program adds an entry of its own.

use crate::finding::Finding;
use crate::pddl::{
    Action, Atom, Condition, Effect, Name, Number, Signature, Term, Typed, read_action,
    read_signatures,
};
use rafcon_model::{Json, Outcome, Port, State};
use smol_str::SmolStr;
use std::sync::Arc;

/// The reaction to a failed step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Recovery {
    /// Number of retries after a failure.
    pub retries: u32,
    /// The last resort after the retries.
    pub then: Then,
}

/// The last resort for a failed step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Then {
    /// Ends the machine with *aborted*.
    #[default]
    GiveUp,
    /// Lets a person decide.
    Ask,
    /// Observes the world and makes another plan.
    Replan,
}

/// A library state with which an engine can plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Skill {
    /// Path and name of the library, joined by `/`.
    pub library: SmolStr,
    /// Name of the library's root state.
    pub title: SmolStr,
    /// The annotation's description, for people.
    pub description: String,
    /// Action for planning engines.
    pub action: Action,
    /// Predicates that the annotation declares.
    pub predicates: Vec<Signature>,
    /// Numeric functions that the annotation declares.
    pub functions: Vec<Signature>,
    /// Types that the annotation names, each with its parent if given.
    pub types: Vec<(Name, Option<Name>)>,
    /// PDDL requirements that the annotation names.
    pub requirements: Vec<Name>,
    /// The root of the library.
    pub root: Arc<State>,
    /// Path and name of the library that checks the preconditions.
    pub check: Option<SmolStr>,
    /// Recovery after a failure; `None` for the one in the request for the plan.
    pub recovery: Option<Recovery>,
}

/// Key of the reference plugin's entry in the semantic data.
pub const ANNOTATION: &str = "RAFCONTPP";
/// Key of the entry for recovery and checks in the semantic data.
pub const PLANNING: &str = "planning";

/// Parses the annotation of a library's root; `None` if it has none.
pub fn read_skill(library: &str, root: &Arc<State>) -> Result<Option<Skill>, Finding> {
    let library = SmolStr::new(library);
    let Some(notes) = root.semantic_data.as_deref() else { return Ok(None) };
    let Some(annotation) = notes.get(ANNOTATION).and_then(|notes| notes.get("PDDL_ACTION")) else {
        return Ok(None);
    };
    let text = |key| annotation.get(key).and_then(Json::as_str).unwrap_or_default().trim();
    if text("pddl_action").is_empty() {
        return Ok(None);
    }
    let wrong = |key: &str, error: &dyn std::fmt::Display| {
        Finding::error(&[&library], format!("{key}: {error}"))
    };
    let action = read_action(text("pddl_action")).map_err(|error| wrong("pddl_action", &error))?;
    let signatures = |key| read_signatures(text(key)).map_err(|error| wrong(key, &error));
    let (check, recovery) = match notes.get(PLANNING) {
        Some(planning) => read_planning(planning).map_err(|reason| wrong(PLANNING, &reason))?,
        None => (None, None),
    };
    Ok(Some(Skill {
        title: root.name.clone(),
        description: text("description").to_owned(),
        action,
        predicates: signatures("pddl_predicates")?,
        functions: signatures("pddl_functions")?,
        types: types(text("pddl_types")),
        requirements: requirements(annotation.get("requirements")),
        root: root.clone(),
        check,
        recovery,
        library,
    }))
}

/// Parses `Waiter, Location - Place`.
fn types(text: &str) -> Vec<(Name, Option<Name>)> {
    let parts = text.split([',', '\n']).map(str::trim).filter(|part| !part.is_empty());
    let lower = |name: &str| Name::from(name.trim().to_ascii_lowercase());
    parts
        .map(|part| match part.split_once(" - ") {
            Some((child, parent)) => (lower(child), Some(lower(parent))),
            None => (lower(part), None),
        })
        .collect()
}

fn requirements(json: Option<&Json>) -> Vec<Name> {
    let items = json.and_then(Json::as_list).unwrap_or_default();
    items.iter().filter_map(Json::as_str).map(|text| text.to_ascii_lowercase().into()).collect()
}

/// Parses `{"check": "pool/is_there", "retries": 2, "then": "replan"}`.
fn read_planning(json: &Json) -> Result<(Option<SmolStr>, Option<Recovery>), String> {
    let entries = json
        .as_object()
        .ok_or("an object such as {\"retries\": 2, \"then\": \"replan\"} is expected")?;
    let (mut check, mut recovery) = (None, None);
    for (key, value) in entries {
        let slot = recovery.get_or_insert_with(Recovery::default);
        match key.as_str() {
            "check" => {
                let library = value.as_str().filter(|text| text.contains('/'));
                check = Some(
                    library.ok_or("`check` names a library, such as \"pool/is_there\"")?.into(),
                );
            }
            "retries" => {
                let number = value.as_int().and_then(|number| u32::try_from(number).ok());
                slot.retries = number
                    .filter(|number| *number <= 1000)
                    .ok_or("`retries` is a number from 0 to 1000")?;
            }
            "then" => slot.then = Then::read(value.as_str().unwrap_or_default())?,
            other => {
                return Err(format!(
                    "`{other}` is not known: there are `check`, `retries` and `then`"
                ));
            }
        }
    }
    let only_check = entries.iter().all(|(key, _)| key == "check");
    Ok((check, recovery.filter(|_| !only_check)))
}

impl Then {
    /// Parses the word of semantic data and requests.
    pub fn read(word: &str) -> Result<Self, String> {
        match word {
            "give up" => Ok(Self::GiveUp),
            "ask" => Ok(Self::Ask),
            "replan" => Ok(Self::Replan),
            _ => Err(format!(
                "`{word}` is no way to recover: there are \"give up\", \"ask\" and \"replan\""
            )),
        }
    }
}

impl Skill {
    /// The input port with the name of a parameter; an exact match takes precedence over other capitals.
    pub fn port(&self, parameter: &str) -> Option<&Port> {
        port(&self.root, parameter)
    }

    /// The outcome that means success: the lowest non-mandatory one.
    pub fn done(&self) -> Option<&Outcome> {
        done(&self.root)
    }

    /// The predicates and functions that the action uses, in this order. Arguments have the types of the parameters.
    pub fn used(&self) -> [Vec<Signature>; 2] {
        let mut used = Used { names: self.action.parameters.clone(), ..Used::default() };
        self.action.needs.iter().for_each(|need| used.condition(need));
        self.action.effects.iter().for_each(|effect| used.effect(effect));
        for (_, number) in self.action.duration.iter().flatten() {
            used.number(number);
        }
        [used.predicates, used.functions]
    }

    /// Variables of the action that are no parameters, and objects that the action names.
    pub fn strangers(&self) -> Vec<Term> {
        let mut used = Used { names: self.action.parameters.clone(), ..Used::default() };
        self.action.needs.iter().for_each(|need| used.condition(need));
        self.action.effects.iter().for_each(|effect| used.effect(effect));
        used.strangers
    }
}

/// The names that an action uses.
#[derive(Default)]
struct Used {
    names: Vec<Typed>,
    predicates: Vec<Signature>,
    functions: Vec<Signature>,
    strangers: Vec<Term>,
}

impl Used {
    fn condition(&mut self, condition: &Condition) {
        match condition {
            Condition::Fact(atom) => {
                let signature = self.signature(atom);
                self.predicates.push(signature);
            }
            Condition::Same(a, b) => [a, b].into_iter().for_each(|term| drop(self.types(term))),
            Condition::Not(inner) => self.condition(inner),
            Condition::And(parts) | Condition::Or(parts) => {
                for part in parts {
                    self.condition(part);
                }
            }
            Condition::Forall(names, inner) | Condition::Exists(names, inner) => {
                self.inside(names, |used| used.condition(inner));
            }
            Condition::Compare(_, a, b) => {
                for number in [a, b] {
                    self.number(number);
                }
            }
        }
    }

    fn effect(&mut self, effect: &Effect) {
        match effect {
            Effect::All(parts) => parts.iter().for_each(|part| self.effect(part)),
            Effect::Add(atom) | Effect::Delete(atom) => {
                let signature = self.signature(atom);
                self.predicates.push(signature);
            }
            Effect::Assign(_, atom, number) => {
                let signature = self.signature(atom);
                self.functions.push(signature);
                self.number(number);
            }
            Effect::When(when, then) => {
                self.condition(when);
                self.effect(then);
            }
            Effect::Forall(names, inner) => self.inside(names, |used| used.effect(inner)),
        }
    }

    fn number(&mut self, number: &Number) {
        match number {
            Number::Literal(_) | Number::Duration => {}
            Number::Function(atom) => {
                let signature = self.signature(atom);
                self.functions.push(signature);
            }
            Number::Combined(_, parts) => parts.iter().for_each(|part| self.number(part)),
        }
    }

    fn inside(&mut self, names: &[Typed], visit: impl FnOnce(&mut Self)) {
        let outer = self.names.len();
        self.names.extend_from_slice(names);
        visit(self);
        self.names.truncate(outer);
    }

    fn signature(&mut self, atom: &Atom) -> Signature {
        let arguments = atom.arguments.iter().enumerate().map(|(at, term)| Typed {
            name: match term {
                Term::Variable(name) => name.clone(),
                Term::Object(_) => smol_str::format_smolstr!("x{at}"),
            },
            types: self.types(term),
        });
        Signature { name: atom.name.clone(), arguments: arguments.collect() }
    }

    fn types(&mut self, term: &Term) -> Vec<Name> {
        let found = match term {
            Term::Variable(name) => self.names.iter().rev().find(|typed| typed.name == *name),
            Term::Object(_) => None,
        };
        if found.is_none() {
            self.strangers.push(term.clone());
        }
        found.map(|typed| typed.types.clone()).unwrap_or_default()
    }
}

/// The input port for a parameter. An exact match takes precedence over other capitals.
pub(crate) fn port<'s>(state: &'s State, parameter: &str) -> Option<&'s Port> {
    let loose = || state.inputs.iter().find(|port| port.name.eq_ignore_ascii_case(parameter));
    state.inputs.by_name(parameter).or_else(loose)
}

/// The lowest outcome that is not mandatory.
pub(crate) fn done(state: &State) -> Option<&Outcome> {
    state.outcomes.iter().find(|outcome| !outcome.id.is_mandatory())
}
