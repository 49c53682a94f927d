//! Parses nested lists of words, the syntax of PDDL. This module knows brackets, comments and positions, but no
//! meaning.

use super::Name;
use smol_str::SmolStr;
use std::fmt;

/// Limit of the nesting depth. No real PDDL is nested deeper.
const DEPTH_MAX: usize = 100;

/// A position in a text, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Place {
    /// Line in the text.
    pub line: usize,
    /// The column, in characters.
    pub column: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

/// A syntax error with its position.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {reason}")]
pub struct PddlError {
    /// Position of the error.
    pub place: Place,
    /// The unexpected text, and what is expected instead.
    pub reason: String,
}

/// A word or a list in brackets.
#[derive(Debug, Clone)]
pub(super) enum Expression {
    Word(SmolStr, Place),
    List(Vec<Self>, Place),
}

impl Expression {
    pub(super) fn place(&self) -> Place {
        match self {
            Self::Word(_, place) | Self::List(_, place) => *place,
        }
    }

    pub(super) fn error(&self, reason: impl Into<String>) -> PddlError {
        PddlError { place: self.place(), reason: reason.into() }
    }

    /// The word in lower case.
    pub(super) fn word(&self) -> Option<Name> {
        match self {
            Self::Word(word, _) => Some(lower(word)),
            Self::List(..) => None,
        }
    }

    /// The word in its original spelling.
    pub(super) fn spelling(&self) -> Option<&SmolStr> {
        match self {
            Self::Word(word, _) => Some(word),
            Self::List(..) => None,
        }
    }

    pub(super) fn list(&self) -> Result<&[Self], PddlError> {
        match self {
            Self::List(items, _) => Ok(items),
            Self::Word(word, _) => {
                Err(self.error(format!("found `{word}`, expected a list in brackets")))
            }
        }
    }

    /// The first word of a list, and the rest.
    pub(super) fn head(&self) -> Result<(Name, &[Self]), PddlError> {
        let (first, rest) = self
            .list()?
            .split_first()
            .ok_or_else(|| self.error("found an empty list, expected a name"))?;
        let name =
            first.word().ok_or_else(|| first.error("a name is expected here, not a list"))?;
        Ok((name, rest))
    }
}

pub(super) fn lower(word: &str) -> Name {
    if word.bytes().any(|byte| byte.is_ascii_uppercase()) {
        word.to_ascii_lowercase().into()
    } else {
        word.into()
    }
}

/// Parses all expressions of a text.
pub(super) fn read(text: &str) -> Result<Vec<Expression>, PddlError> {
    let mut open: Vec<(Vec<Expression>, Place)> = Vec::new();
    let mut top = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.split(';').next().unwrap_or_default();
        let mut characters = line.char_indices().peekable();
        let mut column = 0;
        while let Some((start, character)) = characters.next() {
            column += 1;
            let place = Place { line: number + 1, column };
            let error = |reason: &str| PddlError { place, reason: reason.to_owned() };
            if character.is_whitespace() {
                continue;
            }
            match character {
                '(' if open.len() >= DEPTH_MAX => return Err(error("lists nest too deep here")),
                '(' => open.push((Vec::new(), place)),
                ')' => {
                    let (items, place) =
                        open.pop().ok_or_else(|| error("this `)` closes nothing"))?;
                    add(&mut open, &mut top, Expression::List(items, place));
                }
                _ => {
                    let mut end = start + character.len_utf8();
                    while let Some((at, next)) = characters
                        .next_if(|(_, next)| !(next.is_whitespace() || "()".contains(*next)))
                    {
                        end = at + next.len_utf8();
                        column += 1;
                    }
                    add(&mut open, &mut top, Expression::Word(line[start..end].into(), place));
                }
            }
        }
    }
    match open.pop() {
        Some((_, place)) => Err(PddlError { place, reason: "this `(` is never closed".to_owned() }),
        None => Ok(top),
    }
}

fn add(open: &mut [(Vec<Expression>, Place)], top: &mut Vec<Expression>, item: Expression) {
    match open.last_mut() {
        Some((items, _)) => items.push(item),
        None => top.push(item),
    }
}

/// Parses a text that consists of one list.
pub(super) fn read_one(text: &str, what: &str) -> Result<Expression, PddlError> {
    let mut all = read(text)?.into_iter();
    let missing = || PddlError {
        place: Place { line: 1, column: 1 },
        reason: format!("the text is empty: {what} is expected"),
    };
    let first = all.next().ok_or_else(missing)?;
    match all.next() {
        Some(second) => Err(second.error(format!("this is too much: one {what} is expected"))),
        None => Ok(first),
    }
}

#[cfg(test)]
mod tests {
    use super::{DEPTH_MAX, Place, read};

    #[test]
    fn lists_that_nest_too_deep_are_refused_with_their_place() {
        let nested = |levels: usize| read(&("(".repeat(levels) + &")".repeat(levels)));
        assert!(nested(DEPTH_MAX).is_ok());
        for levels in [DEPTH_MAX + 1, 100_000] {
            let refused = nested(levels).expect_err("too deep");
            assert_eq!(refused.place, Place { line: 1, column: DEPTH_MAX + 1 });
            assert_eq!(refused.reason, "lists nest too deep here");
        }
    }
}
