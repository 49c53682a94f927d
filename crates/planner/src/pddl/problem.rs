//! Parses problems: objects, facts and a goal.

use super::action::condition;
use super::number::{atom, number};
use super::signature::typed;
use super::text::{Expression, PddlError, lower, read_one};
use super::{Atom, Condition, Name, Number};
use smol_str::SmolStr;
use std::collections::BTreeSet;

/// An object of a world.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Object {
    /// Name in lower case.
    pub name: Name,
    /// Name as in the text.
    pub spelling: SmolStr,
    /// Type of the object; `object` if none was given.
    pub kind: Name,
}

/// An initial world with a goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// Name of the problem.
    pub name: Name,
    /// Name of its domain.
    pub domain: Name,
    /// Objects of the world.
    pub objects: Vec<Object>,
    /// Facts that hold initially.
    pub facts: Vec<Atom>,
    /// Initial values of functions.
    pub numbers: Vec<(Atom, f64)>,
    /// Condition that a plan must reach.
    pub goal: Condition,
    /// Metric as in the text: `minimize …` or `maximize …`.
    pub metric: Option<String>,
}

/// Parses a condition, such as a goal.
pub fn read_condition(text: &str) -> Result<Condition, PddlError> {
    condition(&read_one(text, "a condition such as `(and (at kitchen bob))`")?)
}

/// Parses `(define (problem …) …)`. A missing goal always holds.
pub fn read_problem(text: &str) -> Result<Problem, PddlError> {
    let expression = read_one(text, "a problem: `(define (problem …) …)`")?;
    let (define, rest) = expression.head()?;
    if define != "define" {
        return Err(expression.error("a problem begins with `(define (problem NAME) …`"));
    }
    let mut problem = Problem {
        name: Name::default(),
        domain: Name::default(),
        objects: Vec::new(),
        facts: Vec::new(),
        numbers: Vec::new(),
        goal: Condition::nothing(),
        metric: None,
    };
    for part in rest {
        let (name, rest) = part.head()?;
        let word = || rest.first().and_then(Expression::word).unwrap_or_default();
        match name.as_str() {
            "problem" => problem.name = word(),
            "domain" => {
                return Err(part
                    .error("this is a domain: the facts are a problem, `(define (problem …) …)`"));
            }
            ":domain" => problem.domain = word(),
            ":requirements" => {}
            ":objects" => problem.objects = objects(rest)?,
            ":init" => {
                let mut known = problem.facts.iter().cloned().collect();
                rest.iter().try_for_each(|fact| add_fact(&mut problem, &mut known, fact))?;
            }
            ":goal" => {
                let goal = rest.first().ok_or_else(|| part.error("the goal is empty"))?;
                problem.goal = condition(goal)?;
            }
            ":metric" => {
                problem.metric = Some(rest.iter().map(written).collect::<Vec<_>>().join(" "));
            }
            _ => return Err(part.error(format!("`{name}` is not known in a problem"))),
        }
    }
    Ok(problem)
}

fn objects(items: &[Expression]) -> Result<Vec<Object>, PddlError> {
    let mut all: Vec<Object> = Vec::new();
    let mut names = BTreeSet::new();
    for (item, types) in typed(items)? {
        let spelling = item.spelling().cloned().unwrap_or_default();
        let name = lower(&spelling);
        if !names.insert(name.clone()) {
            return Err(item.error(format!(
                "the object `{spelling}` occurs twice: capitals make no difference"
            )));
        }
        let kind = match types.as_slice() {
            [] => super::OBJECT.into(),
            [one] => one.clone(),
            _ => return Err(item.error(format!("the object `{spelling}` needs one type"))),
        };
        all.push(Object { name, spelling, kind });
    }
    Ok(all)
}

/// Adds a fact, unless `known` contains it.
fn add_fact(
    problem: &mut Problem,
    known: &mut BTreeSet<Atom>,
    expression: &Expression,
) -> Result<(), PddlError> {
    let (name, rest) = expression.head()?;
    match (name.as_str(), rest) {
        ("=", [function, value]) => match number(value)? {
            Number::Literal(value) => problem.numbers.push((atom(function)?, value)),
            _ => return Err(value.error("a number is expected here")),
        },
        ("not", _) => {}
        ("at", [time, _]) if time.word().is_some_and(|word| word.parse::<f64>().is_ok()) => {
            return Err(expression.error("facts that come later in time are not known here"));
        }
        _ => {
            let fact = atom(expression)?;
            if known.insert(fact.clone()) {
                problem.facts.push(fact);
            }
        }
    }
    Ok(())
}

fn written(expression: &Expression) -> String {
    match expression {
        Expression::Word(word, _) => lower(word).into(),
        Expression::List(items, _) => {
            format!("({})", items.iter().map(written).collect::<Vec<_>>().join(" "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::read_problem;
    use std::fmt::Write as _;

    /// A comparison of every name and fact with all others would take minutes.
    #[test]
    fn a_world_of_very_many_objects_and_facts_is_read() {
        let (mut objects, mut facts) = (String::new(), String::new());
        for number in 0..100_000 {
            write!(objects, " o{number}").unwrap();
            write!(facts, "(at o{number}) ").unwrap();
        }
        let text =
            format!("(define (problem p) (:domain d) (:objects{objects}) (:init {facts} {facts}))");
        let problem = read_problem(&text).unwrap();
        assert_eq!((problem.objects.len(), problem.facts.len()), (100_000, 100_000));
        let twice = text.replace("(:objects", "(:objects O77");
        assert!(read_problem(&twice).unwrap_err().to_string().contains("occurs twice"));
    }
}
