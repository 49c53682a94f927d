//! Problems: objects, facts and a goal.

use super::action::condition;
use super::number::{atom, number};
use super::signature::typed;
use super::text::{Expression, PddlError, lower, read_one};
use super::{Atom, Condition, Name, Number};
use smol_str::SmolStr;
use std::collections::BTreeSet;

/// Something in the world.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Object {
    /// In lower case.
    pub name: Name,
    /// As it was written.
    pub spelling: SmolStr,
    /// Its type; `object` where none was given.
    pub kind: Name,
}

/// A world and what is wanted of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// Its name.
    pub name: Name,
    /// The domain that it names.
    pub domain: Name,
    /// All objects.
    pub objects: Vec<Object>,
    /// What is a fact now.
    pub facts: Vec<Atom>,
    /// The numbers now.
    pub numbers: Vec<(Atom, f64)>,
    /// What is wanted.
    pub goal: Condition,
    /// `minimize …` or `maximize …`, as it was written.
    pub metric: Option<String>,
}

/// Reads a condition, such as a goal.
pub fn read_condition(text: &str) -> Result<Condition, PddlError> {
    condition(&read_one(text, "a condition such as `(and (at kitchen bob))`")?)
}

/// Reads `(define (problem …) …)`; a goal may be missing, and then asks for nothing.
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
                "the object `{spelling}` is there twice: capitals make no difference"
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

/// Adds a fact, unless it is among the `known` ones.
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

    /// Each name and each fact compared with all others takes minutes.
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
        assert!(read_problem(&twice).unwrap_err().to_string().contains("there twice"));
    }
}
