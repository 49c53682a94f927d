//! Names for planning engines: ASCII letters, digits, `-` and `_`, no reserved word, unique across all kinds.
//!
//! Engines differ in the names that they accept. Some reject an object with the name of a type.

use super::{
    Action, Atom, Condition, Domain, Effect, Name, Number, OBJECT, Problem, Signature, Term, Typed,
};
use std::collections::{BTreeMap, BTreeSet};

/// Words with a meaning in PDDL, or in programs that read it.
const RESERVED: [&str; 37] = [
    "action",
    "all",
    "always",
    "and",
    "assign",
    "decrease",
    "define",
    "domain",
    "duration",
    "durative-action",
    "either",
    "end",
    "exists",
    "false",
    "forall",
    "imply",
    "increase",
    "maximize",
    "minimize",
    "not",
    "number",
    "object",
    "objects",
    "or",
    "over",
    "preference",
    "problem",
    "scale-down",
    "scale-up",
    "sometime",
    "start",
    "total-cost",
    "total-time",
    "true",
    "undefined",
    "when",
    "within",
];
/// Functions with a meaning for engines. They keep their names.
const KNOWN_FUNCTIONS: [&str; 2] = ["total-cost", "total-time"];

/// A domain and a problem with names for engines, and the original names.
#[derive(Debug, Clone)]
pub struct Renamed {
    /// The domain for an engine.
    pub domain: Domain,
    /// The problem for an engine.
    pub problem: Problem,
    originals: BTreeMap<Name, Name>,
}

impl Renamed {
    /// Renames everything that an engine may reject; other names stay.
    pub fn new(domain: &Domain, problem: &Problem) -> Self {
        let mut names = Names::default();
        // The first of several equal names stays. Types come last, because users see them least.
        names.add(Kind::Action, domain.actions.iter().map(|action| &action.name));
        names.add(Kind::Predicate, domain.predicates.iter().map(|one| &one.name));
        names.add(Kind::Function, domain.functions.iter().map(|one| &one.name));
        names.add(Kind::Object, problem.objects.iter().map(|object| &object.name));
        let parents = domain.types.iter().flat_map(|(child, parent)| [child, parent]);
        let kinds = problem.objects.iter().map(|object| &object.kind);
        names.add(Kind::Type, parents.chain(kinds));
        let (mut domain, mut problem) = (domain.clone(), problem.clone());
        names.domain(&mut domain);
        names.problem(&mut problem);
        Self { domain, problem, originals: names.originals }
    }

    /// The user's name for an engine's name.
    pub fn original(&self, name: &str) -> Name {
        self.originals.get(name).cloned().unwrap_or_else(|| name.into())
    }

    /// Restores the user's names in the output of an engine.
    pub fn with_originals(&self, text: &str) -> String {
        let mut told = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(start) = rest.find(is_of_name) {
            let word = &rest[start..];
            let word = &word[..word.find(|c| !is_of_name(c)).unwrap_or(word.len())];
            told.push_str(&rest[..start]);
            let original = self.originals.get(word.to_ascii_lowercase().as_str());
            told.push_str(original.map_or(word, |name| name.as_str()));
            rest = &rest[start + word.len()..];
        }
        told + rest
    }
}

/// The kind of a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Action,
    Predicate,
    Function,
    Object,
    Type,
    Variable,
}

impl Kind {
    fn suffix(self) -> &'static str {
        match self {
            Self::Action => "action",
            Self::Predicate => "fact",
            Self::Function => "value",
            Self::Object => "object",
            Self::Type => "type",
            Self::Variable => "variable",
        }
    }
}

#[derive(Debug, Default)]
struct Names {
    changed: BTreeMap<(Kind, Name), Name>,
    used: BTreeSet<Name>,
    originals: BTreeMap<Name, Name>,
}

impl Names {
    /// Assigns a unique name to each of these names.
    fn add<'n>(&mut self, kind: Kind, names: impl Iterator<Item = &'n Name>) {
        for name in names {
            let is_known = (kind == Kind::Type && name == OBJECT)
                || (kind == Kind::Function && KNOWN_FUNCTIONS.contains(&name.as_str()));
            if is_known || self.changed.contains_key(&(kind, name.clone())) {
                continue;
            }
            let fits = is_plain(name) && !self.used.contains(name);
            let new = if fits { name.clone() } else { self.free(kind, name) };
            self.used.insert(new.clone());
            if new != *name {
                self.originals.insert(new.clone(), name.clone());
            }
            self.changed.insert((kind, name.clone()), new);
        }
    }

    /// A name that is not in use.
    fn free(&self, kind: Kind, name: &str) -> Name {
        let ascii = |c: char| if is_of_name(c) { c } else { '_' };
        let base: String = name.chars().map(ascii).collect();
        let base = base.trim_matches(['_', '-']);
        let is_word = base.starts_with(|c: char| c.is_ascii_alphabetic());
        let base = if is_word {
            format!("{base}_{}", kind.suffix())
        } else {
            format!("{}_{base}", kind.suffix()).trim_end_matches('_').to_owned()
        };
        let numbered = (2_u64..).map(|number| format!("{base}_{number}"));
        let mut all = std::iter::once(base.clone()).chain(numbered).map(Name::from);
        all.find(|name| !self.used.contains(name) && is_plain(name)).unwrap_or_default()
    }

    fn change(&self, kind: Kind, name: &mut Name) {
        if let Some(new) = self.changed.get(&(kind, name.clone())) {
            *name = new.clone();
        }
    }

    fn domain(&mut self, domain: &mut Domain) {
        domain.name = Name::new_static("world");
        for (child, parent) in &mut domain.types {
            self.change(Kind::Type, child);
            self.change(Kind::Type, parent);
        }
        for predicate in &mut domain.predicates {
            self.signature(Kind::Predicate, predicate);
        }
        for function in &mut domain.functions {
            self.signature(Kind::Function, function);
        }
        for action in &mut domain.actions {
            self.action(action);
        }
    }

    fn problem(&mut self, problem: &mut Problem) {
        problem.name = Name::new_static("task");
        problem.domain = Name::new_static("world");
        for object in &mut problem.objects {
            self.change(Kind::Object, &mut object.name);
            self.change(Kind::Type, &mut object.kind);
        }
        for fact in &mut problem.facts {
            self.atom(Kind::Predicate, fact);
        }
        for (function, _) in &mut problem.numbers {
            self.atom(Kind::Function, function);
        }
        self.condition(&mut problem.goal);
        if let Some(metric) = &mut problem.metric {
            *metric = self.metric(metric);
        }
    }

    /// Renames a metric, which is text. A word after a bracket is a function; others may be objects.
    fn metric(&self, text: &str) -> String {
        let spaced = text.replace('(', " ( ").replace(')', " ) ");
        let mut is_head = false;
        let words = spaced.split_whitespace().map(|word| {
            let mut name = Name::from(word);
            self.change(if is_head { Kind::Function } else { Kind::Object }, &mut name);
            is_head = word == "(";
            name.to_string()
        });
        words.collect::<Vec<_>>().join(" ").replace("( ", "(").replace(" )", ")")
    }

    fn signature(&mut self, kind: Kind, signature: &mut Signature) {
        self.change(kind, &mut signature.name);
        self.all_typed(&mut signature.arguments);
    }

    fn action(&mut self, action: &mut Action) {
        self.change(Kind::Action, &mut action.name);
        self.all_typed(&mut action.parameters);
        for (_, number) in action.duration.iter_mut().flatten() {
            self.number(number);
        }
        action.needs.iter_mut().for_each(|need| self.condition(need));
        action.effects.iter_mut().for_each(|effect| self.effect(effect));
    }

    fn all_typed(&mut self, all: &mut [Typed]) {
        for typed in all {
            self.variable(&mut typed.name);
            self.add(Kind::Type, typed.types.iter());
            typed.types.iter_mut().for_each(|kind| self.change(Kind::Type, kind));
        }
    }

    /// Renames a variable. Its question mark distinguishes it from other names.
    fn variable(&mut self, name: &mut Name) {
        if !is_plain(name) {
            self.add(Kind::Variable, std::iter::once(&*name));
            self.change(Kind::Variable, name);
        }
    }

    fn atom(&mut self, kind: Kind, atom: &mut Atom) {
        self.change(kind, &mut atom.name);
        atom.arguments.iter_mut().for_each(|term| self.term(term));
    }

    fn term(&mut self, term: &mut Term) {
        match term {
            Term::Variable(name) => self.variable(name),
            Term::Object(name) => self.change(Kind::Object, name),
        }
    }

    fn number(&mut self, number: &mut Number) {
        match number {
            Number::Literal(_) | Number::Duration => {}
            Number::Function(atom) => self.atom(Kind::Function, atom),
            Number::Combined(_, parts) => parts.iter_mut().for_each(|part| self.number(part)),
        }
    }

    fn condition(&mut self, condition: &mut Condition) {
        match condition {
            Condition::Fact(atom) => self.atom(Kind::Predicate, atom),
            Condition::Same(one, other) => {
                self.term(one);
                self.term(other);
            }
            Condition::Not(inner) => self.condition(inner),
            Condition::And(parts) | Condition::Or(parts) => {
                for part in parts {
                    self.condition(part);
                }
            }
            Condition::Forall(names, inner) | Condition::Exists(names, inner) => {
                self.all_typed(names);
                self.condition(inner);
            }
            Condition::Compare(_, one, other) => {
                self.number(one);
                self.number(other);
            }
        }
    }

    fn effect(&mut self, effect: &mut Effect) {
        match effect {
            Effect::All(parts) => parts.iter_mut().for_each(|part| self.effect(part)),
            Effect::Add(atom) | Effect::Delete(atom) => self.atom(Kind::Predicate, atom),
            Effect::Assign(_, atom, number) => {
                self.atom(Kind::Function, atom);
                self.number(number);
            }
            Effect::When(when, then) => {
                self.condition(when);
                self.effect(then);
            }
            Effect::Forall(names, inner) => {
                self.all_typed(names);
                self.effect(inner);
            }
        }
    }
}

fn is_of_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_' || c == '-'
}

/// True for names that every engine accepts.
fn is_plain(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(is_of_name)
        && RESERVED.binary_search(&name).is_err()
}
