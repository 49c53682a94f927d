//! Worlds: facts and numbers, and the conditions and effects of actions on them. This module knows one domain and its
//! objects.

use crate::pddl::{
    Arithmetic, Assignment, Atom, Comparison, Condition, Domain, Effect, Name, Number, Object,
    Problem, Term, Typed,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// A predicate or function applied to objects.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fact {
    /// The predicate or function.
    pub name: Name,
    /// Arguments of the fact.
    pub objects: Vec<Name>,
}

impl fmt::Display for Fact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}", self.name)?;
        self.objects.iter().try_for_each(|object| write!(f, " {object}"))?;
        f.write_str(")")
    }
}

/// A fact or its negation.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Literal {
    /// The fact, without a negation.
    pub fact: Fact,
    /// True if the fact holds, false for its negation.
    pub holds: bool,
}

impl fmt::Display for Literal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.holds { self.fact.fmt(f) } else { write!(f, "(not {})", self.fact) }
    }
}

/// The facts and numbers at one moment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct World {
    /// Facts that hold in this world.
    pub facts: BTreeSet<Fact>,
    /// Values of the functions.
    pub numbers: BTreeMap<Fact, f64>,
}

/// The changes of an action in one world.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Changes {
    pub(crate) adds: Vec<Fact>,
    pub(crate) deletes: Vec<Fact>,
    pub(crate) numbers: Vec<(Assignment, Fact, f64)>,
}

/// Everything that a condition or effect may read or change, in any world.
#[derive(Debug, Clone, Default)]
pub(crate) struct Touched {
    pub(crate) reads: BTreeSet<Fact>,
    pub(crate) adds: BTreeSet<Fact>,
    pub(crate) deletes: BTreeSet<Fact>,
    pub(crate) counts: BTreeSet<Fact>,
    /// Numbers that are set or scaled.
    pub(crate) sets: BTreeSet<Fact>,
    /// Numbers that are increased or decreased. Such changes commute.
    pub(crate) moves: BTreeSet<Fact>,
}

/// The objects of an action's variables, and the duration of the action.
#[derive(Debug, Clone, Default)]
pub(crate) struct Binding {
    pub(crate) objects: Vec<(Name, Name)>,
    pub(crate) duration: f64,
}

/// The domain and the objects, which no action changes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub(crate) domain: &'a Domain,
    pub(crate) objects: &'a [Object],
}

impl World {
    /// The initial world of a problem.
    pub fn new(problem: &Problem) -> Self {
        let binding = Binding::default();
        let facts = problem.facts.iter().map(|atom| binding.fact(atom)).collect();
        let numbers =
            problem.numbers.iter().map(|(atom, value)| (binding.fact(atom), *value)).collect();
        Self { facts, numbers }
    }

    /// Applies changes. Deletes come first, so that a fact that is deleted and added holds.
    pub(crate) fn apply(&mut self, changes: &Changes) {
        for fact in &changes.deletes {
            self.facts.remove(fact);
        }
        self.facts.extend(changes.adds.iter().cloned());
        for (how, fact, value) in &changes.numbers {
            let before = self.numbers.get(fact).copied().unwrap_or_default();
            let after = match how {
                Assignment::Set => *value,
                Assignment::Increase => before + value,
                Assignment::Decrease => before - value,
                Assignment::ScaleUp => before * value,
                Assignment::ScaleDown => before / value,
            };
            self.numbers.insert(fact.clone(), after);
        }
    }
}

impl Binding {
    fn object(&self, term: &Term) -> Name {
        let name = match term {
            Term::Object(name) => return name.clone(),
            Term::Variable(name) => name,
        };
        let found = self.objects.iter().rev().find(|(variable, _)| variable == name);
        found.map_or_else(|| smol_str::format_smolstr!("?{name}"), |(_, object)| object.clone())
    }

    pub(crate) fn fact(&self, atom: &Atom) -> Fact {
        Fact {
            name: atom.name.clone(),
            objects: atom.arguments.iter().map(|term| self.object(term)).collect(),
        }
    }
}

/// A condition, or its negation if `holds` is false.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Expected<'c> {
    condition: &'c Condition,
    holds: bool,
}

impl<'c> Expected<'c> {
    pub(crate) fn holds(condition: &'c Condition) -> Self {
        Self { condition, holds: true }
    }
}

impl Ground<'_> {
    /// All choices of objects for these names, each added to the binding.
    fn each(self, names: &[Typed], binding: &Binding) -> Vec<Binding> {
        let mut all = vec![binding.clone()];
        for typed in names {
            let fitting = || {
                self.objects.iter().filter(|object| self.domain.fits(&object.kind, &typed.types))
            };
            let with = |binding: &Binding, object: &Object| {
                let mut binding = binding.clone();
                binding.objects.push((typed.name.clone(), object.name.clone()));
                binding
            };
            all = all
                .iter()
                .flat_map(|binding| fitting().map(move |object| with(binding, object)))
                .collect();
        }
        all
    }

    /// `None` if the condition holds, otherwise a description of the part that does not.
    pub(crate) fn unmet(
        self,
        condition: &Condition,
        binding: &Binding,
        world: &World,
    ) -> Option<String> {
        match condition {
            Condition::Fact(atom) => {
                let fact = binding.fact(atom);
                (!world.facts.contains(&fact)).then(|| format!("{fact} does not hold"))
            }
            Condition::Same(a, b) => {
                let (a, b) = (binding.object(a), binding.object(b));
                (a != b).then(|| format!("{a} and {b} differ"))
            }
            Condition::Not(inner) => match self.unmet(inner, binding, world) {
                Some(_) => None,
                None => Some(match &**inner {
                    Condition::Fact(atom) => format!("{} holds", binding.fact(atom)),
                    Condition::Same(a, _) => format!("both are {}", binding.object(a)),
                    other => format!("{other} holds"),
                }),
            },
            Condition::And(parts) => parts.iter().find_map(|part| self.unmet(part, binding, world)),
            Condition::Or(parts) => {
                let unmet: Option<Vec<_>> =
                    parts.iter().map(|part| self.unmet(part, binding, world)).collect();
                unmet.map(|parts| {
                    if parts.is_empty() {
                        "nothing is allowed".to_owned()
                    } else {
                        parts.join(" and ")
                    }
                })
            }
            Condition::Forall(names, inner) => self
                .each(names, binding)
                .iter()
                .find_map(|binding| self.unmet(inner, binding, world)),
            Condition::Exists(names, inner) => {
                let found = self
                    .each(names, binding)
                    .iter()
                    .any(|binding| self.unmet(inner, binding, world).is_none());
                (!found).then(|| format!("{condition} does not hold"))
            }
            Condition::Compare(how, a, b) => {
                match (value(a, binding, world), value(b, binding, world)) {
                    (Ok(x), Ok(y)) if compare(*how, x, y) => None,
                    (Ok(x), Ok(y)) => {
                        Some(format!("({how} {a} {b}) does not hold: the numbers are {x} and {y}"))
                    }
                    (Err(reason), _) | (_, Err(reason)) => Some(reason),
                }
            }
        }
    }

    /// Collects the changes of an effect in this world. An error names the missing number.
    pub(crate) fn changes(
        self,
        effect: &Effect,
        binding: &Binding,
        world: &World,
        into: &mut Changes,
    ) -> Result<(), String> {
        match effect {
            Effect::All(parts) => {
                parts.iter().try_for_each(|part| self.changes(part, binding, world, into))
            }
            Effect::Add(atom) => {
                into.adds.push(binding.fact(atom));
                Ok(())
            }
            Effect::Delete(atom) => {
                into.deletes.push(binding.fact(atom));
                Ok(())
            }
            Effect::Assign(how, atom, number) => {
                let fact = binding.fact(atom);
                if *how != Assignment::Set && !world.numbers.contains_key(&fact) {
                    return Err(format!("{fact} has no value"));
                }
                into.numbers.push((*how, fact, value(number, binding, world)?));
                Ok(())
            }
            Effect::When(when, then) => match self.unmet(when, binding, world) {
                Some(_) => Ok(()),
                None => self.changes(then, binding, world, into),
            },
            Effect::Forall(names, inner) => self
                .each(names, binding)
                .iter()
                .try_for_each(|binding| self.changes(inner, binding, world, into)),
        }
    }

    pub(crate) fn touch_condition(
        self,
        condition: &Condition,
        binding: &Binding,
        into: &mut Touched,
    ) {
        match condition {
            Condition::Fact(atom) => drop(into.reads.insert(binding.fact(atom))),
            Condition::Same(..) => {}
            Condition::Not(inner) => self.touch_condition(inner, binding, into),
            Condition::And(parts) | Condition::Or(parts) => {
                for part in parts {
                    self.touch_condition(part, binding, into);
                }
            }
            Condition::Forall(names, inner) | Condition::Exists(names, inner) => {
                self.each(names, binding)
                    .iter()
                    .for_each(|binding| self.touch_condition(inner, binding, into));
            }
            Condition::Compare(_, a, b) => {
                for number in [a, b] {
                    touch_number(number, binding, into);
                }
            }
        }
    }

    /// Collects the facts in the world that satisfy a condition, or its negation.
    pub(crate) fn ask(
        self,
        expected: Expected<'_>,
        binding: &Binding,
        world: &World,
        into: &mut BTreeSet<Literal>,
    ) {
        let Expected { condition, holds } = expected;
        let expect = |condition| Expected { condition, holds };
        match condition {
            Condition::Fact(atom) => {
                let fact = binding.fact(atom);
                if world.facts.contains(&fact) == holds {
                    into.insert(Literal { fact, holds });
                }
            }
            Condition::Same(..) | Condition::Compare(..) => {}
            Condition::Not(inner) => {
                self.ask(Expected { condition: inner, holds: !holds }, binding, world, into);
            }
            Condition::And(parts) | Condition::Or(parts) => {
                for part in parts {
                    self.ask(expect(part), binding, world, into);
                }
            }
            Condition::Forall(names, inner) | Condition::Exists(names, inner) => {
                for binding in self.each(names, binding) {
                    self.ask(expect(inner), &binding, world, into);
                }
            }
        }
    }

    pub(crate) fn touch_effect(self, effect: &Effect, binding: &Binding, into: &mut Touched) {
        match effect {
            Effect::All(parts) => {
                for part in parts {
                    self.touch_effect(part, binding, into);
                }
            }
            Effect::Add(atom) => drop(into.adds.insert(binding.fact(atom))),
            Effect::Delete(atom) => drop(into.deletes.insert(binding.fact(atom))),
            Effect::Assign(how, atom, number) => {
                let commutes = matches!(how, Assignment::Increase | Assignment::Decrease);
                let set = if commutes { &mut into.moves } else { &mut into.sets };
                set.insert(binding.fact(atom));
                touch_number(number, binding, into);
            }
            Effect::When(when, then) => {
                self.touch_condition(when, binding, into);
                self.touch_effect(then, binding, into);
            }
            Effect::Forall(names, inner) => {
                self.each(names, binding)
                    .iter()
                    .for_each(|binding| self.touch_effect(inner, binding, into));
            }
        }
    }
}

impl Touched {
    /// True if the order of both matters. A fact that both add, or that both delete, does not matter.
    pub(crate) fn disturbs(&self, other: &Self) -> bool {
        let hits = |a: &BTreeSet<Fact>, b: &BTreeSet<Fact>| !a.is_disjoint(b);
        let one_way = |a: &Self, b: &Self| {
            hits(&a.adds, &b.reads)
                || hits(&a.deletes, &b.reads)
                || hits(&a.adds, &b.deletes)
                || hits(&a.sets, &b.counts)
                || hits(&a.moves, &b.counts)
                || hits(&a.sets, &b.moves)
        };
        one_way(self, other) || one_way(other, self) || hits(&self.sets, &other.sets)
    }
}

fn touch_number(number: &Number, binding: &Binding, into: &mut Touched) {
    match number {
        Number::Literal(_) | Number::Duration => {}
        Number::Function(atom) => drop(into.counts.insert(binding.fact(atom))),
        Number::Combined(_, parts) => {
            for part in parts.iter() {
                touch_number(part, binding, into);
            }
        }
    }
}

pub(crate) fn value(number: &Number, binding: &Binding, world: &World) -> Result<f64, String> {
    match number {
        Number::Literal(value) => Ok(*value),
        Number::Duration => Ok(binding.duration),
        Number::Function(atom) => {
            let fact = binding.fact(atom);
            world.numbers.get(&fact).copied().ok_or_else(|| format!("{fact} has no value"))
        }
        Number::Combined(how, parts) => {
            let (a, b) = (value(&parts[0], binding, world)?, value(&parts[1], binding, world)?);
            Ok(match how {
                Arithmetic::Add => a + b,
                Arithmetic::Subtract => a - b,
                Arithmetic::Multiply => a * b,
                Arithmetic::Divide => a / b,
            })
        }
    }
}

/// Tolerance within which two numbers are equal.
pub(crate) const CLOSE: f64 = 1e-6;

pub(crate) fn compare(how: Comparison, a: f64, b: f64) -> bool {
    let close = CLOSE * a.abs().max(b.abs()).max(1.0);
    match how {
        Comparison::Less => a < b,
        Comparison::AtMost => a <= b + close,
        Comparison::Equal => (a - b).abs() <= close,
        Comparison::AtLeast => a >= b - close,
        Comparison::Greater => a > b,
    }
}
