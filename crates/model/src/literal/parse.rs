//! Parses a text to a [`Value`]: one pass, no recursion deeper than [`MAX_DEPTH`].

use super::{number, text};
use crate::Value;

/// Deeper nesting is left to Python: it is far beyond any default and protects the stack.
pub const MAX_DEPTH: usize = 64;

/// A syntax error in a literal.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LiteralError {
    /// Not a Python literal.
    #[error("character {at}: {reason}")]
    Syntax {
        /// The offset in bytes.
        at: usize,
        /// The unexpected or missing element.
        reason: &'static str,
    },
    /// Only Python can read it: bytes, complex numbers, very deep nesting, escapes by name.
    #[error("only Python can read {0}")]
    NeedsPython(&'static str),
}

/// Reads one Python literal; white space around it is allowed.
pub fn parse(text: &str) -> Result<Value, LiteralError> {
    let mut parser = LiteralParser::new(text);
    let value = parser.open_value()?;
    parser.skip_space();
    if parser.at < text.len() {
        return Err(parser.error("more text follows the value"));
    }
    Ok(value)
}

pub(super) struct LiteralParser<'t> {
    pub(super) text: &'t str,
    pub(super) at: usize,
}

impl<'t> LiteralParser<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self { text, at: 0 }
    }

    pub(super) fn error(&self, reason: &'static str) -> LiteralError {
        LiteralError::Syntax { at: self.at, reason }
    }

    pub(super) fn rest(&self) -> &'t str {
        self.text.get(self.at..).unwrap_or_default()
    }

    pub(super) fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    pub(super) fn skip_space(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.at += 1;
        }
    }

    fn eat(&mut self, byte: u8) -> bool {
        self.skip_space();
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    /// A value, or a tuple without brackets.
    fn open_value(&mut self) -> Result<Value, LiteralError> {
        let first = self.value(0)?;
        if !self.eat(b',') {
            return Ok(first);
        }
        let mut items = vec![first];
        self.skip_space();
        while self.at < self.text.len() {
            items.push(self.value(1)?);
            if !self.eat(b',') {
                break;
            }
            self.skip_space();
        }
        Ok(Value::Tuple(items.into()))
    }

    fn value(&mut self, depth: usize) -> Result<Value, LiteralError> {
        if depth > MAX_DEPTH {
            return Err(LiteralError::NeedsPython("nesting this deep"));
        }
        self.skip_space();
        match self.peek() {
            None => Err(self.error("the text ends where a value should be")),
            Some(b'[') => self.list(depth),
            Some(b'(') => self.tuple(depth),
            Some(b'{') => self.braces(depth),
            Some(b'"' | b'\'') => text::string(self),
            Some(b'0'..=b'9' | b'.' | b'+' | b'-') => number::number(self),
            Some(_) => self.word(),
        }
    }

    fn word(&mut self) -> Result<Value, LiteralError> {
        let rest = self.rest();
        let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        let word = &rest[..length];
        if rest[length..].starts_with(['"', '\'']) {
            return text::prefixed_string(self, word);
        }
        let value = match word {
            "None" => Value::None,
            "True" => Value::Bool(true),
            "False" => Value::Bool(false),
            "set" if rest.starts_with("set()") => {
                self.at += "()".len();
                Value::Set([].into())
            }
            _ => return Err(self.error("not a Python literal")),
        };
        self.at += length;
        Ok(value)
    }

    fn list(&mut self, depth: usize) -> Result<Value, LiteralError> {
        self.at += 1;
        Ok(Value::List(self.items(b']', depth)?.0.into()))
    }

    /// `()`, `(1,)`, `(1, 2)`; `(1)` is 1.
    fn tuple(&mut self, depth: usize) -> Result<Value, LiteralError> {
        self.at += 1;
        let (mut items, comma) = self.items(b')', depth)?;
        match items.pop() {
            Some(only) if items.is_empty() && !comma => Ok(only),
            last => Ok(Value::Tuple(items.into_iter().chain(last).collect())),
        }
    }

    /// Values up to `close`, and whether a comma follows the last.
    fn items(&mut self, close: u8, depth: usize) -> Result<(Vec<Value>, bool), LiteralError> {
        let mut items = Vec::new();
        let mut comma = false;
        while !self.eat(close) {
            if !items.is_empty() && !comma {
                return Err(self.error("expected a comma or the closing bracket"));
            }
            items.push(self.value(depth + 1)?);
            comma = self.eat(b',');
        }
        Ok((items, comma))
    }

    /// A dict or a set.
    fn braces(&mut self, depth: usize) -> Result<Value, LiteralError> {
        self.at += 1;
        if self.eat(b'}') {
            return Ok(Value::Dict([].into()));
        }
        let first = self.value(depth + 1)?;
        if self.eat(b':') {
            return self.dict(first, depth);
        }
        let comma = self.eat(b',');
        let (rest, _) = if comma || self.at_close() {
            self.items(b'}', depth)?
        } else {
            return Err(self.error("expected a comma, a colon or the closing brace"));
        };
        let mut items: Vec<Value> = Vec::with_capacity(rest.len() + 1);
        for item in std::iter::once(first).chain(rest) {
            self.hashable(&item)?;
            if !items.contains(&item) {
                items.push(item);
            }
        }
        Ok(Value::Set(items.into()))
    }

    fn at_close(&mut self) -> bool {
        self.skip_space();
        self.peek() == Some(b'}')
    }

    fn dict(&mut self, first: Value, depth: usize) -> Result<Value, LiteralError> {
        let mut members: Vec<(Value, Value)> = Vec::new();
        let mut key = first;
        loop {
            self.hashable(&key)?;
            let value = self.value(depth + 1)?;
            match members.iter_mut().find(|(known, _)| *known == key) {
                Some(member) => member.1 = value,
                None => members.push((key, value)),
            }
            let comma = self.eat(b',');
            if self.eat(b'}') {
                return Ok(Value::Dict(members.into()));
            }
            if !comma {
                return Err(self.error("expected a comma or the closing brace"));
            }
            key = self.value(depth + 1)?;
            if !self.eat(b':') {
                return Err(self.error("expected a colon"));
            }
        }
    }

    fn hashable(&self, value: &Value) -> Result<(), LiteralError> {
        match value {
            Value::List(_) | Value::Dict(_) | Value::Set(_) => {
                Err(self.error("lists, dicts and sets cannot be keys or members of a set"))
            }
            _ => Ok(()),
        }
    }
}
