//! Python literals: numbers, strings, `None`, `True`, `False`, lists, tuples, dicts and sets. Knows what
//! `ast.literal_eval` reads, as far as [`Value`](crate::Value) can hold it; never evaluates anything.

mod number;
mod parse;
mod text;
mod write;

pub(crate) use number::{parse_float, parse_int};
pub use parse::{LiteralError, MAX_DEPTH, parse};
pub(crate) use write::quote;
pub use write::write;

#[cfg(test)]
mod tests;
