//! Values in files: port defaults and runtime values. Knows Python's built-in types, and keeps values that only
//! Python can read unchanged.

use crate::json::{Json, canonical_int};
use smol_str::SmolStr;
use std::sync::Arc;

const QUALNAME: &str = "__jsonqualname__";
const TYPE: &str = "__type__";
const ITEMS: &str = "items";

/// A value of one of Python's built-in types, or a document that Python has to read.
///
/// Cloning is cheap: anything large is shared.
#[derive(Debug, Clone, Default)]
pub enum Value {
    /// `None`, also the default of this type
    #[default]
    None,
    /// `bool`: either `True` or `False`
    Bool(bool),
    /// `int` of up to 64 bits
    Int(i64),
    /// `int` beyond 64 bits, as decimal digits
    BigInt(SmolStr),
    /// `float`, also `nan` and the infinities
    Float(f64),
    /// `str`, shared by clones of the value
    Str(Arc<str>),
    /// `list`, shared by clones of the value
    List(Arc<[Self]>),
    /// `tuple`, shared by clones of the value
    Tuple(Arc<[Self]>),
    /// `set`, in the order of the file
    Set(Arc<[Self]>),
    /// `dict`, in the order of the file; keys are `Int` or `Str`
    Dict(Arc<[(Self, Self)]>),
    /// A Python type, by its dotted name (`builtins.float`, `numpy.ndarray`)
    Type(SmolStr),
    /// An object that only Python can make, in the file's own encoding (an object with `__jsonqualname__`)
    Encoded(Arc<Json>),
}

/// Equality of the texts in the file: unlike in Python, `NaN` equals itself, and `1`, `1.0` and `True` differ.
impl PartialEq for Value {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::None, Self::None) => true,
            (Self::Bool(a), Self::Bool(b)) => a == b,
            (Self::Int(a), Self::Int(b)) => a == b,
            (Self::Float(a), Self::Float(b)) => same_float(*a, *b),
            (Self::Str(a), Self::Str(b)) => a == b,
            (Self::List(a), Self::List(b))
            | (Self::Tuple(a), Self::Tuple(b))
            | (Self::Set(a), Self::Set(b)) => a == b,
            (Self::Dict(a), Self::Dict(b)) => a == b,
            (Self::BigInt(a), Self::BigInt(b)) | (Self::Type(a), Self::Type(b)) => a == b,
            (Self::Encoded(a), Self::Encoded(b)) => a == b,
            _ => false,
        }
    }
}

/// True if two floats have equal texts: `NaN` is `NaN`, and `-0.0` is not `0.0`.
pub(crate) fn same_float(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

impl Value {
    /// Makes a `str` value with a copy of the text.
    pub fn str(text: &str) -> Self {
        Self::Str(text.into())
    }

    /// True if the value is `None`.
    pub fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }

    /// Reads the file's encoding of a value (`docs/format.md`, special values).
    ///
    /// A plain object is a `dict`; its keys become integers only if every key is the canonical text of one, so that no
    /// two keys become equal.
    pub fn from_json(json: &Json) -> Self {
        match json {
            Json::Null => Self::None,
            Json::Bool(b) => Self::Bool(*b),
            Json::Int(number) => Self::Int(*number),
            Json::BigInt(digits) => Self::BigInt(digits.clone()),
            Json::Float(number) => Self::Float(*number),
            Json::Str(text) => Self::Str(text.as_str().into()),
            Json::List(items) => Self::List(items.iter().map(Self::from_json).collect()),
            Json::Object(members) => Self::from_object(json, members),
        }
    }

    fn from_object(json: &Json, members: &[(SmolStr, Json)]) -> Self {
        if let Some(class) = json.get(QUALNAME) {
            return Self::from_qualified(json, class.as_str().unwrap_or_default());
        }
        if let Some(name) = json.get(TYPE).and_then(Json::as_str) {
            return Self::Type(crate::DataType::from_file(name).python_name());
        }
        let all_int = members.iter().all(|(key, _)| canonical_int(key).is_some());
        let key = |text: &SmolStr| match canonical_int(text) {
            Some(number) if all_int => Self::Int(number),
            _ => Self::str(text),
        };
        Self::Dict(members.iter().map(|(k, v)| (key(k), Self::from_json(v))).collect())
    }

    fn from_qualified(json: &Json, class: &str) -> Self {
        let items = || -> Option<Arc<[Self]>> {
            Some(json.get(ITEMS)?.as_list()?.iter().map(Self::from_json).collect())
        };
        match class {
            "__builtin__.tuple" | "builtins.tuple" => items().map(Self::Tuple),
            "__builtin__.set" | "builtins.set" => items().map(Self::Set),
            _ => None,
        }
        .unwrap_or_else(|| Self::Encoded(Arc::new(json.clone())))
    }

    /// The file's encoding of this value.
    pub fn to_json(&self) -> Json {
        match self {
            Self::None => Json::Null,
            Self::Bool(b) => Json::Bool(*b),
            Self::Int(number) => Json::Int(*number),
            Self::BigInt(digits) => Json::BigInt(digits.clone()),
            Self::Float(number) => Json::Float(*number),
            Self::Str(text) => Json::Str(SmolStr::new(text)),
            Self::List(items) => Json::List(items.iter().map(Self::to_json).collect()),
            Self::Tuple(items) => qualified("__builtin__.tuple", items),
            Self::Set(items) => qualified("__builtin__.set", items),
            Self::Dict(items) => {
                Json::Object(items.iter().map(|(k, v)| (k.key_text(), v.to_json())).collect())
            }
            Self::Type(name) => crate::DataType::from_file(name).to_json(),
            Self::Encoded(json) => (**json).clone(),
        }
    }

    fn key_text(&self) -> SmolStr {
        match self {
            Self::Str(text) => SmolStr::new(text),
            Self::Int(number) => SmolStr::new(number.to_string()),
            other => SmolStr::new(crate::json::write_compact(&other.to_json())),
        }
    }
}

fn qualified(class: &str, items: &[Value]) -> Json {
    Json::Object(vec![
        (QUALNAME.into(), Json::Str(class.into())),
        (ITEMS.into(), Json::List(items.iter().map(Value::to_json).collect())),
    ])
}

#[cfg(test)]
mod tests {
    use super::Value;
    use crate::json::{parse, write_compact};
    use expect_test::{Expect, expect};

    fn check(text: &str, expect: &Expect) {
        let value = parse(text).map(|json| Value::from_json(&json));
        let back = value.as_ref().map(|value| write_compact(&value.to_json()));
        expect.assert_eq(&format!("{value:?}\n{}", back.unwrap_or_default()));
    }

    #[test]
    fn special_values_round_trip() {
        check(
            r#"{"__jsonqualname__":"__builtin__.tuple","items":[1,null]}"#,
            &expect![[r#"
                Ok(Tuple([Int(1), None]))
                {"__jsonqualname__":"__builtin__.tuple","items":[1,null]}"#]],
        );
        check(
            r#"{"__type__":"__builtin__.float"}"#,
            &expect![[r#"
                Ok(Type("builtins.float"))
                {"__type__":"__builtin__.float"}"#]],
        );
        check(
            r#"{"__jsonqualname__":"numpy.ndarray","items":[1,2]}"#,
            &expect![[r#"
                Ok(Encoded(Object([("__jsonqualname__", Str("numpy.ndarray")), ("items", List([Int(1), Int(2)]))])))
                {"__jsonqualname__":"numpy.ndarray","items":[1,2]}"#]],
        );
    }

    #[test]
    fn dict_keys_never_fall_together() {
        check(
            r#"{"01":5,"1":2}"#,
            &expect![[r#"
                Ok(Dict([(Str("01"), Int(5)), (Str("1"), Int(2))]))
                {"01":5,"1":2}"#]],
        );
        check(
            r#"{"1":5,"-2":2}"#,
            &expect![[r#"
                Ok(Dict([(Int(1), Int(5)), (Int(-2), Int(2))]))
                {"-2":2,"1":5}"#]],
        );
    }
}
