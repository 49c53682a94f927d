//! Writes PDDL text, for engines and people.

use super::{
    Action, Arithmetic, Assignment, Atom, Comparison, Condition, Domain, Effect, Name, Number,
    OBJECT, Problem, Signature, Term, Typed,
};
use std::collections::BTreeSet;
use std::fmt::{self, Display, Formatter, Write as _};

/// Several parts with a space before each.
struct Spaced<'a, T>(&'a [T]);

impl<T: Display> Display for Spaced<'_, T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|part| write!(f, " {part}"))
    }
}

impl Display for Term {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Variable(name) => write!(f, "?{name}"),
            Self::Object(name) => f.write_str(name),
        }
    }
}

impl Display for Atom {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "({}{})", self.name, Spaced(&self.arguments))
    }
}

impl Display for Typed {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "?{} - ", self.name)?;
        match self.types.as_slice() {
            [] => f.write_str(OBJECT),
            [one] => f.write_str(one),
            several => write!(f, "(either{})", Spaced(several)),
        }
    }
}

impl Display for Signature {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "({}{})", self.name, Spaced(&self.arguments))
    }
}

impl Display for Comparison {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Less => "<",
            Self::AtMost => "<=",
            Self::Equal => "=",
            Self::AtLeast => ">=",
            Self::Greater => ">",
        })
    }
}

impl Display for Number {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Literal(value) => write!(f, "{value}"),
            Self::Function(atom) => atom.fmt(f),
            Self::Duration => f.write_str("?duration"),
            Self::Combined(how, parts) => {
                let how = match how {
                    Arithmetic::Add => '+',
                    Arithmetic::Subtract => '-',
                    Arithmetic::Multiply => '*',
                    Arithmetic::Divide => '/',
                };
                write!(f, "({how} {} {})", parts[0], parts[1])
            }
        }
    }
}

impl Display for Condition {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fact(atom) => atom.fmt(f),
            Self::Same(a, b) => write!(f, "(= {a} {b})"),
            Self::Not(inner) => write!(f, "(not {inner})"),
            Self::And(parts) => write!(f, "(and{})", Spaced(parts)),
            Self::Or(parts) => write!(f, "(or{})", Spaced(parts)),
            Self::Forall(names, inner) => write!(f, "(forall ({}) {inner})", list(names)),
            Self::Exists(names, inner) => write!(f, "(exists ({}) {inner})", list(names)),
            Self::Compare(how, a, b) => write!(f, "({how} {a} {b})"),
        }
    }
}

impl Display for Effect {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::All(parts) => write!(f, "(and{})", Spaced(parts)),
            Self::Add(atom) => atom.fmt(f),
            Self::Delete(atom) => write!(f, "(not {atom})"),
            Self::Assign(how, atom, number) => {
                let how = match how {
                    Assignment::Set => "assign",
                    Assignment::Increase => "increase",
                    Assignment::Decrease => "decrease",
                    Assignment::ScaleUp => "scale-up",
                    Assignment::ScaleDown => "scale-down",
                };
                write!(f, "({how} {atom} {number})")
            }
            Self::When(when, then) => write!(f, "(when {when} {then})"),
            Self::Forall(names, inner) => write!(f, "(forall ({}) {inner})", list(names)),
        }
    }
}

fn list(names: &[Typed]) -> String {
    Spaced(names).to_string().trim_start().to_owned()
}

impl Display for Action {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [start, all, end] = &self.needs;
        let Some(bounds) = &self.duration else {
            writeln!(f, "(:action {}", self.name)?;
            writeln!(f, "    :parameters ({})", list(&self.parameters))?;
            writeln!(f, "    :precondition {start}")?;
            return write!(f, "    :effect {})", self.effects[0]);
        };
        writeln!(f, "(:durative-action {}", self.name)?;
        writeln!(f, "    :parameters ({})", list(&self.parameters))?;
        let bounds: Vec<_> =
            bounds.iter().map(|(how, number)| format!("({how} ?duration {number})")).collect();
        match bounds.as_slice() {
            [one] => writeln!(f, "    :duration {one}")?,
            several => writeln!(f, "    :duration (and{})", Spaced(several))?,
        }
        let needs = [("at start", start), ("over all", all), ("at end", end)];
        let needs: Vec<_> = needs
            .iter()
            .filter(|(_, need)| !need.is_nothing())
            .map(|(when, need)| format!("({when} {need})"))
            .collect();
        writeln!(f, "    :condition (and{})", Spaced(&needs))?;
        let effects: Vec<_> = ["at start", "at end"]
            .iter()
            .zip(&self.effects)
            .flat_map(|(when, effect)| timed(when, effect))
            .collect();
        write!(f, "    :effect (and{}))", Spaced(&effects))
    }
}

/// The parts of an effect, each with its moment. Some engines do not accept `and` inside one.
fn timed(when: &str, effect: &Effect) -> Vec<String> {
    match effect {
        Effect::All(parts) => parts.iter().flat_map(|part| timed(when, part)).collect(),
        _ => vec![format!("({when} {effect})")],
    }
}

impl Display for Domain {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "(define (domain {})", self.name)?;
        let requirements: Vec<_> = self.all_requirements().into_iter().collect();
        writeln!(f, "  (:requirements{})", Spaced(&requirements))?;
        let types: Vec<_> =
            self.types.iter().map(|(child, parent)| format!("{child} - {parent}")).collect();
        if !types.is_empty() {
            writeln!(f, "  (:types{})", Spaced(&types))?;
        }
        writeln!(f, "  (:predicates{})", Spaced(&self.predicates))?;
        if !self.functions.is_empty() {
            writeln!(f, "  (:functions{})", Spaced(&self.functions))?;
        }
        for action in &self.actions {
            writeln!(f, "  {action}")?;
        }
        f.write_str(")")
    }
}

impl Display for Problem {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "(define (problem {}) (:domain {})", self.name, self.domain)?;
        let objects: Vec<_> = self
            .objects
            .iter()
            .map(|object| format!("{} - {}", object.name, object.kind))
            .collect();
        writeln!(f, "  (:objects{})", Spaced(&objects))?;
        let numbers: Vec<_> =
            self.numbers.iter().map(|(atom, value)| format!("(= {atom} {value})")).collect();
        writeln!(f, "  (:init{}{})", Spaced(&self.facts), Spaced(&numbers))?;
        writeln!(f, "  (:goal {})", self.goal)?;
        if let Some(metric) = &self.metric {
            writeln!(f, "  (:metric {metric})")?;
        }
        f.write_str(")")
    }
}

impl Domain {
    /// The PDDL requirements of this domain, from annotations and from its contents.
    fn all_requirements(&self) -> BTreeSet<Name> {
        let mut text = String::new();
        for action in &self.actions {
            let _infallible = write!(text, "{action}");
        }
        let mut all: BTreeSet<Name> = self.requirements.iter().cloned().collect();
        let seen = [
            (
                ":negative-preconditions",
                self.actions.iter().any(|action| action.needs.iter().any(negates)),
            ),
            (":numeric-fluents", !self.functions.is_empty()),
            (":durative-actions", self.actions.iter().any(|action| action.duration.is_some())),
            (":disjunctive-preconditions", text.contains("(or ")),
            (":existential-preconditions", text.contains("(exists ")),
            (":universal-preconditions", text.contains("(forall ")),
            (":conditional-effects", text.contains("(when ")),
            (":equality", text.contains("(= ?")),
            (":strips", true),
            (":typing", true),
        ];
        all.extend(seen.iter().filter(|(_, is)| *is).map(|(name, _)| Name::new_static(name)));
        all
    }
}

fn negates(condition: &Condition) -> bool {
    match condition {
        Condition::Not(_) => true,
        Condition::And(parts) | Condition::Or(parts) => parts.iter().any(negates),
        Condition::Forall(_, inner) | Condition::Exists(_, inner) => negates(inner),
        Condition::Fact(_) | Condition::Same(..) | Condition::Compare(..) => false,
    }
}
