//! PDDL as this program knows it: types, predicates, numeric functions, actions with and without duration, problems. Reads and
//! writes text; knows nothing of states or plans.
//!
//! Names are compared in lower case, as the language says; an object keeps the spelling of its first mention.

mod action;
mod number;
mod problem;
mod rename;
mod signature;
mod text;
mod write;

use smol_str::SmolStr;

pub use action::read_action;
pub use problem::{Object, Problem, read_condition, read_problem};
pub use rename::Renamed;
pub use signature::read_signatures;
pub use text::{PddlError, Place};

/// A name in lower case.
pub type Name = SmolStr;

/// A name with its types: a parameter, or an argument of a predicate. No type means `object`, several mean any of them.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Typed {
    /// Without the question mark.
    pub name: Name,
    /// Any of these.
    pub types: Vec<Name>,
}

/// A predicate or numeric function, and what it takes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Signature {
    /// Its name.
    pub name: Name,
    /// What it takes.
    pub arguments: Vec<Typed>,
}

/// A variable or an object.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Term {
    /// `?x`, without the question mark.
    Variable(Name),
    /// The name of an object.
    Object(Name),
}

/// A predicate or function with its arguments.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Atom {
    /// Which predicate or function.
    pub name: Name,
    /// Of what.
    pub arguments: Vec<Term>,
}

/// How two numbers are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `=`
    Equal,
    /// `>=`
    AtLeast,
    /// `>`
    Greater,
}

/// A number that depends on the world.
#[derive(Debug, Clone, PartialEq)]
pub enum Number {
    /// Written as it is.
    Literal(f64),
    /// The value of a function.
    Function(Atom),
    /// `?duration`: how long the action takes.
    Duration,
    /// Two numbers and what is done with them.
    Combined(Arithmetic, Box<[Self; 2]>),
}

/// What is done with two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arithmetic {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
}

/// What holds in a world or does not.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// It is a fact.
    Fact(Atom),
    /// Both are the same object.
    Same(Term, Term),
    /// It does not hold.
    Not(Box<Self>),
    /// All of them hold; none means nothing is asked.
    And(Vec<Self>),
    /// One of them holds.
    Or(Vec<Self>),
    /// It holds for all objects.
    Forall(Vec<Typed>, Box<Self>),
    /// It holds for one object.
    Exists(Vec<Typed>, Box<Self>),
    /// Two numbers compare so.
    Compare(Comparison, Number, Number),
}

/// What happens to a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Assignment {
    /// `assign`
    Set,
    /// `increase`
    Increase,
    /// `decrease`
    Decrease,
    /// `scale-up`
    ScaleUp,
    /// `scale-down`
    ScaleDown,
}

/// What changes in a world.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// All of them; none means nothing changes.
    All(Vec<Self>),
    /// It becomes a fact.
    Add(Atom),
    /// It is a fact no more.
    Delete(Atom),
    /// A number changes.
    Assign(Assignment, Atom, Number),
    /// Only where a condition held before.
    When(Condition, Box<Self>),
    /// For all objects.
    Forall(Vec<Typed>, Box<Self>),
}

/// What an action may take: the duration compared with a number.
pub type DurationBound = (Comparison, Number);

/// An action; one without duration has its precondition and effect at its start.
#[derive(Debug, Clone, PartialEq)]
pub struct Action {
    /// Its name.
    pub name: Name,
    /// What it is done with.
    pub parameters: Vec<Typed>,
    /// `None`: it takes no time.
    pub duration: Option<Vec<DurationBound>>,
    /// What it needs: at the start, all the time, at the end.
    pub needs: [Condition; 3],
    /// What it does: at the start, at the end.
    pub effects: [Effect; 2],
}

/// All that can be said and done.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Domain {
    /// Its name.
    pub name: Name,
    /// Each type and the one that it is a kind of; `object` is not listed.
    pub types: Vec<(Name, Name)>,
    /// All predicates.
    pub predicates: Vec<Signature>,
    /// All numeric functions.
    pub functions: Vec<Signature>,
    /// All actions.
    pub actions: Vec<Action>,
    /// Requirements that annotations name, beyond those that are seen in the actions.
    pub requirements: Vec<Name>,
}

/// The type of everything.
pub const OBJECT: &str = "object";

impl Condition {
    /// Nothing is asked.
    pub fn nothing() -> Self {
        Self::And(Vec::new())
    }

    /// Whether nothing is asked.
    pub fn is_nothing(&self) -> bool {
        matches!(self, Self::And(parts) if parts.is_empty())
    }
}

impl Domain {
    /// The action with this name.
    pub fn action(&self, name: &str) -> Option<&Action> {
        self.actions.iter().find(|action| action.name == name)
    }

    /// The type and all that it is a kind of, ending with `object`. A circle ends where it closes.
    pub fn line<'d>(&'d self, name: &'d str) -> Vec<&'d str> {
        let mut line = vec![name];
        while let Some((_, parent)) =
            line.last().and_then(|last| self.types.iter().find(|(child, _)| child == last))
        {
            if line.contains(&parent.as_str()) {
                break;
            }
            line.push(parent);
        }
        if line.last() != Some(&OBJECT) {
            line.push(OBJECT);
        }
        line
    }

    /// Whether something of type `name` may stand where one of `wanted` is asked for.
    pub fn fits(&self, name: &str, wanted: &[Name]) -> bool {
        wanted.is_empty() || self.line(name).iter().any(|kind| wanted.iter().any(|w| w == kind))
    }
}
