//! A planning task: a domain and a problem that fit each other.

use crate::finding::Finding;
use crate::ground::{Binding, Ground, World};
use crate::pddl::{Action, Atom, Condition, Domain, Name, Number, Problem, Signature, Term, Typed};
use crate::plan::{Step, spelling};
use smol_str::SmolStr;
use std::collections::BTreeSet;

/// A domain with a problem.
#[derive(Debug, Clone)]
pub struct Task {
    /// Types, predicates, functions and actions.
    pub domain: Domain,
    /// Objects, initial facts and the goal.
    pub problem: Problem,
}

impl Task {
    /// Combines a domain and a problem. Facts that no action uses are dropped with a warning; any other misfit is an
    /// error.
    pub fn new(domain: Domain, mut problem: Problem) -> (Self, Vec<Finding>) {
        let mut findings = Vec::new();
        problem.domain = domain.name.clone();
        if problem.name.is_empty() {
            problem.name = "problem".into();
        }
        check_objects(&domain, &problem, &mut findings);
        let facts = std::mem::take(&mut problem.facts);
        let (known, unknown) =
            facts.into_iter().partition(|fact| knows(&domain.predicates, &fact.name));
        problem.facts = known;
        let numbers = std::mem::take(&mut problem.numbers);
        let (known, more) =
            numbers.into_iter().partition(|(fact, _)| knows(&domain.functions, &fact.name));
        problem.numbers = known;
        let unknown: Vec<Atom> = unknown;
        let left: BTreeSet<Name> = unknown
            .into_iter()
            .chain(more.into_iter().map(|(fact, _)| fact))
            .map(|fact| fact.name)
            .collect();
        findings.extend(left.into_iter().map(|name| {
            Finding::warning(
                &[],
                format!("facts: no skill knows `{name}`: facts with it are left out"),
            )
        }));
        let mut checks = AtomChecks {
            domain: &domain,
            problem: &problem,
            place: "facts",
            findings: &mut findings,
        };
        for fact in &problem.facts {
            checks.check_atom(&domain.predicates, fact, &[]);
        }
        for (fact, _) in &problem.numbers {
            checks.check_atom(&domain.functions, fact, &[]);
        }
        checks.place = "goal";
        checks.check_goal(&problem.goal, &mut Vec::new());
        (Self { domain, problem }, findings)
    }

    pub(crate) fn ground(&self) -> Ground<'_> {
        Ground { domain: &self.domain, objects: &self.problem.objects }
    }

    /// The initial world of the problem.
    pub fn world(&self) -> World {
        World::new(&self.problem)
    }

    /// The user's spelling of an object's name.
    pub fn spelling(&self, name: &str) -> SmolStr {
        spelling(name, &self.problem.objects)
    }

    /// The action of a step with the objects of its variables. The error describes the misfit.
    pub(crate) fn bind(&self, step: &Step) -> Result<(&Action, Binding), String> {
        let action = self
            .domain
            .action(&step.action)
            .ok_or_else(|| format!("there is no action `{}`", step.action))?;
        if action.parameters.len() != step.objects.len() {
            return Err(format!(
                "`{}` takes {} objects, not {}",
                action.name,
                action.parameters.len(),
                step.objects.len()
            ));
        }
        let mut binding =
            Binding { objects: Vec::new(), duration: step.duration.unwrap_or_default() };
        for (parameter, name) in action.parameters.iter().zip(&step.objects) {
            let object = self.problem.objects.iter().find(|object| object.name == *name);
            let object = object.ok_or_else(|| format!("there is no object `{name}`"))?;
            if !self.domain.fits(&object.kind, &parameter.types) {
                return Err(format!(
                    "`{name}` is a {}, and `?{}` takes {}",
                    object.kind,
                    parameter.name,
                    parameter.types.join(" or ")
                ));
            }
            binding.objects.push((parameter.name.clone(), name.clone()));
        }
        Ok((action, binding))
    }
}

fn knows(signatures: &[Signature], name: &str) -> bool {
    signatures.iter().any(|signature| signature.name == name)
}

fn check_objects(domain: &Domain, problem: &Problem, findings: &mut Vec<Finding>) {
    for object in &problem.objects {
        if object.kind != crate::pddl::OBJECT
            && !domain.types.iter().any(|(name, _)| *name == object.kind)
        {
            let known: Vec<_> = domain.types.iter().map(|(name, _)| name.as_str()).collect();
            let text = format!(
                "facts: `{}` is a `{}`, which is no type; there are {}",
                object.spelling,
                object.kind,
                known.join(", ")
            );
            findings.push(Finding::error(&[], text));
        }
    }
}

/// Checks of the atoms in the facts or the goal.
struct AtomChecks<'c> {
    domain: &'c Domain,
    problem: &'c Problem,
    /// Part of the problem that the findings name.
    place: &'static str,
    findings: &'c mut Vec<Finding>,
}

impl AtomChecks<'_> {
    /// Checks an atom of facts or the goal against the signatures.
    fn check_atom(&mut self, signatures: &[Signature], atom: &Atom, variables: &[Typed]) {
        let (domain, problem, place) = (self.domain, self.problem, self.place);
        let findings = &mut *self.findings;
        let mut wrong =
            |text: String| findings.push(Finding::error(&[], format!("{place}: {text}")));
        let Some(signature) = signatures.iter().find(|signature| signature.name == atom.name)
        else {
            let known: Vec<_> = signatures.iter().map(ToString::to_string).collect();
            return wrong(format!("no skill knows `{atom}`; there are {}", known.join(" ")));
        };
        if signature.arguments.len() != atom.arguments.len() {
            return wrong(format!("`{atom}` does not fit `{signature}`"));
        }
        for (wanted, term) in signature.arguments.iter().zip(&atom.arguments) {
            let fits = match term {
                Term::Variable(name) => {
                    if let Some(typed) = variables.iter().find(|typed| typed.name == *name) {
                        typed.types.is_empty()
                            || typed.types.iter().any(|kind| domain.fits(kind, &wanted.types))
                    } else {
                        wrong(format!("`?{name}` in `{atom}` is not declared"));
                        continue;
                    }
                }
                Term::Object(name) => {
                    if let Some(object) = problem.objects.iter().find(|object| object.name == *name)
                    {
                        domain.fits(&object.kind, &wanted.types)
                    } else {
                        wrong(format!(
                            "`{atom}` names `{name}`, which is no object: add it to `(:objects …)`"
                        ));
                        continue;
                    }
                }
            };
            if !fits {
                wrong(format!("`{term}` in `{atom}` is no {}", wanted.types.join(" or ")));
            }
        }
    }

    fn check_goal(&mut self, goal: &Condition, variables: &mut Vec<Typed>) {
        match goal {
            Condition::Fact(atom) => {
                self.check_atom(&self.domain.predicates, atom, variables);
            }
            Condition::Same(..) => {}
            Condition::Not(inner) => self.check_goal(inner, variables),
            Condition::And(parts) | Condition::Or(parts) => {
                for part in parts {
                    self.check_goal(part, variables);
                }
            }
            Condition::Forall(names, inner) | Condition::Exists(names, inner) => {
                let outer = variables.len();
                variables.extend_from_slice(names);
                self.check_goal(inner, variables);
                variables.truncate(outer);
            }
            Condition::Compare(_, a, b) => {
                for number in [a, b] {
                    self.check_number(number, variables);
                }
            }
        }
    }

    fn check_number(&mut self, number: &Number, variables: &[Typed]) {
        match number {
            Number::Literal(_) | Number::Duration => {}
            Number::Function(atom) => {
                self.check_atom(&self.domain.functions, atom, variables);
            }
            Number::Combined(_, parts) => {
                parts.iter().for_each(|part| self.check_number(part, variables));
            }
        }
    }
}
