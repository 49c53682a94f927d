//! Parses actions: conditions and effects, with and without duration.

use super::number::{atom, comparison, is_number, number, term};
use super::signature::variables;
use super::text::{Expression, PddlError, read_one};
use super::{Action, Assignment, Condition, DurationBound, Effect, Number};

/// Parses one `(:action …)` or `(:durative-action …)`.
pub fn read_action(text: &str) -> Result<Action, PddlError> {
    action(&read_one(text, "an action")?)
}

fn action(expression: &Expression) -> Result<Action, PddlError> {
    let (kind, rest) = expression.head()?;
    let durative = match kind.as_str() {
        ":action" => false,
        ":durative-action" => true,
        _ => {
            return Err(expression.error(format!(
                "`{kind}` is no action: it begins with `:action` or `:durative-action`"
            )));
        }
    };
    let mut rest = rest.iter();
    let name = rest.next().and_then(Expression::word);
    let name = name.ok_or_else(|| expression.error("the name of the action is missing"))?;
    let mut action = Action {
        name,
        parameters: Vec::new(),
        duration: durative.then(Vec::new),
        needs: std::array::from_fn(|_| Condition::nothing()),
        effects: [Effect::All(Vec::new()), Effect::All(Vec::new())],
    };
    while let Some(key) = rest.next() {
        let word =
            key.word().ok_or_else(|| key.error("a part such as `:parameters` is expected here"))?;
        let value = rest.next().ok_or_else(|| key.error(format!("nothing follows `{word}`")))?;
        match (word.as_str(), durative) {
            (":parameters", _) => action.parameters = variables(value.list()?)?,
            (":precondition", false) => action.needs[0] = condition(value)?,
            (":effect", false) => action.effects[0] = effect(value)?,
            (":duration", true) => action.duration = Some(bounds(value)?),
            (":condition", true) => action.needs = timed_condition(value)?,
            (":effect", true) => action.effects = timed_effect(value)?,
            _ => return Err(key.error(format!("`{word}` is not known in `{kind}`"))),
        }
    }
    match &action.duration {
        Some(bounds) if bounds.is_empty() => {
            Err(expression.error("the `:duration` is missing, such as `(= ?duration 5)`"))
        }
        _ => Ok(action),
    }
}

/// Parses a condition. An empty list always holds.
pub(super) fn condition(expression: &Expression) -> Result<Condition, PddlError> {
    if expression.list()?.is_empty() {
        return Ok(Condition::nothing());
    }
    let (name, rest) = expression.head()?;
    let all = |items: &[Expression]| items.iter().map(condition).collect::<Result<Vec<_>, _>>();
    let two = || match rest {
        [a, b] => Ok((a, b)),
        _ => Err(expression.error(format!("`{name}` takes two parts"))),
    };
    Ok(match name.as_str() {
        "and" => Condition::And(all(rest)?),
        "or" => Condition::Or(all(rest)?),
        "not" => match rest {
            [one] => Condition::Not(Box::new(condition(one)?)),
            _ => return Err(expression.error("`not` takes one part")),
        },
        "imply" => {
            let (a, b) = two()?;
            Condition::Or(vec![Condition::Not(Box::new(condition(a)?)), condition(b)?])
        }
        "forall" | "exists" => {
            let (names, inner) = two()?;
            let (names, inner) = (variables(names.list()?)?, Box::new(condition(inner)?));
            if name == "forall" {
                Condition::Forall(names, inner)
            } else {
                Condition::Exists(names, inner)
            }
        }
        "preference" => {
            return Err(
                expression.error("preferences are not known here: leave it out, or make it a goal")
            );
        }
        _ => match comparison(&name) {
            Some(how) => {
                let (a, b) = two()?;
                if name == "=" && !is_number(a) && !is_number(b) {
                    Condition::Same(term(a)?, term(b)?)
                } else {
                    Condition::Compare(how, number(a)?, number(b)?)
                }
            }
            None => Condition::Fact(atom(expression)?),
        },
    })
}

pub(super) fn effect(expression: &Expression) -> Result<Effect, PddlError> {
    if expression.list()?.is_empty() {
        return Ok(Effect::All(Vec::new()));
    }
    let (name, rest) = expression.head()?;
    let two = || match rest {
        [a, b] => Ok((a, b)),
        _ => Err(expression.error(format!("`{name}` takes two parts"))),
    };
    let assign = |how| {
        let (to, value) = two()?;
        Ok(Effect::Assign(how, atom(to)?, number(value)?))
    };
    match name.as_str() {
        "and" => Ok(Effect::All(rest.iter().map(effect).collect::<Result<_, _>>()?)),
        "not" => match rest {
            [one] => Ok(Effect::Delete(atom(one)?)),
            _ => Err(expression.error("`not` takes one fact")),
        },
        "when" => {
            let (when, then) = two()?;
            Ok(Effect::When(condition(when)?, Box::new(effect(then)?)))
        }
        "forall" => {
            let (names, inner) = two()?;
            Ok(Effect::Forall(variables(names.list()?)?, Box::new(effect(inner)?)))
        }
        "assign" => assign(Assignment::Set),
        "increase" => assign(Assignment::Increase),
        "decrease" => assign(Assignment::Decrease),
        "scale-up" => assign(Assignment::ScaleUp),
        "scale-down" => assign(Assignment::ScaleDown),
        _ => Ok(Effect::Add(atom(expression)?)),
    }
}

fn bounds(expression: &Expression) -> Result<Vec<DurationBound>, PddlError> {
    let (name, rest) = expression.head()?;
    if name == "and" {
        return Ok(rest.iter().map(bounds).collect::<Result<Vec<_>, _>>()?.concat());
    }
    let how = comparison(&name);
    let how =
        how.ok_or_else(|| expression.error("a comparison such as `(= ?duration 5)` is expected"))?;
    match rest {
        [a, b] if a.word().as_deref() == Some("?duration") => match number(b)? {
            Number::Literal(seconds) if seconds < 0.0 => Err(b.error("a duration is not negative")),
            bound => Ok(vec![(how, bound)]),
        },
        _ => Err(expression.error("a comparison such as `(= ?duration 5)` is expected")),
    }
}

/// Parses `(at start …)`, `(over all …)` or `(at end …)`: the index of the moment, and the part inside.
fn moment(expression: &Expression) -> Result<(usize, &Expression), PddlError> {
    let wrong = || {
        expression.error(
            "in an action with duration, specify when: `(at start …)`, `(over all …)` or `(at end …)`",
        )
    };
    let [at, when, what] = expression.list()? else { return Err(wrong()) };
    let words = (at.word().unwrap_or_default(), when.word().unwrap_or_default());
    let index = match (words.0.as_str(), words.1.as_str()) {
        ("at", "start") => 0,
        ("over", "all") => 1,
        ("at", "end") => 2,
        _ => return Err(wrong()),
    };
    Ok((index, what))
}

/// The parts of an `and`, or the single part.
fn parts(expression: &Expression) -> Result<&[Expression], PddlError> {
    if expression.list()?.is_empty() {
        return Ok(&[]);
    }
    match expression.head()? {
        (name, rest) if name == "and" => Ok(rest),
        _ => Ok(std::slice::from_ref(expression)),
    }
}

fn timed_condition(expression: &Expression) -> Result<[Condition; 3], PddlError> {
    let mut lists: [Vec<Condition>; 3] = Default::default();
    for part in parts(expression)? {
        let (index, what) = moment(part)?;
        lists[index].push(condition(what)?);
    }
    Ok(lists.map(|mut list| match list.len() {
        1 => list.remove(0),
        _ => Condition::And(list),
    }))
}

fn timed_effect(expression: &Expression) -> Result<[Effect; 2], PddlError> {
    let mut lists: [Vec<Effect>; 2] = Default::default();
    for part in parts(expression)? {
        let (index, what) = moment(part)?;
        match index {
            0 => lists[0].push(effect(what)?),
            2 => lists[1].push(effect(what)?),
            _ => return Err(part.error("an effect happens `at start` or `at end`")),
        }
    }
    Ok(lists.map(Effect::All))
}
