//! JSON in the dialect of the reference (Python's `json` module): `NaN` and `Infinity` literals, integers of any size,
//! sorted keys. Knows text only, no files and no meaning of keys.

mod parse;
mod write;

use smol_str::SmolStr;

pub use parse::{MAX_DEPTH, ParseError, parse};
pub(crate) use write::python_float;
pub use write::{canonical_int, write, write_compact};

/// A parsed JSON document. Objects keep the order of their text; writing sorts.
#[derive(Debug, Clone)]
pub enum Json {
    /// The literal `null` of JSON.
    Null,
    /// The literals `true` and `false`.
    Bool(bool),
    /// An integer that fits 64 bits.
    Int(i64),
    /// Decimal digits (with sign) of an integer that does not fit 64 bits.
    BigInt(SmolStr),
    /// A number with fraction or exponent, `NaN` or `±Infinity`.
    Float(f64),
    /// A string, without quotes and escapes.
    Str(SmolStr),
    /// `[…]`: items in the order of the text.
    List(Vec<Self>),
    /// `{…}`: keys are unique (a repeated key keeps its last value, as in Python).
    Object(Vec<(SmolStr, Self)>),
}

/// Equality of the texts: `NaN` equals itself, and the order of members counts.
impl PartialEq for Json {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Null, Self::Null) => true,
            (Self::Bool(a), Self::Bool(b)) => a == b,
            (Self::Int(a), Self::Int(b)) => a == b,
            (Self::BigInt(a), Self::BigInt(b)) | (Self::Str(a), Self::Str(b)) => a == b,
            (Self::Float(a), Self::Float(b)) => crate::value::same_float(*a, *b),
            (Self::List(a), Self::List(b)) => a == b,
            (Self::Object(a), Self::Object(b)) => a == b,
            _ => false,
        }
    }
}

impl Json {
    /// The value of `key` if this is an object with this key.
    pub fn get(&self, key: &str) -> Option<&Self> {
        match self {
            Self::Object(items) => items.iter().find(|(k, _)| k == key).map(|(_, v)| v),
            _ => None,
        }
    }

    /// The text if this is a string.
    pub fn as_str(&self) -> Option<&str> {
        match self {
            Self::Str(text) => Some(text),
            _ => None,
        }
    }

    /// The number if this is an integer of 64 bits.
    pub fn as_int(&self) -> Option<i64> {
        match self {
            Self::Int(number) => Some(*number),
            _ => None,
        }
    }

    /// The number if this is an integer of 64 bits or a float.
    pub fn as_number(&self) -> Option<f64> {
        match self {
            #[expect(clippy::cast_precision_loss, reason = "coordinates are far below 2^52")]
            Self::Int(number) => Some(*number as f64),
            Self::Float(number) => Some(*number),
            _ => None,
        }
    }

    /// The members if this is an object.
    pub fn as_object(&self) -> Option<&[(SmolStr, Self)]> {
        match self {
            Self::Object(items) => Some(items),
            _ => None,
        }
    }

    /// The items if this is a list.
    pub fn as_list(&self) -> Option<&[Self]> {
        match self {
            Self::List(items) => Some(items),
            _ => None,
        }
    }

    /// Sets `key` to `value`. Anything but an object becomes an empty object first.
    pub fn set(&mut self, key: &str, value: Self) {
        if !matches!(self, Self::Object(_)) {
            *self = Self::Object(Vec::new());
        }
        if let Self::Object(items) = self {
            match items.iter_mut().find(|(k, _)| k == key) {
                Some(slot) => slot.1 = value,
                None => items.push((key.into(), value)),
            }
        }
    }

    /// Removes `key` from an object.
    pub fn remove(&mut self, key: &str) -> Option<Self> {
        match self {
            Self::Object(items) => {
                let index = items.iter().position(|(k, _)| k == key)?;
                Some(items.remove(index).1)
            }
            _ => None,
        }
    }

    /// An object without members.
    pub fn object() -> Self {
        Self::Object(Vec::new())
    }

    /// The kind of the value, for error messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "a boolean",
            Self::Int(_) | Self::BigInt(_) => "an integer",
            Self::Float(_) => "a float",
            Self::Str(_) => "a string",
            Self::List(_) => "a list",
            Self::Object(_) => "an object",
        }
    }
}

#[cfg(test)]
mod tests;
