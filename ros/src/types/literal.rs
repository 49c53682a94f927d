//! Literal values in interface files: of constants, and defaults of fields.

use super::{Base, Field, Literal, Primitive, Shape};

/// The literal of a constant.
pub(super) fn constant(text: &str, primitive: Primitive) -> Result<Literal, String> {
    match primitive {
        // A text constant is everything after the `=`, without enclosing quotes.
        Primitive::Text | Primitive::WideText => {
            Ok(Literal::Text(unquoted(text).unwrap_or_else(|| text.to_owned())))
        }
        _ => one(text, primitive),
    }
}

/// The default of a field.
pub(super) fn default(text: &str, field: &Field) -> Result<Literal, String> {
    let Base::Primitive(primitive) = field.base else {
        return Err("a message has no default".to_owned());
    };
    let value = match field.shape {
        Shape::One => return one(text, primitive),
        Shape::Fixed(_) | Shape::Bounded(_) | Shape::Unbounded => list(text, primitive)?,
    };
    let fits = match field.shape {
        Shape::Fixed(size) => value.len() == size as usize,
        Shape::Bounded(size) => value.len() <= size as usize,
        Shape::One | Shape::Unbounded => true,
    };
    if !fits {
        return Err(format!("the default has {} values, which do not fit", value.len()));
    }
    Ok(Literal::List(value))
}

fn list(text: &str, primitive: Primitive) -> Result<Vec<Literal>, String> {
    let inner = text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    let inner = inner.ok_or_else(|| format!("`{text}` is no list in brackets"))?;
    split(inner).into_iter().map(|part| one(part.trim(), primitive)).collect()
}

/// The parts between commas outside of quotes.
fn split(text: &str) -> Vec<&str> {
    let (mut parts, mut start, mut quote, mut escaped) = (Vec::new(), 0, None, false);
    for (at, c) in text.char_indices() {
        match quote {
            _ if escaped => escaped = false,
            Some(_) if c == '\\' => escaped = true,
            Some(open) if c == open => quote = None,
            None if c == '"' || c == '\'' => quote = Some(c),
            None if c == ',' => {
                parts.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    if !text[start..].trim().is_empty() || !parts.is_empty() {
        parts.push(&text[start..]);
    }
    parts
}

fn one(text: &str, primitive: Primitive) -> Result<Literal, String> {
    let wrong = || format!("`{text}` is no {}", primitive.name());
    match primitive {
        Primitive::Bool => match text.to_ascii_lowercase().as_str() {
            "true" | "1" => Ok(Literal::Bool(true)),
            "false" | "0" => Ok(Literal::Bool(false)),
            _ => Err(wrong()),
        },
        Primitive::Text | Primitive::WideText => {
            unquoted(text).map(Literal::Text).ok_or_else(wrong)
        }
        Primitive::Float32 | Primitive::Float64 => {
            text.parse().map(Literal::Float).map_err(|_| wrong())
        }
        _ => {
            let value = integer(text).ok_or_else(wrong)?;
            let (least, most) = range(primitive);
            if (least..=most).contains(&value) { Ok(Literal::Int(value)) } else { Err(wrong()) }
        }
    }
}

/// Decimal, or with the prefix `0x`, `0o` or `0b`.
fn integer(text: &str) -> Option<i128> {
    let (sign, digits) = match text.strip_prefix('-') {
        Some(rest) => (-1, rest),
        None => (1, text.strip_prefix('+').unwrap_or(text)),
    };
    let lower = digits.to_ascii_lowercase();
    let (radix, digits) = [("0x", 16), ("0o", 8), ("0b", 2)]
        .iter()
        .find_map(|(prefix, radix)| lower.strip_prefix(prefix).map(|rest| (*radix, rest)))
        .unwrap_or((10, lower.as_str()));
    if !digits.starts_with(|first: char| first.is_ascii_hexdigit()) {
        return None;
    }
    i128::from_str_radix(digits, radix).ok().map(|value| sign * value)
}

/// The minimum and maximum of an integer type.
pub(crate) fn range(primitive: Primitive) -> (i128, i128) {
    let bits = primitive.width() * 8;
    match primitive {
        Primitive::Int8 | Primitive::Int16 | Primitive::Int32 | Primitive::Int64 => {
            (-(1 << (bits - 1)), (1 << (bits - 1)) - 1)
        }
        _ => (0, (1 << bits) - 1),
    }
}

/// The text between enclosing quotes; `\` escapes the next character.
fn unquoted(text: &str) -> Option<String> {
    let quote = text.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    let inner = text.strip_prefix(quote)?.strip_suffix(quote)?;
    let (mut plain, mut escaped) = (String::with_capacity(inner.len()), false);
    for c in inner.chars() {
        if escaped {
            plain.push(match c {
                'n' => '\n',
                't' => '\t',
                'r' => '\r',
                other => other,
            });
            escaped = false;
        } else if c == '\\' {
            escaped = true;
        } else if c == quote {
            return None;
        } else {
            plain.push(c);
        }
    }
    (!escaped).then_some(plain)
}
