//! Interface types of ROS: their structure, the parsing of their files, their lookup, and their hashes.
//!
//! Knows nothing of the wire, of a middleware, or of the parent program.

pub(crate) mod bundled;
pub(crate) mod derived;
pub(crate) mod described;
pub(crate) mod hash;
pub(crate) mod library;
pub(crate) mod literal;
pub(crate) mod parse;

use std::fmt;
use std::sync::Arc;

/// The largest message that is certain to arrive, in bytes.
pub(crate) const MESSAGE_MAX: usize = 33 << 20;

/// A primitive type of ROS interfaces.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub(crate) enum Primitive {
    Bool,
    Byte,
    Char,
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Float32,
    Float64,
    Text,
    WideText,
}

use Primitive::{
    Bool, Byte, Char, Float32, Float64, Int8, Int16, Int32, Int64, Text, UInt8, UInt16, UInt32,
    UInt64, WideText,
};

/// All primitive types with their names in interface files.
const PRIMITIVES: [(&str, Primitive); 15] = [
    ("bool", Bool),
    ("byte", Byte),
    ("char", Char),
    ("int8", Int8),
    ("uint8", UInt8),
    ("int16", Int16),
    ("uint16", UInt16),
    ("int32", Int32),
    ("uint32", UInt32),
    ("int64", Int64),
    ("uint64", UInt64),
    ("float32", Float32),
    ("float64", Float64),
    ("string", Text),
    ("wstring", WideText),
];

impl Primitive {
    /// The primitive type with this name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        PRIMITIVES.iter().find(|(known, _)| *known == name).map(|(_, primitive)| *primitive)
    }

    /// The name in interface files.
    pub(crate) fn name(self) -> &'static str {
        PRIMITIVES.iter().find(|(_, known)| *known == self).map_or("", |(name, _)| name)
    }

    /// Size in bytes of a value on the wire, which is also its alignment; for a text, those of its length.
    pub(crate) fn width(self) -> usize {
        match self {
            Bool | Byte | Char | Int8 | UInt8 => 1,
            Int16 | UInt16 => 2,
            Int32 | UInt32 | Float32 | Text | WideText => 4,
            Int64 | UInt64 | Float64 => 8,
        }
    }

    /// The code of its arrays in frames, as in Python's `array`; `None` for booleans and texts.
    pub(crate) fn code(self) -> Option<char> {
        Some(match self {
            Byte | Char | UInt8 => 'B',
            Int8 => 'b',
            Int16 => 'h',
            UInt16 => 'H',
            Int32 => 'i',
            UInt32 => 'I',
            Int64 => 'q',
            UInt64 => 'Q',
            Float32 => 'f',
            Float64 => 'd',
            Bool | Text | WideText => return None,
        })
    }
}

/// The type of a single value of a field.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) enum Base {
    Primitive(Primitive),
    /// The full name of a message type.
    Message(Arc<str>),
}

/// Number of values in a field.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Shape {
    One,
    Fixed(u32),
    Bounded(u32),
    Unbounded,
}

/// A literal value: of a constant, or a default.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Literal {
    Bool(bool),
    Int(i128),
    Float(f64),
    Text(String),
    List(Vec<Literal>),
}

/// A field of a message type.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) base: Base,
    pub(crate) shape: Shape,
    /// Maximum length of a text; 0 if unlimited.
    pub(crate) text_max: u32,
    pub(crate) default: Option<Literal>,
}

/// A message type, or a part of a service or an action.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Message {
    /// Full name, such as `geometry_msgs/msg/Twist` or `std_srvs/srv/Trigger_Request`.
    pub(crate) name: String,
    pub(crate) fields: Vec<Field>,
    pub(crate) constants: Vec<(String, Primitive, Literal)>,
}

/// The kind of an interface.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Sort {
    Message,
    Service,
    Action,
}

impl Sort {
    /// The folder of its files, which is also their extension.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Message => "msg",
            Self::Service => "srv",
            Self::Action => "action",
        }
    }

    /// The kind with this folder name.
    pub(crate) fn of(word: &str) -> Option<Self> {
        [Self::Message, Self::Service, Self::Action].into_iter().find(|sort| sort.word() == word)
    }
}

/// The three parts of a full name.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) struct TypeName<'a> {
    pub(crate) package: &'a str,
    pub(crate) sort: Sort,
    pub(crate) name: &'a str,
}

impl<'a> TypeName<'a> {
    /// Splits `package/msg/Name`; the error describes the problem.
    pub(crate) fn parse(full: &'a str) -> Result<Self, String> {
        let parts: Vec<&str> = full.split('/').collect();
        let [package, sort, name] = parts[..] else {
            return Err(format!(
                "`{full}` is no full name of a type: write it like `std_msgs/msg/String`"
            ));
        };
        let plain = |text: &str| {
            text.starts_with(|first: char| first.is_ascii_alphabetic())
                && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        };
        match Sort::of(sort) {
            Some(sort) if plain(package) && plain(name) => Ok(Self { package, sort, name }),
            _ => Err(format!(
                "`{full}` is no full name of a type: write it like `std_msgs/msg/String`"
            )),
        }
    }
}

impl TypeName<'_> {
    /// The name of the interface in its file: the service or action for its parts.
    pub(crate) fn whole(&self) -> &str {
        match self.sort {
            Sort::Message => self.name,
            Sort::Service | Sort::Action => self.name.split('_').next().unwrap_or(self.name),
        }
    }
}

impl fmt::Display for TypeName<'_> {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "{}/{}/{}", self.package, self.sort.word(), self.name)
    }
}
