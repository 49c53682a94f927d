//! Parses lists of names with types, and predicates and functions with their arguments.

use super::text::{Expression, PddlError, lower, read};
use super::{Name, OBJECT, Signature, Typed};

/// Parses a sequence of predicates or functions: `(at ?place - location ?who - person)`.
pub fn read_signatures(text: &str) -> Result<Vec<Signature>, PddlError> {
    read(text)?.iter().map(signature).collect()
}

pub(super) fn signature(expression: &Expression) -> Result<Signature, PddlError> {
    let (name, rest) = expression.head()?;
    Ok(Signature { name, arguments: variables(rest)? })
}

/// Parses `?a ?b - type ?c - (either x y)`.
pub(super) fn variables(items: &[Expression]) -> Result<Vec<Typed>, PddlError> {
    let mut all = Vec::new();
    for (item, types) in typed(items)? {
        let word = item.word().unwrap_or_default();
        let name = word.strip_prefix('?').filter(|name| !name.is_empty());
        let name =
            name.ok_or_else(|| item.error(format!("`{word}` is no variable: write `?{word}`")))?;
        all.push(Typed { name: name.into(), types });
    }
    Ok(all)
}

/// The names, each with its types.
pub(super) fn typed(items: &[Expression]) -> Result<Vec<(&Expression, Vec<Name>)>, PddlError> {
    let mut all: Vec<(&Expression, Vec<Name>)> = Vec::new();
    let mut open = 0;
    let mut items = items.iter();
    while let Some(item) = items.next() {
        let word = item.word().ok_or_else(|| item.error("a name is expected here, not a list"))?;
        if word != "-" {
            all.push((item, Vec::new()));
            continue;
        }
        let types = items.next().ok_or_else(|| item.error("a type is missing behind `-`"))?;
        let types = types_of(types)?;
        for (_, slot) in &mut all[open..] {
            slot.clone_from(&types);
        }
        open = all.len();
    }
    Ok(all)
}

fn types_of(expression: &Expression) -> Result<Vec<Name>, PddlError> {
    let names = match expression {
        Expression::Word(word, _) => vec![lower(word)],
        Expression::List(..) => {
            let (either, rest) = expression.head()?;
            if either != "either" {
                return Err(expression.error("a type is expected: a name, or `(either a b)`"));
            }
            rest.iter().filter_map(Expression::word).collect()
        }
    };
    Ok(if names.iter().any(|name| name == OBJECT) { Vec::new() } else { names })
}
