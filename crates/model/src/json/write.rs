//! [`Json`] to text: the reference's layout (indent 4, a space after each comma) and a compact one.

use super::Json;
use smol_str::SmolStr;

/// The text as the reference writes it: keys sorted (as numbers if every key is a canonical integer), indent 4,
/// `, ` before each newline, ASCII only, no newline at the end (`docs/format.md`, JSON dialect).
pub fn write(json: &Json) -> String {
    let mut out = String::with_capacity(1024);
    Writer { out: &mut out, indent: Some(0) }.value(json);
    out
}

/// The text on one line, without spaces.
pub fn write_compact(json: &Json) -> String {
    let mut out = String::new();
    Writer { out: &mut out, indent: None }.value(json);
    out
}

struct Writer<'o> {
    out: &'o mut String,
    /// Depth, or `None` for one line.
    indent: Option<usize>,
}

impl Writer<'_> {
    fn value(&mut self, json: &Json) {
        match json {
            Json::Null => self.out.push_str("null"),
            Json::Bool(true) => self.out.push_str("true"),
            Json::Bool(false) => self.out.push_str("false"),
            Json::Int(number) => self.out.push_str(&number.to_string()),
            Json::BigInt(digits) => self.out.push_str(digits),
            Json::Float(number) => self.out.push_str(&python_float(*number)),
            Json::Str(text) => self.string(text),
            Json::List(items) => self.list(items),
            Json::Object(items) => self.object(items),
        }
    }

    fn list(&mut self, items: &[Json]) {
        if items.is_empty() {
            return self.out.push_str("[]");
        }
        self.out.push('[');
        self.deeper(1);
        for (index, item) in items.iter().enumerate() {
            self.separator(index);
            self.value(item);
        }
        self.deeper(-1);
        self.newline();
        self.out.push(']');
    }

    fn object(&mut self, items: &[(SmolStr, Json)]) {
        if items.is_empty() {
            return self.out.push_str("{}");
        }
        self.out.push('{');
        self.deeper(1);
        for (index, (key, value)) in sorted(items).into_iter().enumerate() {
            self.separator(index);
            self.string(key);
            self.out.push_str(if self.indent.is_some() { ": " } else { ":" });
            self.value(value);
        }
        self.deeper(-1);
        self.newline();
        self.out.push('}');
    }

    fn deeper(&mut self, by: isize) {
        self.indent = self.indent.map(|depth| depth.saturating_add_signed(by));
    }

    fn separator(&mut self, index: usize) {
        if index > 0 {
            self.out.push_str(if self.indent.is_some() { ", " } else { "," });
        }
        self.newline();
    }

    fn newline(&mut self) {
        if let Some(depth) = self.indent {
            self.out.push('\n');
            for _ in 0..depth {
                self.out.push_str("    ");
            }
        }
    }

    fn string(&mut self, text: &str) {
        self.out.push('"');
        for c in text.chars() {
            self.character(c);
        }
        self.out.push('"');
    }

    fn character(&mut self, c: char) {
        match c {
            '"' => self.out.push_str("\\\""),
            '\\' => self.out.push_str("\\\\"),
            '\n' => self.out.push_str("\\n"),
            '\r' => self.out.push_str("\\r"),
            '\t' => self.out.push_str("\\t"),
            '\u{8}' => self.out.push_str("\\b"),
            '\u{c}' => self.out.push_str("\\f"),
            ' '..='~' => self.out.push(c),
            _ => {
                for unit in c.encode_utf16(&mut [0; 2]) {
                    self.out.push_str("\\u");
                    for shift in [12, 8, 4, 0] {
                        let digit = u32::from(*unit >> shift & 0xf);
                        self.out.push(char::from_digit(digit, 16).unwrap_or('0'));
                    }
                }
            }
        }
    }
}

/// Members in the order of the reference's writer.
fn sorted(items: &[(SmolStr, Json)]) -> Vec<&(SmolStr, Json)> {
    let mut members: Vec<_> = items.iter().collect();
    if members.iter().all(|(key, _)| canonical_int(key).is_some()) {
        members.sort_by_key(|(key, _)| canonical_int(key));
    } else {
        members.sort_by(|a, b| a.0.cmp(&b.0));
    }
    members
}

/// The integer whose decimal text is exactly `text`; `None` for `01`, `-0`, ` 1` and integers beyond 64 bits.
pub fn canonical_int(text: &str) -> Option<i64> {
    let digits = text.strip_prefix('-').unwrap_or(text);
    let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    let is_plain = is_number && (text == "0" || !digits.starts_with('0'));
    if is_plain { text.parse().ok() } else { None }
}

/// The text of a float as by Python's `json`: the shortest digits that parse to an equal number, an exponent below 1e-4 and
/// from 1e16 on.
pub(crate) fn python_float(number: f64) -> String {
    if number.is_nan() {
        return "NaN".to_owned();
    }
    if number.is_infinite() {
        return if number > 0.0 { "Infinity" } else { "-Infinity" }.to_owned();
    }
    let scientific = format!("{number:e}");
    let (digits, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if number != 0.0 && !(-4..16).contains(&exponent) {
        let sign = if exponent < 0 { '-' } else { '+' };
        return format!("{digits}e{sign}{:02}", exponent.abs());
    }
    format!("{number:?}")
}
