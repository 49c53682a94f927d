//! Scanner for one line of the notation, from left to right. Knows words, names, numbers and values; not their meaning.

use super::NotationError;
use rafcon_model::port::Extra;
use rafcon_model::{DataType, Json, Value, json, literal};
use smol_str::SmolStr;

/// A line without its indentation, with the current position.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'t> {
    pub(super) number: usize,
    pub(super) indent: usize,
    text: &'t str,
    at: usize,
}

impl<'t> Line<'t> {
    pub(super) fn new(number: usize, line: &'t str) -> Self {
        let indent = line.len() - line.trim_start_matches([' ', '\t']).len();
        Self { number, indent, text: &line[indent..], at: 0 }
    }

    pub(super) fn error(&self, reason: impl Into<String>) -> NotationError {
        NotationError {
            line: self.number,
            column: self.indent + self.at + 1,
            reason: reason.into(),
        }
    }

    fn rest(&mut self) -> &'t str {
        let rest = &self.text[self.at..];
        let trimmed = rest.trim_start_matches([' ', '\t', '\r']);
        self.at += rest.len() - trimmed.len();
        trimmed
    }

    /// True if only a comment is left.
    pub(super) fn at_end(&mut self) -> bool {
        let rest = self.rest();
        rest.is_empty() || rest.starts_with('#')
    }

    pub(super) fn end(&mut self) -> Result<(), NotationError> {
        if self.at_end() {
            Ok(())
        } else {
            Err(self.error("more text follows the end of the line"))
        }
    }

    /// Skips `symbol` if it is next.
    pub(super) fn eat(&mut self, symbol: &str) -> bool {
        let found = self.rest().starts_with(symbol);
        self.at += if found { symbol.len() } else { 0 };
        found
    }

    pub(super) fn expect(&mut self, symbol: &str) -> Result<(), NotationError> {
        if self.eat(symbol) { Ok(()) } else { Err(self.error(format!("expected `{symbol}`"))) }
    }

    /// Skips `symbol` if it follows directly, without a space before it.
    pub(super) fn eat_joined(&mut self, symbol: &str) -> bool {
        let found = self.text[self.at..].starts_with(symbol);
        self.at += if found { symbol.len() } else { 0 };
        found
    }

    /// The next bare word; empty if another token is next.
    pub(super) fn peek_word(&mut self) -> &'t str {
        let rest = self.rest();
        let length = rest.bytes().take_while(|b| b.is_ascii_alphanumeric() || *b == b'_').count();
        &rest[..length]
    }

    /// Skips the bare word `word` if it is next.
    pub(super) fn eat_word(&mut self, word: &str) -> bool {
        let found = self.peek_word() == word;
        self.at += if found { word.len() } else { 0 };
        found
    }

    /// Reads a bare word or a string in quotes.
    pub(super) fn name(&mut self) -> Result<SmolStr, NotationError> {
        if let Some(text) = self.quoted()? {
            return Ok(SmolStr::new(text));
        }
        let word = self.peek_word();
        if word.is_empty() {
            return Err(self.error("expected a name"));
        }
        self.at += word.len();
        Ok(SmolStr::new(word))
    }

    /// Reads a string in quotes if it is next.
    pub(super) fn quoted(&mut self) -> Result<Option<String>, NotationError> {
        let rest = self.rest();
        if !rest.starts_with('"') {
            return Ok(None);
        }
        let length = 1 + quoted_length(&rest[1..], '"');
        match literal::parse(&rest[..length]) {
            Ok(Value::Str(text)) => {
                self.at += length;
                Ok(Some(text.to_string()))
            }
            Ok(_) => Err(self.error("expected a string")),
            Err(error) => Err(self.error(error.to_string())),
        }
    }

    /// Reads a whole number if it is next.
    pub(super) fn number(&mut self) -> Option<i64> {
        let rest = self.rest();
        let digits = rest.strip_prefix('-').unwrap_or(rest);
        let sign = rest.len() - digits.len();
        let length = digits.bytes().take_while(|b| b.is_ascii_alphanumeric() || *b == b'_').count();
        let number = rest[..sign + length].parse().ok()?;
        self.at += sign + length;
        Some(number)
    }

    /// Reads a value: a Python literal, or `json` and the file's encoding.
    pub(super) fn value(&mut self) -> Result<Value, NotationError> {
        if self.eat_word("json") {
            return Ok(Value::from_json(&self.json()?));
        }
        let rest = self.rest();
        let length = value_length(rest);
        let value =
            literal::parse(&rest[..length]).map_err(|error| self.error(error.to_string()))?;
        self.at += length;
        Ok(value)
    }

    pub(super) fn json(&mut self) -> Result<Json, NotationError> {
        let rest = self.rest();
        let length = value_length(rest);
        let json = json::parse(&rest[..length]).map_err(|error| self.error(error.to_string()))?;
        self.at += length;
        Ok(json)
    }

    /// The unknown keys at the end of an element's line.
    pub(super) fn extra(&mut self) -> Result<Extra, NotationError> {
        if self.eat_word("extra") { Ok(Some(Box::new(self.json()?))) } else { Ok(None) }
    }

    /// The dotted name of a type.
    pub(super) fn data_type(&mut self) -> Result<DataType, NotationError> {
        if let Some(name) = self.quoted()? {
            return Ok(DataType::from_file(&name));
        }
        let rest = self.rest();
        let length = rest.bytes().take_while(|b| is_type_byte(*b)).count();
        if length == 0 {
            return Err(self.error("expected a type"));
        }
        self.at += length;
        Ok(DataType::from_file(&rest[..length]))
    }
}

/// True if this byte needs no quotes in the name of a type.
pub(super) fn is_type_byte(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.')
}

/// Length in bytes of the value at the beginning of `text`: up to a space or comment outside of quotes and brackets.
fn value_length(text: &str) -> usize {
    let (mut at, mut depth) = (0, 0_usize);
    while let Some(c) = text[at..].chars().next() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            '"' | '\'' => at += quoted_length(&text[at + 1..], c),
            ' ' | '\t' | '\r' | '#' | ';' if depth == 0 => break,
            _ => {}
        }
        at += c.len_utf8();
    }
    at
}

/// Length in bytes of the rest of a string after its first quote, including the last quote.
fn quoted_length(rest: &str, quote: char) -> usize {
    let mut is_escaped = false;
    let end = rest.find(|c| {
        let is_end = c == quote && !is_escaped;
        is_escaped = c == '\\' && !is_escaped;
        is_end
    });
    end.map_or(rest.len(), |end| end + 1)
}

/// The lines of a document, from front to back.
pub(super) struct Lines<'t> {
    lines: Vec<&'t str>,
    next: usize,
}

impl<'t> Lines<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        let strip = |line: &'t str| line.strip_suffix('\r').unwrap_or(line);
        Self { lines: text.split('\n').map(strip).collect(), next: 0 }
    }

    /// The next line with its number, counted from 1.
    pub(super) fn take(&mut self) -> Option<(usize, &'t str)> {
        let line = self.lines.get(self.next)?;
        self.next += 1;
        Some((self.next, line))
    }

    /// The lines below a keyword at `indent` that are indented deeper, without the indentation of the first line. Empty
    /// lines at the end are left out.
    pub(super) fn block(&mut self, indent: usize) -> String {
        let rest = &self.lines[self.next..];
        let inside = |line: &&str| is_blank(line) || indent_of(line) > indent;
        let count = rest.iter().take_while(|line| inside(line)).count();
        let filled = rest[..count].iter().rposition(|line| !is_blank(line)).map_or(0, |at| at + 1);
        let block = &rest[..filled];
        let margin = block.iter().find(|line| !is_blank(line)).map_or(0, |line| indent_of(line));
        let cut = |line: &&'t str| &line[margin.min(indent_of(line))..];
        self.next += filled;
        block.iter().map(cut).collect::<Vec<_>>().join("\n")
    }
}

fn is_blank(line: &str) -> bool {
    indent_of(line) == line.len()
}

fn indent_of(line: &str) -> usize {
    line.len() - line.trim_start_matches([' ', '\t']).len()
}
