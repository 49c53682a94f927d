//! A compact text for machines that people read and tests write: for `rafcon show` and bug reports. Knows every part of a
//! [`Machine`](crate::Machine); never the files of RAFCON's own format. `docs/notation.md` defines the syntax; only
//! tests read it.
//!
//! ```
//! use rafcon_testkit::notation;
//!
//! let text = r#"
//! hierarchy ROOT "Root"
//!   outcome success
//!   var n: int = 3
//!   start -> AAAAAA
//!   AAAAAA.success -> .success
//!   flow .n -> AAAAAA.x
//!   execution AAAAAA "First"
//!     outcome success
//!     in x: int = 1
//!     script |
//!       def execute(self, inputs, outputs, gvm):
//!           return 0
//! "#;
//! let machine = notation::parse(text)?;
//! assert_eq!(machine.count(), 2);
//! assert_eq!(notation::print(&machine).trim(), text.trim());
//! # Ok::<(), notation::NotationError>(())
//! ```

mod print;
mod shared;

pub use print::{Shown, print, print_with};

use crate::{DataType, Json, StateId, Value, json, literal};

/// Words that begin a line: a state with such an id is written in quotes.
const KEYWORDS: &[&str] = &[
    "machine",
    "define",
    "content",
    "execution",
    "decider",
    "hierarchy",
    "barrier",
    "preemptive",
    "library",
    "outcome",
    "without",
    "in",
    "out",
    "var",
    "set",
    "interface",
    "missing",
    "description",
    "semantic",
    "layout",
    "extra",
    "script",
    "flow",
    "start",
    "nowhere",
];

/// True if a name or id needs no quotes.
fn is_bare(text: &str) -> bool {
    let mut bytes = text.bytes();
    bytes.next().is_some_and(|b| b.is_ascii_alphabetic() || b == b'_')
        && bytes.all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

fn id_text(id: &StateId) -> String {
    let text = id.as_str();
    if is_bare(text) && !KEYWORDS.contains(&text) { text.to_owned() } else { quoted(text) }
}

fn name_text(name: &str) -> String {
    if is_bare(name) { name.to_owned() } else { quoted(name) }
}

fn type_text(data_type: &DataType) -> String {
    let name = match data_type {
        DataType::Named(name) => name.clone(),
        _ => data_type.short_name(),
    };
    let is_plain = !name.is_empty() && name.bytes().all(is_type_byte);
    if is_plain { name.to_string() } else { quoted(&name) }
}

fn value_text(value: &Value) -> String {
    literal::write(value)
        .unwrap_or_else(|| format!("json {}", json::write_compact(&value.to_json())))
}

fn extra_text(extra: Option<&Json>) -> String {
    extra.map_or_else(String::new, |extra| format!(" extra {}", json::write_compact(extra)))
}

fn quoted(text: &str) -> String {
    let mut out = String::new();
    literal::quote(text, &mut out);
    out
}

/// True if this byte needs no quotes in the name of a type.
fn is_type_byte(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.')
}

/// True if a text survives the form of a block.
fn fits_block(text: &str) -> bool {
    let body = text.strip_suffix('\n').unwrap_or(text);
    let first = body.split('\n').find(|line| !is_blank(line));
    let last_is_filled = body.split('\n').next_back().is_some_and(|line| !is_blank(line));
    last_is_filled
        && !text.contains('\r')
        && first.is_some_and(|line| !line.starts_with([' ', '\t']))
}

fn is_blank(line: &str) -> bool {
    line.trim_start_matches([' ', '\t']).is_empty()
}
