//! Data types of ports. Knows Python's built-in types; [`Types`] covers all others.

use crate::{Json, Value};
use smol_str::{SmolStr, format_smolstr};
use std::fmt;

/// The declared type of a data port or scoped variable.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DataType {
    /// `NoneType`: no type is declared.
    None,
    /// Python's `bool`, also accepted as `int`.
    Bool,
    /// Python's `int`, of any size.
    Int,
    /// Python's `float`, a 64-bit number.
    Float,
    /// Python's `str`, a text.
    Str,
    /// Python's `list`, of any items.
    List,
    /// Python's `tuple`, of any items.
    Tuple,
    /// Python's `dict`, of any entries.
    Dict,
    /// Python's `set`, of any items.
    Set,
    /// Python's `object`: any value fits.
    Object,
    /// Any other type, by its dotted Python name (`numpy.ndarray`, `builtins.bytes`).
    Named(SmolStr),
}

const BUILTINS: [(&str, DataType); 10] = [
    ("NoneType", DataType::None),
    ("bool", DataType::Bool),
    ("int", DataType::Int),
    ("float", DataType::Float),
    ("str", DataType::Str),
    ("list", DataType::List),
    ("tuple", DataType::Tuple),
    ("dict", DataType::Dict),
    ("set", DataType::Set),
    ("object", DataType::Object),
];

impl DataType {
    /// Reads a name as files and people write it: `int`, `__builtin__.int`, `builtins.int`, `numpy.ndarray`, `None`.
    pub fn from_file(name: &str) -> Self {
        if name == "None" || name.ends_with("NoneType") {
            return Self::None;
        }
        let module = name.strip_prefix("__builtin__.").or_else(|| name.strip_prefix("builtins."));
        let short = module.unwrap_or(name);
        match BUILTINS.iter().find(|(builtin, _)| *builtin == short) {
            Some((_, data_type)) => data_type.clone(),
            None if module.is_some() => Self::Named(format_smolstr!("builtins.{short}")),
            None => Self::Named(name.into()),
        }
    }

    /// The name for people, without `builtins.` for built-in types.
    pub fn short_name(&self) -> SmolStr {
        match BUILTINS.iter().find(|(_, data_type)| data_type == self) {
            Some((name, _)) => SmolStr::new_static(name),
            None => match self {
                Self::Named(name) => {
                    name.strip_prefix("builtins.").map_or(name.clone(), SmolStr::new)
                }
                _ => SmolStr::default(),
            },
        }
    }

    /// The dotted Python name: `builtins.int`, `numpy.ndarray`.
    pub fn python_name(&self) -> SmolStr {
        if let Self::Named(name) = self {
            return name.clone();
        }
        format_smolstr!("builtins.{}", self.short_name())
    }

    /// The file's encoding, `{"__type__": "__builtin__.int"}`.
    pub fn to_json(&self) -> Json {
        let name = self.python_name();
        let name = match name.strip_prefix("builtins.") {
            Some(short) => format_smolstr!("__builtin__.{short}"),
            None => name,
        };
        Json::Object(vec![("__type__".into(), Json::Str(name))])
    }

    /// The type of a value of the model; `None` for a value that only Python can read.
    pub fn of(value: &Value) -> Option<Self> {
        Some(match value {
            Value::None => Self::None,
            Value::Bool(_) => Self::Bool,
            Value::Int(_) | Value::BigInt(_) => Self::Int,
            Value::Float(_) => Self::Float,
            Value::Str(_) => Self::Str,
            Value::List(_) => Self::List,
            Value::Tuple(_) => Self::Tuple,
            Value::Set(_) => Self::Set,
            Value::Dict(_) => Self::Dict,
            Value::Type(_) => Self::Named("builtins.type".into()),
            Value::Encoded(_) => return None,
        })
    }
}

impl fmt::Display for DataType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.short_name())
    }
}

/// An answer about types. *Unknown* is a note for the user, never a reason to refuse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// The relation of the two types holds.
    Yes,
    /// It does not hold.
    No,
    /// Only Python knows the answer.
    Unknown,
}

/// Relations of types that the model does not know.
pub trait Types {
    /// True if `sub` is `base` or inherits from it. Called only for pairs with a type that is not built in.
    fn is_subclass(&self, sub: &DataType, base: &DataType) -> Answer;
}

/// Knows the built-in types only; everything else is [`Answer::Unknown`].
#[derive(Debug, Clone, Copy, Default)]
pub struct BuiltinTypes;

impl Types for BuiltinTypes {
    fn is_subclass(&self, _sub: &DataType, _base: &DataType) -> Answer {
        Answer::Unknown
    }
}

/// Decides if a data flow may lead from a port of type `from` to one of type `to` (`docs/format.md`, data flows): both types are
/// equal, `from` is a subclass of `to`, or either is `object`. `int` does not flow to `float`.
pub fn may_flow(from: &DataType, to: &DataType, types: &dyn Types) -> Answer {
    if from == to || *from == DataType::Object || *to == DataType::Object {
        return Answer::Yes;
    }
    match (from, to) {
        (DataType::Named(_), _) | (_, DataType::Named(_)) => types.is_subclass(from, to),
        (DataType::Bool, DataType::Int) => Answer::Yes,
        _ => Answer::No,
    }
}
