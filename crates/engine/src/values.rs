//! Values as handles that the engine moves and never opens. The model's own values are such handles, for native states
//! and tests.

use rafcon_model::{Answer, Conversion, DataType, Value, convert, convert_runtime_value};
use smol_str::{SmolStr, format_smolstr};

/// Converts literals of the model to values of the model. Literals that only Python can read fail.
#[derive(Debug, Clone, Copy, Default)]
pub struct ModelLiterals;

impl Literals<Value> for ModelLiterals {
    fn literal(&mut self, value: &Value, data_type: &DataType) -> Result<Value, SmolStr> {
        made(convert(value, data_type), value, data_type)
    }

    fn runtime_literal(&mut self, value: &Value, data_type: &DataType) -> Result<Value, SmolStr> {
        made(convert_runtime_value(value, data_type), value, data_type)
    }
}

fn made(conversion: Conversion, value: &Value, data_type: &DataType) -> Result<Value, SmolStr> {
    match conversion {
        Conversion::Value(value) => Ok(value),
        Conversion::Global(_) => Ok(value.clone()),
        Conversion::NeedsPython => {
            Err(format_smolstr!("only Python can make a value of the type {data_type}"))
        }
        Conversion::Fails(reason) => failed(value, reason).cloned(),
    }
}

/// A value that could not be converted. Text is an error; other values pass unchanged, and are noted during the run.
pub fn failed(value: &Value, reason: SmolStr) -> Result<&Value, SmolStr> {
    if matches!(value, Value::Str(_)) { Err(reason) } else { Ok(value) }
}

impl Datum for Value {
    fn none() -> Self {
        Self::None
    }

    fn is_none(&self) -> bool {
        Self::is_none(self)
    }

    fn fits(&self, data_type: &DataType) -> Answer {
        let fits = match (self, data_type) {
            (Self::None, _)
            | (_, DataType::None | DataType::Object)
            | (Self::Bool(_), DataType::Bool | DataType::Int | DataType::Float)
            | (Self::Int(_) | Self::BigInt(_) | Self::Float(_), DataType::Int | DataType::Float)
            | (Self::Str(_), DataType::Str)
            | (Self::List(_), DataType::List)
            | (Self::Tuple(_), DataType::Tuple)
            | (Self::Set(_), DataType::Set)
            | (Self::Dict(_), DataType::Dict) => true,
            (_, DataType::Named(_)) | (Self::Encoded(_), _) => return Answer::Unknown,
            (
                Self::Bool(_)
                | Self::Int(_)
                | Self::BigInt(_)
                | Self::Float(_)
                | Self::Str(_)
                | Self::List(_)
                | Self::Tuple(_)
                | Self::Set(_)
                | Self::Dict(_)
                | Self::Type(_),
                _,
            ) => false,
        };
        if fits { Answer::Yes } else { Answer::No }
    }

    fn type_name(&self) -> SmolStr {
        DataType::of(self).map_or_else(|| "object".into(), |own| own.short_name())
    }
}

/// A handle to a value. Cloning must be cheap and must not need an interpreter: the engine clones and drops under a
/// lock.
pub trait Datum: Clone {
    /// The handle of `None`.
    fn none() -> Self;
    /// True if the value is `None`.
    fn is_none(&self) -> bool;
    /// Checks the value against the type of a port. `None` fits everywhere; `int` and `float` pass for each other when
    /// a run stores values (`docs/semantics.md`, type checks).
    fn fits(&self, data_type: &DataType) -> Answer;
    /// The name of the value's type, for messages.
    fn type_name(&self) -> SmolStr;
}

/// The global variables of a run, for defaults that start with `$`.
pub trait Globals<D> {
    /// The value of the variable: by reference or as a copy, depending on how it was stored.
    fn get(&self, name: &str) -> Option<D>;
}

/// A run without global variables.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoGlobals;

impl<D> Globals<D> for NoGlobals {
    fn get(&self, _name: &str) -> Option<D> {
        None
    }
}

/// Makes handles from the values of files, once per program.
pub trait Literals<D> {
    /// The handle for `value` in a port of type `data_type`, converted as in `docs/format.md` (raw text). The error is
    /// the reason of a failed conversion. Names of global variables (`$name`) are not passed here.
    fn literal(&mut self, value: &Value, data_type: &DataType) -> Result<D, SmolStr>;

    /// As [`Self::literal`], for a value that a library state sets for a port. The text `None` may stay text there.
    fn runtime_literal(&mut self, value: &Value, data_type: &DataType) -> Result<D, SmolStr> {
        self.literal(value, data_type)
    }

    /// Creates the error value for an error of the engine itself, such as a missing library or a bad scoped variable.
    /// The text describes the problem and its remedy.
    fn error(&mut self, text: &str) -> Option<D> {
        self.literal(&Value::str(text), &DataType::Str).ok()
    }
}
