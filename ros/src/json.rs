//! JSON as Python reads and writes it: including `NaN`, `Infinity` and lone surrogates, and `{"$": [code, start, bytes]}`
//! for an array whose values follow the text of its frame.
//!
//! Any input gives a value or an error. Nothing panics, and no memory is reserved because of a number in the input.

use std::fmt::Write as _;

/// Maximum nesting of lists and objects. A message of [`DEPTH_MAX`](crate::types::library::DEPTH_MAX) types in lists needs
/// two levels for each.
const DEPTH_MAX: usize = 160;

/// A JSON value that may refer to the bytes behind the text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Json {
    Null,
    Bool(bool),
    Int(i128),
    Float(f64),
    Text(String),
    List(Vec<Json>),
    Map(Vec<(String, Json)>),
    /// Numbers that follow the text: their code as in Python's `array`, and their position.
    Array {
        code: char,
        start: usize,
        bytes: usize,
    },
}

impl Json {
    /// The value of `key`, if this is an object with this key.
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        match self {
            Self::Map(entries) => {
                entries.iter().find(|(known, _)| known == key).map(|(_, value)| value)
            }
            _ => None,
        }
    }

    /// The text of `key`.
    pub(crate) fn text(&self, key: &str) -> Result<&str, String> {
        match self.get(key) {
            Some(Self::Text(text)) => Ok(text),
            _ => Err(format!("`{key}` is no text")),
        }
    }

    /// The whole number of `key`.
    pub(crate) fn number(&self, key: &str) -> Result<u64, String> {
        match self.get(key) {
            Some(Self::Int(value)) => {
                u64::try_from(*value).map_err(|_| format!("`{key}` is out of range"))
            }
            _ => Err(format!("`{key}` is no number")),
        }
    }

    /// The texts in the list of `key`; empty if the key is missing.
    pub(crate) fn texts(&self, key: &str) -> Vec<String> {
        let Some(Self::List(values)) = self.get(key) else { return Vec::new() };
        let text = |value: &Self| match value {
            Self::Text(text) => Some(text.clone()),
            _ => None,
        };
        values.iter().filter_map(text).collect()
    }
}

/// Parses a text with one value.
pub(crate) fn parse(bytes: &[u8]) -> Result<Json, String> {
    let mut parser = Parser { bytes, at: 0 };
    let value = parser.value(0)?;
    parser.space();
    if parser.at == bytes.len() { Ok(value) } else { Err(parser.wrong("more than one value")) }
}

struct Parser<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Parser<'_> {
    fn wrong(&self, what: &str) -> String {
        format!("no JSON: {what} at byte {}", self.at)
    }

    fn space(&mut self) {
        while matches!(self.bytes.get(self.at), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.at += 1;
        }
    }

    /// Skips `byte`, if it is next.
    fn take(&mut self, byte: u8) -> bool {
        self.space();
        let found = self.bytes.get(self.at) == Some(&byte);
        self.at += usize::from(found);
        found
    }

    fn word(&mut self, word: &str, value: Json) -> Result<Json, String> {
        if !self.bytes[self.at..].starts_with(word.as_bytes()) {
            return Err(self.wrong("an unknown word"));
        }
        self.at += word.len();
        Ok(value)
    }

    fn value(&mut self, depth: usize) -> Result<Json, String> {
        if depth > DEPTH_MAX {
            return Err(self.wrong("too deep"));
        }
        self.space();
        match self.bytes.get(self.at) {
            Some(b'{') => self.map(depth),
            Some(b'[') => self.list(depth),
            Some(b'"') => self.text().map(Json::Text),
            Some(b't') => self.word("true", Json::Bool(true)),
            Some(b'f') => self.word("false", Json::Bool(false)),
            Some(b'n') => self.word("null", Json::Null),
            Some(b'N') => self.word("NaN", Json::Float(f64::NAN)),
            Some(b'I') => self.word("Infinity", Json::Float(f64::INFINITY)),
            Some(b'-') if self.bytes[self.at..].starts_with(b"-I") => {
                self.word("-Infinity", Json::Float(f64::NEG_INFINITY))
            }
            Some(_) => self.numeral(),
            None => Err(self.wrong("nothing")),
        }
    }

    fn list(&mut self, depth: usize) -> Result<Json, String> {
        self.at += 1;
        let mut values = Vec::new();
        if self.take(b']') {
            return Ok(Json::List(values));
        }
        loop {
            values.push(self.value(depth + 1)?);
            if self.take(b']') {
                return Ok(Json::List(values));
            }
            if !self.take(b',') {
                return Err(self.wrong("no `,` or `]`"));
            }
        }
    }

    fn map(&mut self, depth: usize) -> Result<Json, String> {
        self.at += 1;
        let mut entries = Vec::new();
        if self.take(b'}') {
            return Ok(Json::Map(entries));
        }
        loop {
            self.space();
            let key = self.text()?;
            if !self.take(b':') {
                return Err(self.wrong("no `:`"));
            }
            entries.push((key, self.value(depth + 1)?));
            if self.take(b'}') {
                return Ok(array(&entries).unwrap_or(Json::Map(entries)));
            }
            if !self.take(b',') {
                return Err(self.wrong("no `,` or `}`"));
            }
        }
    }

    fn numeral(&mut self) -> Result<Json, String> {
        let start = self.at;
        while matches!(
            self.bytes.get(self.at),
            Some(b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E')
        ) {
            self.at += 1;
        }
        let text = std::str::from_utf8(&self.bytes[start..self.at]).unwrap_or("");
        let number = match text.parse() {
            Ok(whole) => Some(Json::Int(whole)),
            Err(_) => text.parse().ok().map(Json::Float),
        };
        number.ok_or_else(|| self.wrong("no value"))
    }

    fn text(&mut self) -> Result<String, String> {
        if self.bytes.get(self.at) != Some(&b'"') {
            return Err(self.wrong("no text"));
        }
        self.at += 1;
        let mut text = Vec::new();
        loop {
            let rest = self.bytes.get(self.at..).unwrap_or_default();
            let plain = rest
                .iter()
                .position(|byte| matches!(byte, b'"' | b'\\'))
                .ok_or_else(|| self.wrong("no end"))?;
            text.extend_from_slice(&rest[..plain]);
            self.at += plain + 1;
            if rest[plain] == b'"' {
                return String::from_utf8(text).map_err(|_| self.wrong("no UTF-8"));
            }
            let c = self.escape()?;
            text.extend_from_slice(c.encode_utf8(&mut [0; 4]).as_bytes());
        }
    }

    fn escape(&mut self) -> Result<char, String> {
        let letter = self.bytes.get(self.at).copied().ok_or_else(|| self.wrong("no end"))?;
        self.at += 1;
        Ok(match letter {
            b'"' => '"',
            b'\\' => '\\',
            b'/' => '/',
            b'b' => '\u{8}',
            b'f' => '\u{c}',
            b'n' => '\n',
            b'r' => '\r',
            b't' => '\t',
            b'u' => self.unit_pair()?,
            _ => return Err(self.wrong("an unknown escape")),
        })
    }

    /// A character of one or two UTF-16 units. An unpaired surrogate becomes U+FFFD.
    fn unit_pair(&mut self) -> Result<char, String> {
        let first = self.unit()?;
        if (0xD800..0xDC00).contains(&first) && self.bytes.get(self.at..self.at + 2) == Some(b"\\u")
        {
            let before = self.at;
            self.at += 2;
            let second = self.unit()?;
            if let Some(Ok(c)) = char::decode_utf16([first, second]).next() {
                return Ok(c);
            }
            self.at = before;
        }
        Ok(char::from_u32(u32::from(first)).unwrap_or(char::REPLACEMENT_CHARACTER))
    }

    fn unit(&mut self) -> Result<u16, String> {
        let digits = self
            .bytes
            .get(self.at..self.at + 4)
            .and_then(|digits| std::str::from_utf8(digits).ok());
        let unit = digits.and_then(|digits| u16::from_str_radix(digits, 16).ok());
        let unit = unit.ok_or_else(|| self.wrong("no four digits"))?;
        self.at += 4;
        Ok(unit)
    }
}

fn array(entries: &[(String, Json)]) -> Option<Json> {
    let [(key, Json::List(parts))] = entries else { return None };
    let [Json::Text(code), Json::Int(start), Json::Int(bytes)] = &parts[..] else { return None };
    let (start, bytes) = (usize::try_from(*start).ok()?, usize::try_from(*bytes).ok()?);
    (key == "$").then_some(Json::Array { code: code.chars().next()?, start, bytes })
}

/// Writes a text in quotes.
pub(crate) fn write_text(text: &str, to: &mut String) {
    to.push('"');
    for c in text.chars() {
        match c {
            '"' => to.push_str("\\\""),
            '\\' => to.push_str("\\\\"),
            '\n' => to.push_str("\\n"),
            c if c < ' ' => {
                let _ = write!(to, "\\u{:04x}", u32::from(c));
            }
            c => to.push(c),
        }
    }
    to.push('"');
}

/// A text in quotes.
pub(crate) fn quoted(text: &str) -> String {
    let mut quoted = String::with_capacity(text.len() + 2);
    write_text(text, &mut quoted);
    quoted
}

/// Writes a number so that it is read back exactly, and not as a whole number.
pub(crate) fn write_float(value: f64, to: &mut String) {
    if value.is_nan() {
        to.push_str("NaN");
    } else if value.is_infinite() {
        to.push_str(if value > 0.0 { "Infinity" } else { "-Infinity" });
    } else {
        let _ = write!(to, "{value:?}");
    }
}

#[cfg(test)]
mod tests {
    use expect_test::{Expect, expect};
    use proptest::prelude::*;

    use super::{DEPTH_MAX, Json, parse, quoted, write_float};
    use crate::types::library;

    fn check(text: &str, expected: Expect) {
        expected.assert_eq(&format!("{:?}", parse(text.as_bytes())));
    }

    #[test]
    fn values_are_read_as_python_writes_them() {
        check(
            r#" {"a": [1, -2.5e3, NaN, -Infinity], "$": 1} "#,
            expect![[
                r#"Ok(Map([("a", List([Int(1), Float(-2500.0), Float(NaN), Float(-inf)])), ("$", Int(1))]))"#
            ]],
        );
        check(
            r#"{"$": ["d", 8, 16]}"#,
            expect![[r#"Ok(Array { code: 'd', start: 8, bytes: 16 })"#]],
        );
        check(r#""\u00e4\ud83d\ude00\ud83d\n""#, expect![[r#"Ok(Text("ä😀�\n"))"#]]);
    }

    #[test]
    fn what_is_no_value_is_refused() {
        check("[1,", expect![[r#"Err("no JSON: nothing at byte 3")"#]]);
        check(r#""abc"#, expect![[r#"Err("no JSON: no end at byte 1")"#]]);
        check("1 2", expect![[r#"Err("no JSON: more than one value at byte 2")"#]]);
        check(&"[".repeat(1000), expect![[r#"Err("no JSON: too deep at byte 161")"#]]);
    }

    #[test]
    fn a_value_that_is_too_deep_is_refused_and_a_frame_with_the_deepest_type_is_not() {
        let lists = |count: usize| "[".repeat(count) + &"]".repeat(count);
        assert!(parse(lists(DEPTH_MAX + 1).as_bytes()).is_ok());
        check(&lists(DEPTH_MAX + 2), expect![[r#"Err("no JSON: too deep at byte 161")"#]]);
        let types = library::DEPTH_MAX;
        let message = r#"{"a":["#.repeat(types) + "0" + &"]}".repeat(types);
        let frame = format!(r#"{{"do":"publish","handle":1,"message":{message}}}"#);
        assert!(parse(frame.as_bytes()).is_ok());
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let _ = parse(&bytes);
        }

        #[test]
        fn texts_come_back(text in ".*") {
            prop_assert_eq!(parse(quoted(&text).as_bytes()), Ok(Json::Text(text)));
        }

        #[test]
        fn numbers_come_back(value in any::<f64>()) {
            let mut text = String::new();
            write_float(value, &mut text);
            let Ok(Json::Float(back)) = parse(text.as_bytes()) else { panic!("{text}") };
            prop_assert!(back.to_bits() == value.to_bits() || (back.is_nan() && value.is_nan()));
        }
    }
}
