//! Values as the engine sees them: handles that it moves and never opens.

use rafcon_model::{Answer, DataType, Value};
use smol_str::SmolStr;

/// A handle to a value. Cloning must be cheap and must not need an interpreter: the engine clones and drops under a lock.
pub trait Datum: Clone {
    /// The handle of `None`.
    fn none() -> Self;
    /// Whether the value is `None`.
    fn is_none(&self) -> bool;
    /// Whether the value may stand in a port of this type. `None` fits everywhere; `int` and `float` pass for each other
    /// when a run stores values (`docs/semantics.md`, type checks).
    fn fits(&self, data_type: &DataType) -> Answer;
    /// The name of the value's type, for messages.
    fn type_name(&self) -> SmolStr;
}

/// The global variables of a run, as far as the engine needs them: for defaults that start with `$`.
pub trait Globals<D> {
    /// The variable's value: by reference or as a copy of its own, as the variable was stored.
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
    /// The handle for `value` in a port of type `data_type`, converted as the file format says (`docs/format.md`, raw
    /// text); the error says why it cannot be. Names of global variables (`$name`) are not passed here.
    fn literal(&mut self, value: &Value, data_type: &DataType) -> Result<D, SmolStr>;

    /// The same for what a library state sets for a port; the text `None` may be itself there.
    fn runtime_literal(&mut self, value: &Value, data_type: &DataType) -> Result<D, SmolStr> {
        self.literal(value, data_type)
    }

    /// What an error of the engine's own (a missing library, a scoped variable that cannot be made) is to those who handle
    /// it; the text says what happened and the way out.
    fn error(&mut self, text: &str) -> Option<D> {
        self.literal(&Value::str(text), &DataType::Str).ok()
    }
}
