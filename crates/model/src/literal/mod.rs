//! Python literals: numbers, strings, `None`, `True`, `False`, lists, tuples, dicts and sets. Knows what
//! `ast.literal_eval` reads, as far as [`Value`] can hold it; never evaluates anything.

mod number;
mod parse;
mod text;

pub(crate) use number::{parse_float, parse_int};
pub use parse::{LiteralError, MAX_DEPTH, parse};

#[cfg(test)]
mod tests;

use crate::Value;
use crate::json::python_float;

/// The Python literal of a value, strings in double quotes; `None` for values without a literal: types, objects that only
/// Python can make, infinite numbers, and nesting deeper than [`MAX_DEPTH`].
pub fn write(value: &Value) -> Option<String> {
    let mut out = String::new();
    put(value, &mut out, 0)?;
    Some(out)
}

fn put(value: &Value, out: &mut String, depth: usize) -> Option<()> {
    if depth > MAX_DEPTH {
        return None;
    }
    match value {
        Value::None => out.push_str("None"),
        Value::Bool(true) => out.push_str("True"),
        Value::Bool(false) => out.push_str("False"),
        Value::Int(number) => out.push_str(&number.to_string()),
        Value::BigInt(digits) => out.push_str(digits),
        Value::Float(number) if number.is_finite() => out.push_str(&python_float(*number)),
        Value::Str(text) => quote(text, out),
        Value::List(items) => sequence(items, ["[", "]"], out, depth)?,
        Value::Tuple(items) if items.len() == 1 => sequence(items, ["(", ",)"], out, depth)?,
        Value::Tuple(items) => sequence(items, ["(", ")"], out, depth)?,
        Value::Set(items) if items.is_empty() => out.push_str("set()"),
        Value::Set(items) => sequence(items, ["{", "}"], out, depth)?,
        Value::Dict(members) => dict(members, out, depth)?,
        Value::Float(_) | Value::Type(_) | Value::Encoded(_) => return None,
    }
    Some(())
}

fn sequence(items: &[Value], brackets: [&str; 2], out: &mut String, depth: usize) -> Option<()> {
    out.push_str(brackets[0]);
    for (index, item) in items.iter().enumerate() {
        out.push_str(if index > 0 { ", " } else { "" });
        put(item, out, depth + 1)?;
    }
    out.push_str(brackets[1]);
    Some(())
}

fn dict(members: &[(Value, Value)], out: &mut String, depth: usize) -> Option<()> {
    out.push('{');
    for (index, (key, value)) in members.iter().enumerate() {
        out.push_str(if index > 0 { ", " } else { "" });
        put(key, out, depth + 1)?;
        out.push_str(": ");
        put(value, out, depth + 1)?;
    }
    out.push('}');
    Some(())
}

/// A string in double quotes, with the escapes that Python and JSON share.
pub(crate) fn quote(text: &str, out: &mut String) {
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            c if c.is_control() => {
                for digit in format!("\\u{:04x}", u32::from(c)).chars() {
                    out.push(digit);
                }
            }
            _ => out.push(c),
        }
    }
    out.push('"');
}
