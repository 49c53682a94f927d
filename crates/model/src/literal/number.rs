//! Numbers as Python writes and reads them.

use super::LiteralError;
use super::parse::LiteralParser;
use crate::Value;
use smol_str::SmolStr;

/// The result of `int(text)`; `None` if it raises.
pub(crate) fn parse_int(text: &str) -> Option<Value> {
    let text = text.trim_matches(is_space);
    let (negative, digits) = match text.as_bytes().first()? {
        b'-' => (true, &text[1..]),
        b'+' => (false, &text[1..]),
        _ => (false, text),
    };
    integer(negative, &plain_digits(digits)?)
}

/// The result of `float(text)`; `None` if it raises.
pub(crate) fn parse_float(text: &str) -> Option<f64> {
    let text = text.trim_matches(is_space);
    let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
    if !unsigned.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
        let word = unsigned.to_ascii_lowercase();
        let known = matches!(word.as_str(), "inf" | "infinity" | "nan");
        return text.parse().ok().filter(|_| known);
    }
    without_underscores(text)?.parse().ok()
}

/// The ASCII characters that Python's `str.strip` removes.
fn is_space(c: char) -> bool {
    c.is_ascii_whitespace() || matches!(c, '\u{b}' | '\u{1c}'..='\u{1f}')
}

/// A number at the parser's position, with its signs.
pub(super) fn number(parser: &mut LiteralParser<'_>) -> Result<Value, LiteralError> {
    let mut negative = false;
    while let Some(sign @ (b'+' | b'-')) = parser.peek() {
        negative ^= sign == b'-';
        parser.at += 1;
        parser.skip_space();
    }
    let rest = parser.rest();
    let length = extent(rest);
    let token = &rest[..length];
    let value = token_value(negative, token).map_err(|reason| match reason {
        Reading::Wrong(reason) => parser.error(reason),
        Reading::Complex => LiteralError::NeedsPython("complex numbers"),
    })?;
    parser.at += length;
    Ok(value)
}

/// The length of the longest prefix with the form of a number: letters, digits, points, and a sign after an exponent.
fn extent(rest: &str) -> usize {
    let is_hex = rest.as_bytes().get(1).is_some_and(|b| b.eq_ignore_ascii_case(&b'x'));
    let mut before = b' ';
    rest.bytes()
        .take_while(|byte| {
            let exponent = before.eq_ignore_ascii_case(&b'e') && !is_hex;
            let sign = matches!(byte, b'+' | b'-') && exponent;
            before = *byte;
            sign || byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'_')
        })
        .count()
}

enum Reading {
    Wrong(&'static str),
    Complex,
}

fn token_value(negative: bool, token: &str) -> Result<Value, Reading> {
    const WRONG: Reading = Reading::Wrong("not a number");
    let lower = token.to_ascii_lowercase();
    for (prefix, radix) in [("0x", 16), ("0o", 8), ("0b", 2)] {
        if let Some(digits) = lower.strip_prefix(prefix) {
            return radix_value(negative, digits, radix).ok_or(WRONG);
        }
    }
    if lower.ends_with('j') {
        return Err(Reading::Complex);
    }
    if lower.contains(['.', 'e']) {
        let number = without_underscores(&lower).ok_or(WRONG)?;
        let number: f64 = number.parse().map_err(|_error| WRONG)?;
        return Ok(Value::Float(if negative { -number } else { number }));
    }
    let digits = plain_digits(&lower).ok_or(WRONG)?;
    if digits.len() > 1 && digits.starts_with('0') && digits.bytes().any(|b| b != b'0') {
        return Err(Reading::Wrong("a number does not start with 0"));
    }
    integer(negative, &digits).ok_or(WRONG)
}

fn radix_value(negative: bool, digits: &str, radix: u32) -> Option<Value> {
    let digits = without_underscores(digits.strip_prefix('_').unwrap_or(digits))?;
    let number = i64::from_str_radix(&digits, radix).ok()?;
    Some(Value::Int(if negative { number.checked_neg()? } else { number }))
}

/// Digits without their underscores; `None` if there is any other character, or an underscore not between digits.
fn plain_digits(text: &str) -> Option<String> {
    without_underscores(text).filter(|digits| digits.bytes().all(|b| b.is_ascii_digit()))
}

/// Underscores are allowed between two digits only.
fn without_underscores(text: &str) -> Option<String> {
    let bytes = text.as_bytes();
    let digit = |index: Option<usize>| {
        index.and_then(|index| bytes.get(index)).is_some_and(u8::is_ascii_alphanumeric)
    };
    let well_placed = (0..bytes.len())
        .filter(|index| bytes[*index] == b'_')
        .all(|index| digit(index.checked_sub(1)) && digit(index.checked_add(1)));
    (well_placed && !text.is_empty()).then(|| text.replace('_', ""))
}

fn integer(negative: bool, digits: &str) -> Option<Value> {
    if digits.is_empty() {
        return None;
    }
    let digits = digits.trim_start_matches('0');
    let digits = if digits.is_empty() { "0" } else { digits };
    let sign = if negative && digits != "0" { "-" } else { "" };
    let text = format!("{sign}{digits}");
    Some(text.parse().map_or_else(|_| Value::BigInt(SmolStr::new(&text)), Value::Int))
}
