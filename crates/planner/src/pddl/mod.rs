//! The supported PDDL: types, predicates, numeric functions, actions with and without duration, problems. This module
//! parses and writes text; it knows no states or plans.
//!
//! Names are case-insensitive, as in PDDL, and stored in lower case. An object keeps the spelling of its first mention.

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

/// A name with its types: a parameter, or an argument of a predicate. An empty list of types means `object`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Typed {
    /// The name without the question mark.
    pub name: Name,
    /// Accepted types; any of them fits.
    pub types: Vec<Name>,
}

/// A predicate or numeric function with its arguments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Signature {
    /// Name of the predicate or function.
    pub name: Name,
    /// Arguments with their types.
    pub arguments: Vec<Typed>,
}

/// A variable or an object.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Term {
    /// Name of a variable, without the question mark.
    Variable(Name),
    /// Name of an object.
    Object(Name),
}

/// A predicate or function applied to terms.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Atom {
    /// Name of the predicate or function.
    pub name: Name,
    /// Terms in the order of the signature.
    pub arguments: Vec<Term>,
}

/// A comparison of two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// Less than, written as `<`.
    Less,
    /// Less than or equal to, `<=`.
    AtMost,
    /// Equal within a tolerance, `=`.
    Equal,
    /// Greater than or equal to, `>=`.
    AtLeast,
    /// Greater than, written as `>`.
    Greater,
}

/// A number that depends on the world.
#[derive(Debug, Clone, PartialEq)]
pub enum Number {
    /// A number in the text.
    Literal(f64),
    /// The value of a function.
    Function(Atom),
    /// The duration of the action, `?duration`.
    Duration,
    /// An operation on two numbers.
    Combined(Arithmetic, Box<[Self; 2]>),
}

/// An arithmetic operation on two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arithmetic {
    /// Sum, written as `+`.
    Add,
    /// Difference, written as `-`.
    Subtract,
    /// Product, written as `*`.
    Multiply,
    /// Quotient, written as `/`.
    Divide,
}

/// A condition on a world.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// The fact holds in the world.
    Fact(Atom),
    /// Both terms are one object.
    Same(Term, Term),
    /// The inner condition does not hold.
    Not(Box<Self>),
    /// All parts hold. An empty list always holds.
    And(Vec<Self>),
    /// At least one part holds.
    Or(Vec<Self>),
    /// The inner condition holds for all objects of these types.
    Forall(Vec<Typed>, Box<Self>),
    /// The inner condition holds for at least one choice of objects.
    Exists(Vec<Typed>, Box<Self>),
    /// The comparison of two numbers holds.
    Compare(Comparison, Number, Number),
}

/// A change of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Assignment {
    /// Sets the number: `assign`.
    Set,
    /// Adds to the number: `increase`.
    Increase,
    /// Subtracts from the number: `decrease`.
    Decrease,
    /// Multiplies the number: `scale-up`.
    ScaleUp,
    /// Divides the number: `scale-down`.
    ScaleDown,
}

/// An effect of an action on a world.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// All parts apply. An empty list changes nothing.
    All(Vec<Self>),
    /// The fact holds from now on.
    Add(Atom),
    /// The fact no longer holds.
    Delete(Atom),
    /// The value of a function changes.
    Assign(Assignment, Atom, Number),
    /// The inner effect applies if the condition held before.
    When(Condition, Box<Self>),
    /// The inner effect applies to all objects of these types.
    Forall(Vec<Typed>, Box<Self>),
}

/// A bound of an action's duration: the comparison and the number.
pub type DurationBound = (Comparison, Number);

/// An action. One without duration has its precondition and effect at its start.
#[derive(Debug, Clone, PartialEq)]
pub struct Action {
    /// Name of the action.
    pub name: Name,
    /// Parameters with their types.
    pub parameters: Vec<Typed>,
    /// Bounds of the duration; `None` if the action takes no time.
    pub duration: Option<Vec<DurationBound>>,
    /// Conditions at the start, during the action, and at the end.
    pub needs: [Condition; 3],
    /// Effects at the start and at the end.
    pub effects: [Effect; 2],
}

/// The types, predicates, functions and actions of a world.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Domain {
    /// Name of the domain.
    pub name: Name,
    /// Each type with its parent. `object` itself is not listed.
    pub types: Vec<(Name, Name)>,
    /// Predicates with their arguments.
    pub predicates: Vec<Signature>,
    /// Numeric functions with their arguments.
    pub functions: Vec<Signature>,
    /// Actions that a plan can use.
    pub actions: Vec<Action>,
    /// Requirements from annotations, in addition to those that the actions imply.
    pub requirements: Vec<Name>,
}

/// The root of all types.
pub const OBJECT: &str = "object";

impl Condition {
    /// The condition that always holds.
    pub fn nothing() -> Self {
        Self::And(Vec::new())
    }

    /// True if the condition is the empty conjunction.
    pub fn is_nothing(&self) -> bool {
        matches!(self, Self::And(parts) if parts.is_empty())
    }
}

impl Domain {
    /// The action with this name.
    pub fn action(&self, name: &str) -> Option<&Action> {
        self.actions.iter().find(|action| action.name == name)
    }

    /// The type and all its ancestors, up to `object`. The list of a circular type ends where the circle closes.
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

    /// True if an object of type `name` fits one of the expected types. An empty list accepts every type.
    pub fn fits(&self, name: &str, wanted: &[Name]) -> bool {
        wanted.is_empty() || self.line(name).iter().any(|kind| wanted.iter().any(|w| w == kind))
    }
}
