//! Python strings: quotes, prefixes, escapes, adjacent strings.

use super::LiteralError;
use super::parse::LiteralParser;
use crate::Value;

/// A string at the parser's position, joined with the strings that follow it directly.
pub(super) fn string(parser: &mut LiteralParser<'_>) -> Result<Value, LiteralError> {
    let mut text = String::new();
    one(parser, &mut text, false)?;
    join(parser, text)
}

/// A string after the prefix `prefix`.
pub(super) fn prefixed_string(
    parser: &mut LiteralParser<'_>,
    prefix: &str,
) -> Result<Value, LiteralError> {
    let mut text = String::new();
    prefixed(parser, prefix, &mut text)?;
    join(parser, text)
}

fn prefixed(
    parser: &mut LiteralParser<'_>,
    prefix: &str,
    text: &mut String,
) -> Result<(), LiteralError> {
    let raw = match prefix.to_ascii_lowercase().as_str() {
        "r" => true,
        "u" => false,
        "b" | "br" | "rb" => return Err(LiteralError::NeedsPython("bytes")),
        _ => return Err(parser.error("not a Python literal")),
    };
    parser.at += prefix.len();
    one(parser, text, raw)
}

fn join(parser: &mut LiteralParser<'_>, mut text: String) -> Result<Value, LiteralError> {
    loop {
        let end = parser.at;
        parser.skip_space();
        match parser.rest().as_bytes() {
            [b'"' | b'\'', ..] => one(parser, &mut text, false)?,
            [b'r' | b'R' | b'u' | b'U', b'"' | b'\'', ..] => {
                let prefix = &parser.rest()[..1];
                prefixed(parser, prefix, &mut text)?;
            }
            _ => {
                parser.at = end;
                return Ok(Value::str(&text));
            }
        }
    }
}

fn one(parser: &mut LiteralParser<'_>, text: &mut String, raw: bool) -> Result<(), LiteralError> {
    let quote = parser.rest().get(..1).unwrap_or("\"");
    let triple = quote.repeat(3);
    let long = parser.rest().starts_with(&triple);
    let end = if long { triple.as_str() } else { quote };
    parser.at += end.len();
    loop {
        let rest = parser.rest();
        let Some(c) = rest.chars().next() else {
            return Err(parser.error("a string without end"));
        };
        if rest.starts_with(end) {
            parser.at += end.len();
            return Ok(());
        }
        match c {
            '\\' if raw => raw_escape(parser, text),
            '\\' => escape(parser, text)?,
            '\n' if !long => return Err(parser.error("a string without end")),
            _ => {
                parser.at += c.len_utf8();
                text.push(c);
            }
        }
    }
}

/// In a raw string a backslash keeps the next character, even a quote, and stays.
fn raw_escape(parser: &mut LiteralParser<'_>, text: &mut String) {
    let pair: String = parser.rest().chars().take(2).collect();
    parser.at += pair.len();
    text.push_str(&pair);
}

fn escape(parser: &mut LiteralParser<'_>, text: &mut String) -> Result<(), LiteralError> {
    parser.at += 1;
    let Some(c) = parser.rest().chars().next() else {
        return Err(parser.error("a string without end"));
    };
    parser.at += c.len_utf8();
    let meant = match c {
        '\n' => return Ok(()),
        '\\' | '\'' | '"' => c,
        'n' => '\n',
        't' => '\t',
        'r' => '\r',
        'a' => '\u{7}',
        'b' => '\u{8}',
        'f' => '\u{c}',
        'v' => '\u{b}',
        'x' => by_number(parser, 2)?,
        'u' => by_number(parser, 4)?,
        'U' => by_number(parser, 8)?,
        '0'..='7' => octal(parser),
        'N' => return Err(LiteralError::NeedsPython("characters by name")),
        _ => {
            text.push('\\');
            c
        }
    };
    text.push(meant);
    Ok(())
}

fn by_number(parser: &mut LiteralParser<'_>, digits: usize) -> Result<char, LiteralError> {
    let code = parser.rest().get(..digits).filter(|s| s.bytes().all(|b| b.is_ascii_hexdigit()));
    let Some(code) = code.and_then(|digits| u32::from_str_radix(digits, 16).ok()) else {
        return Err(parser.error("an escape that is too short"));
    };
    parser.at += digits;
    char::from_u32(code).ok_or(LiteralError::NeedsPython("halves of surrogate pairs"))
}

/// Up to three octal digits; the first is already consumed.
fn octal(parser: &mut LiteralParser<'_>) -> char {
    parser.at -= 1;
    let count = parser.rest().bytes().take(3).take_while(|b| matches!(b, b'0'..=b'7')).count();
    let code = parser.rest().bytes().take(count).fold(0, |n, b| n * 8 + u32::from(b - b'0'));
    parser.at += count;
    char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)
}
