//! Text to [`Json`]: one pass over the bytes, no recursion deeper than [`MAX_DEPTH`].

use super::Json;
use smol_str::SmolStr;

/// Deeper nesting than this is refused: it is far beyond any machine and protects the stack.
pub const MAX_DEPTH: usize = 200;

/// A syntax error in JSON, with its position.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {reason}")]
pub struct ParseError {
    /// Line of the text, counted from 1.
    pub line: usize,
    /// Counted from 1, in bytes.
    pub column: usize,
    /// The unexpected or missing element.
    pub reason: &'static str,
}

/// Reads one JSON document; white space around it is allowed, anything else is an error.
pub fn parse(text: &str) -> Result<Json, ParseError> {
    let mut parser = JsonParser { text, at: 0 };
    let value = parser.value(0)?;
    parser.skip_space();
    if parser.at < text.len() {
        return Err(parser.error("more text follows the document"));
    }
    Ok(value)
}

struct JsonParser<'t> {
    text: &'t str,
    at: usize,
}

impl JsonParser<'_> {
    fn error(&self, reason: &'static str) -> ParseError {
        let before = &self.text.as_bytes()[..self.at.min(self.text.len())];
        let line = 1 + before.split(|b| *b == b'\n').count().saturating_sub(1);
        let column = 1 + before.iter().rev().take_while(|b| **b != b'\n').count();
        ParseError { line, column, reason }
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn skip_space(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\n' | b'\r' | b'\t')) {
            self.at += 1;
        }
    }

    fn value(&mut self, depth: usize) -> Result<Json, ParseError> {
        if depth > MAX_DEPTH {
            return Err(self.error("nested too deep"));
        }
        self.skip_space();
        match self.peek() {
            Some(b'{') => self.object(depth),
            Some(b'[') => self.list(depth),
            Some(b'"') => self.string().map(Json::Str),
            Some(b'-' | b'0'..=b'9') => self.number(),
            Some(_) => self.word(),
            None => Err(self.error("the text ends where a value should be")),
        }
    }

    fn word(&mut self) -> Result<Json, ParseError> {
        const WORDS: [(&str, Json); 5] = [
            ("null", Json::Null),
            ("true", Json::Bool(true)),
            ("false", Json::Bool(false)),
            ("NaN", Json::Float(f64::NAN)),
            ("Infinity", Json::Float(f64::INFINITY)),
        ];
        for (word, value) in WORDS {
            if self.text.as_bytes()[self.at..].starts_with(word.as_bytes()) {
                self.at += word.len();
                return Ok(value);
            }
        }
        Err(self.error("not a value"))
    }

    fn list(&mut self, depth: usize) -> Result<Json, ParseError> {
        self.at += 1;
        let mut items = Vec::new();
        self.skip_space();
        if self.peek() == Some(b']') {
            self.at += 1;
            return Ok(Json::List(items));
        }
        loop {
            items.push(self.value(depth + 1)?);
            if self.comma_or(b']', "expected `,` or `]`")? {
                return Ok(Json::List(items));
            }
        }
    }

    fn object(&mut self, depth: usize) -> Result<Json, ParseError> {
        self.at += 1;
        let mut items: Vec<(SmolStr, Json)> = Vec::new();
        self.skip_space();
        if self.peek() == Some(b'}') {
            self.at += 1;
            return Ok(Json::Object(items));
        }
        loop {
            items.push(self.member(depth)?);
            if self.comma_or(b'}', "expected `,` or `}`")? {
                return Ok(Json::Object(last_of_each_key(items)));
            }
        }
    }

    fn member(&mut self, depth: usize) -> Result<(SmolStr, Json), ParseError> {
        self.skip_space();
        if self.peek() != Some(b'"') {
            return Err(self.error("expected a key in quotes"));
        }
        let key = self.string()?;
        self.skip_space();
        if self.peek() != Some(b':') {
            return Err(self.error("expected `:`"));
        }
        self.at += 1;
        Ok((key, self.value(depth + 1)?))
    }

    /// True at the closing byte, false after a comma.
    fn comma_or(&mut self, close: u8, reason: &'static str) -> Result<bool, ParseError> {
        self.skip_space();
        match self.peek() {
            Some(b',') => {
                self.at += 1;
                Ok(false)
            }
            Some(byte) if byte == close => {
                self.at += 1;
                Ok(true)
            }
            _ => Err(self.error(reason)),
        }
    }

    fn number(&mut self) -> Result<Json, ParseError> {
        let start = self.at;
        if self.peek() == Some(b'-') {
            self.at += 1;
            if self.text.as_bytes()[self.at..].starts_with(b"Infinity") {
                self.at += "Infinity".len();
                return Ok(Json::Float(f64::NEG_INFINITY));
            }
        }
        let first = self.peek();
        let digits = self.digits();
        if digits == 0 {
            return Err(self.error("a sign without digits"));
        }
        if digits > 1 && first == Some(b'0') {
            return Err(self.error("a number does not start with 0"));
        }
        let is_float = self.fraction_and_exponent()?;
        let text = &self.text[start..self.at];
        if is_float {
            return text.parse().ok().map(Json::Float).ok_or_else(|| self.error("not a number"));
        }
        Ok(text.parse().map_or_else(|_| Json::BigInt(text.into()), Json::Int))
    }

    fn digits(&mut self) -> usize {
        let start = self.at;
        while matches!(self.peek(), Some(b'0'..=b'9')) {
            self.at += 1;
        }
        self.at - start
    }

    fn fraction_and_exponent(&mut self) -> Result<bool, ParseError> {
        let mut found = false;
        if self.peek() == Some(b'.') {
            self.at += 1;
            found = true;
            if self.digits() == 0 {
                return Err(self.error("a decimal point without digits"));
            }
        }
        if matches!(self.peek(), Some(b'e' | b'E')) {
            self.at += 1;
            found = true;
            if matches!(self.peek(), Some(b'+' | b'-')) {
                self.at += 1;
            }
            if self.digits() == 0 {
                return Err(self.error("an exponent without digits"));
            }
        }
        Ok(found)
    }

    fn string(&mut self) -> Result<SmolStr, ParseError> {
        self.at += 1;
        let start = self.at;
        loop {
            match self.peek() {
                Some(b'"') => {
                    let text = SmolStr::new(&self.text[start..self.at]);
                    self.at += 1;
                    return Ok(text);
                }
                Some(b'\\') => return self.escaped_string(start),
                Some(0..=0x1f) => return Err(self.error("a control character in a string")),
                Some(_) => self.at += 1,
                None => return Err(self.error("a string without end")),
            }
        }
    }

    fn escaped_string(&mut self, start: usize) -> Result<SmolStr, ParseError> {
        let mut text = String::from(&self.text[start..self.at]);
        loop {
            let run = self.at;
            while !matches!(self.peek(), Some(b'"' | b'\\' | 0..=0x1f) | None) {
                self.at += 1;
            }
            text.push_str(&self.text[run..self.at]);
            match self.peek() {
                Some(b'"') => {
                    self.at += 1;
                    return Ok(SmolStr::from(text));
                }
                Some(b'\\') => text.push(self.escape()?),
                Some(_) => return Err(self.error("a control character in a string")),
                None => return Err(self.error("a string without end")),
            }
        }
    }

    fn escape(&mut self) -> Result<char, ParseError> {
        self.at += 1;
        let Some(byte) = self.peek() else { return Err(self.error("a string without end")) };
        self.at += 1;
        Ok(match byte {
            b'"' | b'\\' | b'/' => char::from(byte),
            b'b' => '\u{8}',
            b'f' => '\u{c}',
            b'n' => '\n',
            b'r' => '\r',
            b't' => '\t',
            b'u' => return self.unicode_escape(),
            _ => return Err(self.error("an unknown escape")),
        })
    }

    /// `\uXXXX`, or a surrogate pair. A lone surrogate (Python allows it) becomes the replacement character.
    fn unicode_escape(&mut self) -> Result<char, ParseError> {
        let high = self.hex4()?;
        if !(0xd800..0xdc00).contains(&high) {
            return Ok(char::from_u32(high).unwrap_or(char::REPLACEMENT_CHARACTER));
        }
        let back = self.at;
        if self.text.as_bytes()[self.at..].starts_with(b"\\u") {
            self.at += 2;
            let low = self.hex4()?;
            if (0xdc00..0xe000).contains(&low) {
                let code = 0x1_0000 + ((high - 0xd800) << 10) + (low - 0xdc00);
                return Ok(char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER));
            }
            self.at = back;
        }
        Ok(char::REPLACEMENT_CHARACTER)
    }

    fn hex4(&mut self) -> Result<u32, ParseError> {
        let digits = self.text.as_bytes().get(self.at..self.at + 4);
        let code = digits
            .filter(|d| d.iter().all(u8::is_ascii_hexdigit))
            .and_then(|d| std::str::from_utf8(d).ok())
            .and_then(|d| u32::from_str_radix(d, 16).ok());
        let Some(code) = code else {
            return Err(self.error("`\\u` needs four hexadecimal digits"));
        };
        self.at += 4;
        Ok(code)
    }
}

/// Small objects are checked by eye, large ones by sorting, so that no text makes this quadratic.
fn last_of_each_key(mut items: Vec<(SmolStr, Json)>) -> Vec<(SmolStr, Json)> {
    if items.is_sorted_by(|a, b| a.0 < b.0) {
        return items;
    }
    let mut order: Vec<usize> = (0..items.len()).collect();
    order.sort_by(|a, b| items[*a].0.cmp(&items[*b].0).then(a.cmp(b)));
    let mut keep = vec![true; items.len()];
    for pair in order.windows(2) {
        if items[pair[0]].0 == items[pair[1]].0 {
            keep[pair[0]] = false;
        }
    }
    let mut flags = keep.into_iter();
    items.retain(|_| flags.next().unwrap_or(true));
    items
}
