//! Parses terms, atoms and numbers.

use super::text::{Expression, PddlError};
use super::{Arithmetic, Atom, Comparison, Number, Term};

pub(super) fn comparison(word: &str) -> Option<Comparison> {
    Some(match word {
        "<" => Comparison::Less,
        "<=" => Comparison::AtMost,
        "=" => Comparison::Equal,
        ">=" => Comparison::AtLeast,
        ">" => Comparison::Greater,
        _ => return None,
    })
}

pub(super) fn term(expression: &Expression) -> Result<Term, PddlError> {
    let word = expression.word();
    let word = word.ok_or_else(|| expression.error("a variable or an object is expected here"))?;
    Ok(match word.strip_prefix('?') {
        Some(name) => Term::Variable(name.into()),
        None => Term::Object(word),
    })
}

pub(super) fn atom(expression: &Expression) -> Result<Atom, PddlError> {
    let (name, rest) = expression.head()?;
    let arguments = rest.iter().map(term).collect::<Result<_, _>>()?;
    Ok(Atom { name, arguments })
}

/// True if an operand of `=` is a number, not a term.
pub(super) fn is_number(expression: &Expression) -> bool {
    match expression {
        Expression::List(..) => true,
        Expression::Word(word, _) => {
            word.eq_ignore_ascii_case("?duration") || word.parse::<f64>().is_ok_and(f64::is_finite)
        }
    }
}

pub(super) fn number(expression: &Expression) -> Result<Number, PddlError> {
    let Expression::List(items, _) = expression else {
        let word = expression.word().unwrap_or_default();
        if word == "?duration" {
            return Ok(Number::Duration);
        }
        let value = word.parse().ok().filter(|value: &f64| value.is_finite());
        let wrong = || {
            expression.error(format!("`{word}` is no number: write one, or a function in brackets"))
        };
        return value.map(Number::Literal).ok_or_else(wrong);
    };
    let (name, rest) = expression.head()?;
    let operator = match name.as_str() {
        "+" => Arithmetic::Add,
        "-" => Arithmetic::Subtract,
        "*" => Arithmetic::Multiply,
        "/" => Arithmetic::Divide,
        _ => return atom(expression).map(Number::Function),
    };
    let mut values = rest.iter().map(number).collect::<Result<Vec<_>, _>>()?.into_iter();
    let first = values.next().ok_or_else(|| items[0].error("numbers are missing behind this"))?;
    let mut rest = values.peekable();
    if rest.peek().is_none() && operator == Arithmetic::Subtract {
        return Ok(combined(operator, Number::Literal(0.0), first));
    }
    Ok(rest.fold(first, |a, b| combined(operator, a, b)))
}

fn combined(operator: Arithmetic, a: Number, b: Number) -> Number {
    Number::Combined(operator, Box::new([a, b]))
}
